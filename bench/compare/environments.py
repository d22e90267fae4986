# SPDX-License-Identifier: Apache-2.0
"""Virtual environments with pinned packages: one for this program and one for each renderer, whose packages conflict."""
import json
import subprocess
import sys
import venv
from pathlib import Path

PINNED = {"tools": ["numpy==2.4.6", "OpenEXR==3.3.5", "matplotlib==3.10.7"],
          "mitsuba": ["mitsuba==3.9.1", "numpy==2.4.6"],
          "cycles": ["bpy==5.0.1", "numpy==1.26.4"],  # needs Python 3.11
          "luxcore": ["pyluxcore==2.11.0", "numpy==2.4.6"]}
DEFAULT_FOLDER = Path.home() / ".cache/fathom-compare"


class Missing(Exception):
    """A renderer that can't be used here."""


def python_of(name, folder):
    """The Python of an environment, which is made if it is missing or has other packages."""
    home, wanted = folder / name, PINNED[name]
    python, mark = home / "bin/python", home / "installed.json"
    if mark.exists() and json.loads(mark.read_text()) == wanted:
        return python
    print(f"installing {' '.join(wanted)} into {home}", file=sys.stderr, flush=True)
    venv.create(home, clear=True, with_pip=True)
    run = subprocess.run([str(python), "-m", "pip", "install", "-q", "--disable-pip-version-check", *wanted], capture_output=True, text=True)
    if run.returncode:
        lines = run.stderr.strip().splitlines() or ["pip failed"]
        raise Missing(f"{name}: {lines[-1]}; Python {sys.version_info.major}.{sys.version_info.minor} is used (bpy needs 3.11)")
    mark.write_text(json.dumps(wanted))
    return python
