# SPDX-License-Identifier: Apache-2.0
"""Encodes arrays as image files in memory."""
from __future__ import annotations

import struct
import zlib

import numpy as np


def encode_png(pixels: np.ndarray, level: int = 6) -> bytes:
    """Returns a PNG file of an (H, W) or (H, W, 1 to 4) array of uint8 or uint16: gray, gray with alpha, RGB, RGBA."""
    pixels = pixels.reshape(pixels.shape[0], pixels.shape[1], -1)
    height, width, channels = pixels.shape
    color_type = {1: 0, 2: 4, 3: 2, 4: 6}[channels]
    bits = 8 * pixels.dtype.itemsize
    rows = np.ascontiguousarray(pixels, dtype=pixels.dtype.newbyteorder(">")).view(np.uint8).reshape(height, -1)
    unfiltered = np.zeros((height, rows.shape[1] + 1), np.uint8)  # each row begins with the number of its filter
    unfiltered[:, 1:] = rows

    def chunk(kind: bytes, data: bytes) -> bytes:
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    header = struct.pack(">IIBBBBB", width, height, bits, color_type, 0, 0, 0)
    return (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(unfiltered.tobytes(), level))
            + chunk(b"IEND", b""))


def encode_pfm(pixels: np.ndarray) -> bytes:
    """Returns a PFM file of an (H, W), (H, W, 1) or (H, W, 3) array of floats."""
    pixels = np.asarray(pixels, "<f4").reshape(pixels.shape[0], pixels.shape[1], -1)
    height, width, channels = pixels.shape
    kind = {1: "Pf", 3: "PF"}[channels]
    return f"{kind}\n{width} {height}\n-1.0\n".encode() + pixels[::-1].tobytes()


def encode_texture(pixels: np.ndarray) -> bytes:
    """Returns an image file that keeps all values of the array: PNG for integers, PFM for floats."""
    channels = 1 if pixels.ndim == 2 else pixels.shape[2] if pixels.ndim == 3 else 0
    if not 1 <= channels <= 4 or 0 in pixels.shape:
        raise ValueError(f"an image is an array (H, W) or (H, W, 1 to 4), found shape {pixels.shape}")
    if pixels.dtype in (np.uint8, np.uint16):
        return encode_png(pixels, level=1)
    if pixels.dtype.kind == "f":
        if channels not in (1, 3):
            raise ValueError(f"an image of floats has 1 or 3 channels, found {channels}; use uint8 or uint16 for alpha")
        if not np.isfinite(pixels).all():
            raise ValueError("an image has values that are NaN or infinite")
        return encode_pfm(pixels)
    raise TypeError(f"an image has the dtype uint8, uint16 or float32, found {pixels.dtype}")
