#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Runs the tests of the Python package in the build folder; ctest shows it as one test.

usage: run.py BUILD_FOLDER PROGRAM PYTHON

Exits with 77, which ctest shows as skipped, if the package is not built, or NumPy or pytest is missing.
"""
import os
import pathlib
import subprocess
import sys

build, program, python = pathlib.Path(sys.argv[1]).resolve(), sys.argv[2], sys.argv[3]


def skip(reason: str) -> None:
    print("skipped:", reason)
    sys.exit(77)


if not list(build.glob("python/fathom/_fathom*.so")):
    skip("the Python package is not built")
if not os.path.exists(python) or subprocess.run([python, "-c", "import numpy, pytest"], capture_output=True).returncode:
    skip("NumPy or pytest is missing")
environment = {**os.environ, "PYTHONPATH": str(build / "python"), "FATHOM_PROGRAM": program, "PYTHONDONTWRITEBYTECODE": "1"}
sys.exit(subprocess.run([python, "-m", "pytest", "-q", "-rs", "-p", "no:cacheprovider", pathlib.Path(__file__).parent],
                        env=environment).returncode)
