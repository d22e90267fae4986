# SPDX-License-Identifier: Apache-2.0
"""The seven rooms: scenes by others in Mitsuba's and pbrt's formats, which only programs that read these formats render."""
from pathlib import Path

ROOT = Path(__file__).resolve().parents[3]
FOLDER = ROOT / "../shared/scenes"
SIZE = (320, 180)
NAMES = {"room-classroom": "mitsuba/classroom/scene.xml", "room-kitchen": "mitsuba/kitchen/scene.xml",
         "room-living-room": "mitsuba/living-room/scene.xml", "room-modern-hall": "mitsuba/modern-hall/scene.xml",
         "room-veach-ajar": "mitsuba/veach-ajar/scene.xml", "room-veach-bidir": "mitsuba/veach-bidir/scene.xml",
         "room-veach-mis": "mitsuba/veach-mis/scene.xml"}
PBRT = {"room-living-room": "pbrt-v4/living-room/living-room.pbrt", "room-modern-hall": "pbrt-v4/modern-hall/staircase2.pbrt",
        "room-veach-ajar": "pbrt-v4/veach-ajar/veach-ajar.pbrt"}


def file(name, folder=FOLDER):
    """The file of a room, or None where it is missing."""
    path = (folder / NAMES[name]).resolve()
    return path if path.exists() else None
