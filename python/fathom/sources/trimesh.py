# SPDX-License-Identifier: Apache-2.0
"""Meshes and scenes of trimesh."""
from __future__ import annotations

from typing import Any

import numpy as np

from ..parameters import Material
from ..scene import Scene, load
from . import meshes


def to_scene(x: Any, up_axis: str, material: Material | None = None) -> Scene:
    """Returns a scene of a ``trimesh.Trimesh`` or ``trimesh.Scene``.

    Meshes with textures and scenes go through trimesh's GLB export, which knows all of its materials."""
    if hasattr(x, "geometry") or getattr(x.visual, "kind", None) == "texture":
        if material is not None:
            raise TypeError("material: meshes with textures and scenes of trimesh have materials of their own")
        meshes.up_matrix(up_axis)
        return load(x.export(file_type="glb"), up_axis=up_axis)
    kind = getattr(x.visual, "kind", None)
    vertices, faces, colors = x.vertices, x.faces, None
    if kind == "vertex":
        colors = x.visual.vertex_colors
    elif kind == "face":
        # Triangles of different colors can't share vertices.
        vertices, faces = x.vertices[x.faces.reshape(-1)], np.arange(3 * len(x.faces)).reshape(-1, 3)
        colors = x.visual.face_colors.repeat(3, axis=0)
    # Normals are passed on only if the mesh has computed them, as trimesh does when it exports; otherwise triangles are flat.
    normals = x.vertex_normals if "vertex_normals" in x._cache and len(vertices) == len(x.vertices) else None
    return meshes.to_scene(vertices, faces, up_axis=up_axis, material=material, colors=colors, normals=normals)
