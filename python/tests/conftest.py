# SPDX-License-Identifier: Apache-2.0
"""Small scenes for all tests. Nothing here takes longer than a few tenths of a second."""
import os
import pathlib
import subprocess

import numpy as np
import pytest

import fathom

ROOT = pathlib.Path(__file__).parents[2]


@pytest.fixture
def tetrahedron():
    vertices = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], np.float32)
    faces = np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]], np.uint32)
    return vertices, faces


@pytest.fixture
def scene(tetrahedron):
    """A red tetrahedron, with a camera and a constant environment."""
    made = fathom.Scene()
    made.mesh = made.add_mesh(*tetrahedron, material=fathom.Material("diffuse", color=(0.8, 0.1, 0.1)), name="tetrahedron")
    made.camera = fathom.Camera.look_at((2, 2, 3), (0.3, 0.3, 0.3))
    made.environment = fathom.Environment("constant")
    return made


@pytest.fixture
def program():
    """Runs the program; skipped where it isn't built beside the package."""
    path = os.environ.get("FATHOM_PROGRAM")
    if not path:
        pytest.skip("FATHOM_PROGRAM is not set: there is no program to compare with")
    return lambda *words: subprocess.run([path, *map(str, words)], check=True, capture_output=True, text=True)


SMALL = dict(size=(64, 48), spp=2)
