# SPDX-License-Identifier: Apache-2.0
"""Scenes of arrays."""
from __future__ import annotations

from typing import Any

import numpy as np

from ..parameters import Material
from ..scene import Scene

_UP = {"y": np.eye(4), "z": np.array([[1, 0, 0, 0], [0, 0, 1, 0], [0, -1, 0, 0], [0, 0, 0, 1]], float)}


def up_matrix(up_axis: str) -> np.ndarray:
    """Returns the rotation that turns `up_axis` to y, the up axis of scenes."""
    if up_axis not in _UP:
        raise ValueError(f"up_axis: expected 'y' or 'z', found {up_axis!r}")
    return _UP[up_axis]


def to_scene(vertices: Any, faces: Any, *, up_axis: str = "y", material: Material | None = None, **data: Any) -> Scene:
    """Returns a scene of one mesh, which is completed like a model: studio light where it would be dark."""
    scene = Scene()
    scene._core.set_own_light(False)
    scene.add_mesh(vertices, faces, material=material, transform=up_matrix(up_axis), **data)
    return scene


def open3d_to_scene(mesh: Any, up_axis: str, material: Material | None = None) -> Scene:
    """Returns a scene of an ``open3d.geometry.TriangleMesh``."""
    def given(name: str) -> np.ndarray | None:
        values = np.asarray(getattr(mesh, name, ()))
        return values if len(values) else None

    vertices, faces = np.asarray(mesh.vertices), np.asarray(mesh.triangles)
    colors = given("vertex_colors")
    if colors is not None:
        from ..arrays import srgb_to_linear
        colors = srgb_to_linear(np.clip(colors, 0, 1))
    return to_scene(vertices, faces, up_axis=up_axis, material=material, normals=given("vertex_normals"), colors=colors)
