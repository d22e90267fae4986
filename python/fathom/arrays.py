# SPDX-License-Identifier: Apache-2.0
"""Checks of arrays. Arrays that have the dtype and layout of the library are not copied here."""
from __future__ import annotations

from typing import Any

import numpy as np


def float_rows(value: Any, name: str, columns: int, rows: int | None = None) -> np.ndarray:
    """Returns the value as a C-contiguous float32 array (rows, columns) of finite numbers."""
    array = np.asarray(value)
    if array.dtype.kind not in "fiu":
        raise TypeError(f"{name}: expected numbers, found dtype {array.dtype}")
    if array.ndim != 2 or array.shape[1] != columns:
        raise ValueError(f"{name}: expected shape (n, {columns}), found {array.shape}")
    if rows is not None and array.shape[0] != rows:
        raise ValueError(f"{name}: expected {rows} rows, one for each vertex, found {array.shape[0]}")
    with np.errstate(over="ignore"):
        array = np.ascontiguousarray(array, np.float32)
    if not np.isfinite(array).all():
        row = int(np.argmin(np.isfinite(array).all(axis=1)))
        raise ValueError(f"{name}: row {row} has a value that is NaN, infinite or too large for float32")
    return array


def triangles(value: Any, vertices: int) -> np.ndarray:
    """Returns the value as a C-contiguous uint32 array (n, 3) of indices below `vertices`."""
    array = np.asarray(value)
    if array.dtype.kind not in "iu":
        raise TypeError(f"faces: expected integers, found dtype {array.dtype}")
    if array.ndim != 2 or array.shape[1] != 3:
        hint = "; split polygons into triangles first" if array.ndim == 2 and array.shape[1] > 3 else ""
        raise ValueError(f"faces: expected shape (n, 3), found {array.shape}{hint}")
    if len(array) and (array.min() < 0 or array.max() >= vertices):
        row = int(np.argmax(((array < 0) | (array >= vertices)).any(axis=1)))
        raise ValueError(f"faces: row {row} is {array[row].tolist()}, but there are {vertices} vertices")
    return np.ascontiguousarray(array, np.uint32)


def colors(value: Any, rows: int) -> np.ndarray:
    """Returns vertex colors as linear float32 RGBA. uint8 colors are sRGB codes, floats are linear, as in PLY files."""
    array = np.asarray(value)
    if array.ndim != 2 or array.shape[1] not in (3, 4):
        raise ValueError(f"colors: expected shape (n, 3) or (n, 4), found {array.shape}")
    if array.dtype == np.uint8:
        linear = array / np.float32(255)
        linear[:, :3] = srgb_to_linear(np.arange(256) / 255)[array[:, :3]]
        array = linear
    array = float_rows(array, "colors", array.shape[1], rows)
    if array.shape[1] == 4:
        return array
    return np.concatenate([array, np.ones((rows, 1), np.float32)], axis=1)


def srgb_to_linear(value: np.ndarray) -> np.ndarray:
    """Applies the inverse transfer function of sRGB (IEC 61966-2-1) to values from 0 to 1."""
    value = np.asarray(value, np.float64)
    return np.where(value <= 0.04045, value / 12.92, ((value + 0.055) / 1.055) ** 2.4).astype(np.float32)


def matrix(value: Any, name: str = "transform") -> np.ndarray:
    """Returns a transform, (4, 4) or (3, 4), as a C-contiguous float64 array (4, 4)."""
    if value is None:
        return np.eye(4)
    array = np.asarray(value)
    if array.dtype.kind not in "fiu":
        raise TypeError(f"{name}: expected numbers, found dtype {array.dtype}")
    if array.shape == (3, 4):
        array = np.vstack([array, [0, 0, 0, 1]])
    if array.shape != (4, 4):
        raise ValueError(f"{name}: expected shape (4, 4), found {array.shape}")
    array = np.ascontiguousarray(array, np.float64)
    if not np.isfinite(array).all():
        raise ValueError(f"{name}: has a value that is NaN or infinite")
    if not np.array_equal(array[3], [0, 0, 0, 1]):
        raise ValueError(f"{name}: the last row must be 0, 0, 0, 1; projections are no transforms")
    return array
