# SPDX-License-Identifier: Apache-2.0
"""Shared by the tests of data sets: models made by trimesh, and functions that run the program."""
import importlib.util
import json
import pathlib
import subprocess
import sys
import tempfile
import unittest

PROGRAM = pathlib.Path(sys.argv[1]).resolve()


def skip_all(reason):
    print("skipped:", reason)
    sys.exit(77)


def need(*modules):
    """Skips the whole file, which ctest shows, if a module is missing."""
    for module in modules:
        if importlib.util.find_spec(module) is None:
            skip_all(f"the Python package {module} is missing")


def without(module):
    """Why a test is skipped without a module, as a decorator."""
    return unittest.skipIf(importlib.util.find_spec(module) is None, f"the Python package {module} is missing")


class DatasetTest(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def render(self, *words):
        run = subprocess.run([PROGRAM, "render", *map(str, words)], capture_output=True, text=True, cwd=self.folder)
        self.assertEqual(run.returncode, 0, run.stderr)
        return run.stderr

    def read_json(self, path):
        return json.loads((self.folder / path).read_text())

    def model(self):
        """Writes a GLB of four objects that hide each other, two of them of one mesh and one stretched; returns its
        path and the meshes in world space by name."""
        import numpy as np
        import trimesh
        scene = trimesh.Scene()
        box = trimesh.creation.box((1, 1, 1))
        ball = trimesh.creation.icosphere(subdivisions=2, radius=0.6)
        turned = trimesh.transformations.rotation_matrix(0.7, (1, 2, 3))
        placed = {
            "left": (box, trimesh.transformations.translation_matrix((-1, 0, 0.2)) @ turned),
            "right": (box, trimesh.transformations.translation_matrix((0.9, 0.3, -0.4))),
            "ball": (ball, trimesh.transformations.translation_matrix((0, 0.1, 0.9))),
            "plate": (ball, trimesh.transformations.translation_matrix((0, -0.8, 0)) @ turned @ np.diag((2, 0.3, 1.5, 1))),
        }
        for name, (mesh, matrix) in placed.items():
            geometry = "box" if mesh is box else "ball"
            if geometry in scene.geometry:
                scene.graph.update(frame_to=name, matrix=matrix, geometry=geometry)
            else:
                scene.add_geometry(mesh, node_name=name, geom_name=geometry, transform=matrix)
        path = self.folder / "model.glb"
        path.write_bytes(scene.export(file_type="glb"))
        return path, {name: mesh.copy().apply_transform(matrix) for name, (mesh, matrix) in placed.items()}


def center_rays(view, width, height):
    """Origins and unit directions of the rays through the centers of the pixels of an NPZ file."""
    import numpy as np
    k, pose = view["intrinsics"], view["world_from_camera"]
    x, y = np.meshgrid(np.arange(width) + 0.5, np.arange(height) + 0.5)
    d = np.stack([(x - k[0, 2]) / k[0, 0], -(y - k[1, 2]) / k[1, 1], -np.ones_like(x)], -1) @ pose[:3, :3].T
    d /= np.linalg.norm(d, axis=-1, keepdims=True)
    return np.broadcast_to(pose[:3, 3], d.shape), d
