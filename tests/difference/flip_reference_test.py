#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Compares FLIP of `fathom diff` with the authors' implementation, pixel by pixel, for PNG and EXR.

usage: flip_reference_test.py PROGRAM SCENES

Skipped (77) without NumPy and flip-evaluator: `pip install flip-evaluator`.
"""
import json
import pathlib
import struct
import subprocess
import sys
import tempfile

try:
    import flip_evaluator
    import numpy as np
except ImportError as error:
    print(f"skipped: {error}; pip install flip-evaluator")
    sys.exit(77)

PROGRAM, SCENES = sys.argv[1], pathlib.Path(sys.argv[2])
# Largest differences of a pixel's FLIP and of the means, by rounding to single precision.
MAX_DIFFERENCE, MAX_OF_MEANS = 1e-4, 2e-6


def run(*words, codes=(0,)):
    result = subprocess.run([PROGRAM, *map(str, words)], capture_output=True, text=True)
    assert result.returncode in codes, (words, result.stderr)
    return result.stdout


def read_gray_exr(path):
    """Reads an EXR of one float channel whose lines are not compressed, or are by ZIP of 16 lines."""
    import zlib
    data = path.read_bytes()
    at, header = 8, {}
    while data[at]:
        name, at = data[at:data.index(b"\0", at)].decode(), data.index(b"\0", at) + 1
        at = data.index(b"\0", at) + 1
        size, = struct.unpack_from("<i", data, at)
        header[name], at = data[at + 4:at + 4 + size], at + 4 + size
    x0, y0, x1, y1 = struct.unpack("<4i", header["dataWindow"])
    width, height, compression = x1 - x0 + 1, y1 - y0 + 1, header["compression"][0]
    lines = {0: 1, 2: 1, 3: 16}[compression]
    chunks = -(-height // lines)
    offsets = struct.unpack_from(f"<{chunks}Q", data, at + 1)
    pixels = np.empty((height, width), np.float32)
    for i, offset in enumerate(offsets):
        _, size = struct.unpack_from("<2i", data, offset)
        rows = min(lines, height - i * lines)
        packed = data[offset + 8:offset + 8 + size]
        if compression and size < rows * width * 4:
            packed = unpredicted(zlib.decompress(packed))
        pixels[i * lines:i * lines + rows] = np.frombuffer(packed, np.float32).reshape(rows, width)
    return pixels


def unpredicted(packed):
    """Undoes the predictor and the order of bytes of ZIP in OpenEXR."""
    values = np.frombuffer(packed, np.uint8).astype(np.int64)
    values[1:] -= 128
    values = (np.cumsum(values) & 255).astype(np.uint8)
    result, half = np.empty_like(values), (len(values) + 1) // 2
    result[0::2], result[1::2] = values[:half], values[half:]
    return result.tobytes()


def check(folder, name, image, reference, kind):
    map_file = folder / "map.exr"
    found = json.loads(run("diff", image, reference, "--json", "-o", map_file, codes=(0, 1)))["flip"]
    expected, mean, parameters = flip_evaluator.evaluate(str(reference), str(image), kind, applyMagma=False)
    ours = read_gray_exr(map_file)
    largest = float(np.abs(ours - np.asarray(expected).reshape(ours.shape)).max())
    print(f"{name}: mean {found['mean']:.6f}, theirs {mean:.6f}, largest difference of a pixel {largest:.2g}")
    assert found["mean"] > 1e-3, "the images hardly differ"
    assert abs(found["mean"] - mean) < MAX_OF_MEANS and largest < MAX_DIFFERENCE
    if kind == "HDR":
        assert found["exposures"] == parameters["numExposures"]
        assert abs(found["first_ev"] - parameters["startExposure"]) < 1e-4
        assert abs(found["last_ev"] - parameters["stopExposure"]) < 1e-4


with tempfile.TemporaryDirectory() as name:
    folder = pathlib.Path(name)
    for scene in ("cornell-box", "textures", "environment"):
        for seed, samples in ((1, 4), (2, 64)):
            run("render", SCENES / f"{scene}.json", "--seed", seed, "--spp", samples, "--size", "173x96", "-q",
                "-o", folder / f"{seed}.png", "-o", folder / f"{seed}.exr")
        check(folder, f"{scene}.png", folder / "1.png", folder / "2.png", "LDR")
        check(folder, f"{scene}.exr", folder / "1.exr", folder / "2.exr", "HDR")
