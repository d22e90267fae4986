# SPDX-License-Identifier: Apache-2.0
"""Data sets of PyVista."""
from __future__ import annotations

from typing import Any

import numpy as np

from ..arrays import srgb_to_linear
from ..parameters import Material
from ..scene import Scene
from . import meshes


def to_scene(data: Any, up_axis: str, scalars: Any = None, cmap: Any = None, clim: Any = None,
             material: Material | None = None) -> Scene:
    """Returns a scene of the surface of a data set, colored by scalars.

    scalars : name of an array of points or cells; by default the active one; False: none
    cmap : name of a colormap of Matplotlib, or a function from numbers 0 to 1 to RGBA (``"viridis"``)
    clim : (lowest, highest) value of the colormap; by default those of the scalars
    """
    surface = _surface(data).triangulate()
    vertices, faces = np.asarray(surface.points), np.asarray(surface.faces).reshape(-1, 4)[:, 1:]
    name = (surface.active_scalars_name if scalars is None else scalars) if scalars is not False else None
    if name is None:
        return meshes.to_scene(vertices, faces, up_axis=up_axis, material=material)
    of_cells = name in surface.cell_data
    if not of_cells and name not in surface.point_data:
        known = ", ".join([*surface.point_data.keys(), *surface.cell_data.keys()])
        raise ValueError(f"scalars: the data set has no array '{name}', only {known or 'none'}")
    colors = _colors(np.asarray((surface.cell_data if of_cells else surface.point_data)[name]), cmap, clim)
    if of_cells:
        vertices, colors = vertices[faces.reshape(-1)], colors.repeat(3, axis=0)
        faces = np.arange(len(vertices)).reshape(-1, 3)
    return meshes.to_scene(vertices, faces, up_axis=up_axis, material=material, colors=colors)


def _surface(data: Any) -> Any:
    if hasattr(data, "faces"):
        return data
    try:
        return data.extract_surface(algorithm=None)
    except TypeError:  # before PyVista 0.47
        return data.extract_surface()


def _colors(values: np.ndarray, cmap: Any, clim: Any) -> np.ndarray:
    if values.ndim == 2 and values.shape[1] in (3, 4) and values.dtype == np.uint8:
        return values
    if values.ndim == 2:
        values = np.linalg.norm(values, axis=1)
    values = values.astype(float)
    low, high = (np.nanmin(values), np.nanmax(values)) if clim is None else clim
    position = np.nan_to_num((values - low) / (high - low if high > low else 1))
    if cmap is None or isinstance(cmap, str):
        import matplotlib
        cmap = matplotlib.colormaps[cmap or "viridis"]
    return srgb_to_linear(np.asarray(cmap(np.clip(position, 0, 1)))[:, :3])
