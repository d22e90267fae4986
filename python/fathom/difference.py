# SPDX-License-Identifier: Apache-2.0
"""fathom.diff(): compares images."""
from __future__ import annotations

import json
import math
import os
import pathlib
from typing import Any

import numpy as np

from . import _fathom
from .image import Image


class Difference:
    """The difference of an image and a reference; :func:`diff` makes it. docs/diff.md explains the numbers."""

    def __init__(self, core: _fathom.Comparison):
        self._core = core
        self._numbers = json.loads(core.json())

    @property
    def same(self) -> bool:
        """Whether no pixel differs by more than the tolerance."""
        return self._numbers["same"]

    @property
    def different_pixels(self) -> int:
        """Number of pixels that differ by more than the tolerance."""
        return self._numbers["different_pixels"]

    @property
    def largest(self) -> float:
        """Largest absolute difference of a channel; infinite if a value is NaN or infinite in one image only."""
        value = self._numbers["largest"]["difference"]
        return math.inf if value is None else value

    @property
    def largest_at(self) -> tuple[int, int]:
        """Column and row of the pixel with the largest difference."""
        return self._numbers["largest"]["x"], self._numbers["largest"]["y"]

    @property
    def mse(self) -> float | None:
        """Mean squared difference of red, green and blue; None for layers that are no colors."""
        return self._numbers.get("mse")

    @property
    def psnr(self) -> float | None:
        """PSNR in decibels, infinite for equal images; None for layers that are no colors."""
        if "psnr_db" not in self._numbers:
            return None
        return math.inf if self._numbers["psnr_db"] is None else self._numbers["psnr_db"]

    @property
    def relmse(self) -> float | None:
        """Mean of (x - r)^2 / (r^2 + 0.01) in linear Rec.709, where r is the reference; None for other layers."""
        return self._numbers.get("relmse")

    @property
    def flip(self) -> float | None:
        """Mean FLIP, from 0 to 1; None for layers that are no colors."""
        return self._numbers["flip"]["mean"] if "flip" in self._numbers else None

    @property
    def flip_map(self) -> np.ndarray | None:
        """FLIP of each pixel (H, W), float32, read-only; None for layers that are no colors."""
        return _fathom.difference_map(self._core, True)

    @property
    def map(self) -> np.ndarray:
        """Largest absolute difference over the channels of each pixel (H, W), float32, read-only."""
        return _fathom.difference_map(self._core, False)

    @property
    def explained_by_noise(self) -> bool | None:
        """Whether noise explains the differences; None if an image doesn't state its noise."""
        return self._numbers["noise"]["explains_differences"] if "noise" in self._numbers else None

    @property
    def changed_blocks(self) -> list[tuple[int, int, int, int]]:
        """Blocks of pixels, as x0, y0, x1, y1, whose difference noise does not explain; largest evidence first."""
        return [tuple(block["pixels"]) for block in self._numbers.get("noise", {"changed_blocks": []})["changed_blocks"]]

    @property
    def numbers(self) -> dict[str, Any]:
        """All numbers, as ``fathom diff --json`` prints them."""
        return self._numbers

    def save(self, path: str | os.PathLike) -> None:
        """Writes the FLIP map with its scale and the numbers as an image; ``.exr``: the values of the map."""
        self._core.save(pathlib.Path(path))

    def __str__(self) -> str:
        return "\n".join(self._core.text())

    def __repr__(self) -> str:
        flip = "" if self.flip is None else f", FLIP {self.flip:.4g}"
        return f"<fathom.Difference: {self.different_pixels} pixels, largest {self.largest:.4g}{flip}>"


def diff(image: Any, reference: Any, *, tolerance: float = 0, layer: str | None = None) -> Difference:
    """Compares an image with a reference of the same size.

    image, reference : a path; a :class:`fathom.Image`; or an array (H, W), (H, W, 3) or (H, W, 4): uint8 and uint16 are
        display values, floats are linear radiance
    tolerance : largest difference of a channel that counts as none: in radiance, or of 1 for display values
    layer : layer to compare, such as ``"depth"``; by default the image itself

    Raises fathom.Error if the images can't be read or compared."""
    tolerance = float(tolerance)
    if not 0 <= tolerance < math.inf:
        raise ValueError(f"tolerance: expected a number from 0 on, found {tolerance}")
    return Difference(_fathom.compare(_comparable(image, "image"), _comparable(reference, "reference"), tolerance, layer or ""))


def _comparable(value: Any, name: str) -> _fathom.Comparable:
    if isinstance(value, (str, os.PathLike)):
        return _fathom.comparable_file(pathlib.Path(value))
    if isinstance(value, Image):
        made = _fathom.comparable_layers(value._layers, name)
        if value._run is not None:
            made.add_film(value._run.film)
        return made
    array = np.asarray(value)
    if array.dtype.kind != "f" and array.dtype not in (np.uint8, np.uint16):
        raise TypeError(f"{name}: expected a path, an Image, or an array of uint8, uint16 or floats, found "
                        f"{type(value).__name__ if array.dtype == object else array.dtype}")
    pixels = array[..., None] if array.ndim == 2 else array
    if pixels.ndim != 3 or pixels.shape[2] not in (1, 3, 4) or 0 in pixels.shape:
        raise ValueError(f"{name}: expected shape (H, W), (H, W, 3) or (H, W, 4), found {array.shape}")
    is_linear = array.dtype.kind == "f"
    scale = 1 if is_linear else np.iinfo(array.dtype).max
    floats = np.ascontiguousarray(pixels, np.float32) / np.float32(scale)
    channels = {1: ["Y"], 3: ["R", "G", "B"], 4: ["R", "G", "B", "A"]}[pixels.shape[2]]
    return _fathom.comparable_array(floats, channels, is_linear, name)
