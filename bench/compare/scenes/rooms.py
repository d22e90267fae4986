# SPDX-License-Identifier: Apache-2.0
"""The seven rooms: scenes by others in Mitsuba's format, which only Fathom and Mitsuba read (pbrt's rooms: bench/pbrt.py)."""
from pathlib import Path

ROOT = Path(__file__).resolve().parents[3]
FOLDER = ROOT / "../shared/scenes"
SIZE = (320, 180)
NAMES = {"room-classroom": "mitsuba/classroom/scene.xml", "room-kitchen": "mitsuba/kitchen/scene.xml",
         "room-living-room": "mitsuba/living-room/scene.xml", "room-modern-hall": "mitsuba/modern-hall/scene.xml",
         "room-veach-ajar": "mitsuba/veach-ajar/scene.xml", "room-veach-bidir": "mitsuba/veach-bidir/scene.xml",
         "room-veach-mis": "mitsuba/veach-mis/scene.xml"}


def file(name, folder=FOLDER):
    """The file of a room, or None where it is missing."""
    path = (folder / NAMES[name]).resolve()
    return path if path.exists() else None
