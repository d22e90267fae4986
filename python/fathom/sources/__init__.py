# SPDX-License-Identifier: Apache-2.0
"""Meshes of other packages. None of the packages is imported: an object of theirs shows that it is there."""
from __future__ import annotations

from typing import Any

from ..scene import Scene
from . import meshes, pyvista, trimesh

#: Options of to_scene().
OPTIONS = {"up_axis", "scalars", "cmap", "clim", "material"}


def to_scene(x: Any, up_axis: str | None = None, **how: Any) -> Scene:
    """Returns a scene of a mesh of another package, or of ``(vertices, faces)``."""
    package = type(x).__module__.partition(".")[0]
    bases = {base.__module__.partition(".")[0] for base in type(x).__mro__}
    if package in ("pyvista", "pyvistaqt") or "pyvista" in bases:
        return pyvista.to_scene(x, up_axis or "z", **how)
    if "scalars" in how or "cmap" in how or "clim" in how:
        raise TypeError("scalars, cmap and clim are options for data sets of PyVista")
    if "trimesh" in bases:
        return trimesh.to_scene(x, up_axis or "y", **how)
    if "open3d" in bases and hasattr(x, "to_legacy"):  # a mesh of tensors
        x = x.to_legacy()
    if hasattr(x, "triangles") and hasattr(x, "vertices"):
        return meshes.open3d_to_scene(x, up_axis or "y", **how)
    if isinstance(x, (tuple, list)) and len(x) == 2:
        return meshes.to_scene(*x, up_axis=up_axis or "y", **how)
    raise TypeError(f"render() takes a path, bytes, (vertices, faces), a mesh or a scene, found {type(x).__name__}")
