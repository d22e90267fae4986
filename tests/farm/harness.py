# SPDX-License-Identifier: Apache-2.0
"""Shared by the tests of farm/: a folder of films, the image of one run, and checks for optional packages.

farm_test.py FATHOM PICTURE_HASH BUILD_FOLDER runs all tests.
"""
import importlib.util
import os
import shutil
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
import waiting  # noqa: E402

PROGRAM, PICTURE_HASH, BUILD = (Path(argument).resolve() for argument in sys.argv[1:4])
ROOT = Path(__file__).resolve().parents[2]
FARM = ROOT / "farm"
SAMPLES = 12


def has(package):
    """Whether a Python package is installed; tests that need a missing one are skipped with a message."""
    return importlib.util.find_spec(package) is not None


def needs(package, name):
    return unittest.skipUnless(has(package), f"{name} is not installed (scripts/test-farm.sh)")


def needs_command(name):
    return unittest.skipUnless(shutil.which(name), f"{name} is not installed")


def hash_of(picture):
    return subprocess.run([PICTURE_HASH, picture], check=True, capture_output=True, text=True).stdout.split()[0]


class Films(unittest.TestCase):
    """A test with a folder that has a scene, and with the program in PATH as `fathom`."""

    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(folder.cleanup)
        cls.reference = Path(folder.name) / "whole.exr"
        cls.scene_text = (ROOT / "scenes" / "cornell-box.json").read_bytes()
        scene = Path(folder.name) / "scene.json"
        scene.write_bytes(cls.scene_text)
        subprocess.run([PROGRAM, "render", scene, "--spp", str(SAMPLES), "--mergeable", *cls.small(), "-q", "-o", cls.reference], check=True)
        cls.expected = hash_of(cls.reference)

    @staticmethod
    def small():
        return ["--size", "48x36"]

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)
        (self.folder / "bin").mkdir()
        # The wrapper makes images small; recipes don't set a size.
        (self.folder / "bin" / "fathom").write_text(
            f'#!/bin/sh\nword=$1; shift\n[ "$word" = render ] && set -- "$@" {" ".join(self.small())}\nexec "{PROGRAM}" "$word" "$@"\n')
        (self.folder / "bin" / "fathom").chmod(0o755)
        self.films = self.folder / "films"
        self.films.mkdir()
        (self.films / "scene.json").write_bytes(self.scene_text)

    def environment(self, **more):
        return {**os.environ, "PATH": f"{self.folder / 'bin'}:{Path(sys.executable).parent}:{os.environ['PATH']}", **more}

    def run_it(self, *words, **environment):
        result = waiting.run(words, cwd=self.films, env=self.environment(**environment))
        self.assertEqual(result.returncode, 0, f"{words}\n{result.stdout[-2000:]}{result.stderr[-2000:]}")
        return result

    def run_shell(self, text, **environment):
        return self.run_it("sh", "-c", text, **environment)

    def check_picture(self, name="picture.exr"):
        self.assertEqual(hash_of(self.films / name), self.expected, "not the picture of one run")
