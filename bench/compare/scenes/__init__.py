# SPDX-License-Identifier: Apache-2.0
"""All scenes: those that scripts of this folder make, and rooms that are read from files."""
from . import caustics, cornell, foliage, hair, lights, media, metals, rooms, sky

GENERATED = {name: make for part in (cornell, lights, metals, sky, foliage, hair, media, caustics) for name, make in part.SCENES.items()}
ROOMS = rooms.NAMES
NAMES = [*GENERATED, *ROOMS]
CAUSTICS = list(caustics.SCENES)


def make(name):
    made = GENERATED[name]()
    assert made["name"] == name
    return made
