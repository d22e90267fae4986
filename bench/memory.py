#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Estimated and actual memory of renders: the estimate of --memory beside the peak of resident memory.

    bench/memory.py build/release/bin/fathom [FOLDER]

Scenes with one kind of content each are made in FOLDER (default: a temporary one). --memory 1M, which rejects every
scene, prints the estimate; then the scene is rendered with exactly that limit. Exits with 1 if a render exceeds its
limit.
"""
import array
import json
import math
import random
import re
import struct
import subprocess
import sys
import tempfile
import zlib
from pathlib import Path

CAMERA = {"position": [0, 2, 4], "look_at": [0, 0, 0]}
GREY = {"w": {"kind": "diffuse", "color": [0.5, 0.5, 0.5]}}
GLOW = {"w": {"kind": "diffuse", "color": [0.5, 0.5, 0.5], "emission": [1, 1, 1]}}


def write_ply(path, positions, indices):
    corners = len(indices) // 3
    faces = bytearray(13 * corners)
    faces[0::13] = b"\3" * corners
    raw = array.array("i", indices).tobytes()
    for byte in range(12):
        faces[1 + byte::13] = raw[byte::12]
    with open(path, "wb") as file:
        file.write(f"ply\nformat binary_little_endian 1.0\nelement vertex {len(positions) // 3}\nproperty float x\nproperty float y\n"
                   f"property float z\nelement face {corners}\nproperty list uchar int vertex_indices\nend_header\n".encode())
        file.write(array.array("f", positions).tobytes() + faces)


def grid(path, n):
    """A mesh of 2 n^2 triangles with shared vertices."""
    chance = random.Random(1)
    positions = [v for r in range(n + 1) for c in range(n + 1)
                 for v in (2 * c / n - 1, 0.05 * chance.random(), 2 * r / n - 1)]
    indices = [i for r in range(n) for a in range(r * (n + 1), r * (n + 1) + n)
               for i in (a, a + 1, a + n + 1, a + 1, a + n + 2, a + n + 1)]
    write_ply(path, positions, indices)


def soup(path, n):
    """Long thin triangles without shared vertices."""
    chance = random.Random(2)
    positions = []
    for _ in range(n):
        x, y, z = (2 * chance.random() - 1 for _ in range(3))
        positions += [x, y, z, x + 0.4 * chance.random(), y, z, x, y + 0.01 * chance.random(), z + 0.01]
    write_ply(path, positions, range(3 * n))


def png(path, side, bits):
    """A noise image of three channels."""
    row = 3 * side * bits // 8
    data = random.Random(3).randbytes(row * side)
    raw = b"".join(b"\0" + data[y * row:(y + 1) * row] for y in range(side))

    def chunk(kind, body):
        return struct.pack(">I", len(body)) + kind + body + struct.pack(">I", zlib.crc32(kind + body))
    path.write_bytes(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", side, side, bits, 2, 0, 0, 0)) +
                     chunk(b"IDAT", zlib.compress(raw, 0)) + chunk(b"IEND", b""))


def hdr(path, width):
    height = width // 2
    path.write_bytes(b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n" + f"-Y {height} +X {width}\n".encode() +
                     random.Random(4).randbytes(width * height * 4))


def scene(folder, name, **parts):
    base = {"fathom": 1, "camera": CAMERA, "environment": {"kind": "gradient"}, "materials": GREY}
    path = folder / f"{name}.json"
    path.write_text(json.dumps({**base, **parts}))
    return path


def hair(count):
    chance = random.Random(5)
    return [[[x + 0.02 * i, 0.1 * i + 0.02 * chance.random(), z, 0.002] for i in range(6)]
            for x, z in ((2 * chance.random() - 1, 2 * chance.random() - 1) for _ in range(count))]


def make_scenes(folder):
    grid(folder / "grid.ply", 1000)
    grid(folder / "tile.ply", 60)
    grid(folder / "glow.ply", 750)
    soup(folder / "soup.ply", 1000000)
    for bits in 8, 16:
        png(folder / f"noise{bits}.png", 4096, bits)
    hdr(folder / "sky.hdr", 6000)
    ball = {"sphere": {"radius": 1}, "material": "w"}
    chance = random.Random(6)
    places = [{"instance": "tile", "transform": {"translate": [20 * chance.random(), 0, 20 * chance.random()]}} for _ in range(200000)]
    points = [[chance.random(), chance.random(), chance.random(), 0.001] for _ in range(1000000)]
    small = ["--size", "64x64"]
    plain = scene(folder, "ball", scene=[ball])
    models = {name: scene(folder, name, scene=[{"model": f"{name}.ply", "material": "w"}]) for name in ("grid", "soup")}
    every = "albedo,normal,depth,position,instance,material,samples,variance"
    film = folder / "film.exr"
    return [
        ("2 M triangles", models["grid"], small),
        ("2 M triangles, --build high", models["grid"], [*small, "--build", "high"]),
        ("1 M thin triangles", models["soup"], small),
        ("1 M thin triangles, --build fast", models["soup"], [*small, "--build", "fast"]),
        ("1 M thin triangles, --build high", models["soup"], [*small, "--build", "high"]),
        ("1 M thin triangles, --build compact", models["soup"], [*small, "--build", "compact"]),
        ("1.1 M triangles that are lights",
         scene(folder, "glow", materials=GLOW, scene=[{"model": "glow.ply", "material": "w"}]), small),
        ("200,000 instances", scene(folder, "instances", nodes={"tile": {"model": "tile.ply", "material": "w"}}, scene=places), small),
        ("1 M balls", scene(folder, "points", scene=[{"points": {"points": points}, "material": "w"}]), small),
        ("60,000 hairs", scene(folder, "hair", scene=[{"curves": {"curves": hair(60000)}, "material": "w"}]), small),
        ("three pictures of 4096x4096",
         scene(folder, "textures",
               textures={"a": {"image": "noise8.png"}, "b": {"image": "noise16.png"}, "c": {"image": "noise16.png", "color_space": "linear"}},
               materials={"w": {"kind": "diffuse", "color": "a"}, "v": {"kind": "diffuse", "color": "b"}},
               scene=[ball, {"sphere": {"center": [2, 0, 0], "radius": 1}, "material": "v"}]), small),
        ("a sky of 6000x3000", scene(folder, "sky", environment={"kind": "image", "image": "sky.hdr"}, scene=[ball]), small),
        ("film of 4096x4096", plain, ["--size", "4096x4096", "-o", folder / "o.png"]),
        ("film of 4096x4096, mergeable", plain, ["--size", "4096x4096", "--mergeable"]),
        ("film of 4096x4096, --checkpoint", plain, ["--size", "4096x4096", "--checkpoint", film]),
        ("film of 2048x2048, all layers, --checkpoint", plain, ["--size", "2048x2048", "--aov", every, "--checkpoint", film]),
        ("film of 4096x2048, WebP and AVIF", plain, ["--size", "4096x2048", "-o", folder / "o.webp", "-o", folder / "o.avif"]),
        ("film of 4096x4096, PNG of 16 bits, alpha", plain,
         ["--size", "4096x4096", "--background", "transparent", "--png-bits", "16", "-o", folder / "o.png"]),
        ("2 M triangles, film of 4096x4096", models["grid"], ["--size", "4096x4096"]),
    ]


def needed_bytes(program, file, options):
    # Reading the scene needs memory too.
    found = None
    for allowed in 1, *range(20, 400, 20):
        result = subprocess.run([program, "render", file, *options, "--memory", f"{allowed}M"], capture_output=True, text=True)
        if result.returncode == 0:
            return allowed * 1e6
        found = re.search(r"needs some ([\d.]+) (GB|MB)", result.stderr)
        if found:
            break
    if not found:
        sys.exit(f"{file}: says nothing of what it needs: {result.stderr}")
    # The printed figure is rounded.
    return float(found[1]) * 1e9 + 5e7 if found[2] == "GB" else float(found[1]) * 1e6 + 5e5


def peak_bytes(program, file, options, allowed):
    result = subprocess.run([program, "render", file, *options, "--memory", f"{math.ceil(allowed / 1e6)}M", "--progress", "json"],
                            capture_output=True, text=True)
    if result.returncode != 0:
        sys.exit(f"{file}: {result.stderr[-500:]}")
    return json.loads(result.stderr.splitlines()[-1])["peak_memory_bytes"]


def measure(program, folder):
    failed = 0
    print("| scene | needs, MB | took, MB | |\n| --- | ---: | ---: | ---: |")
    for name, file, options in make_scenes(folder):
        words = [*map(str, options), "--spp", "2", "-o", str(folder / "o.exr")]
        needed = needed_bytes(program, file, words)
        (folder / "film.exr").unlink(missing_ok=True)
        took = peak_bytes(program, file, words, needed)
        failed += took > needed
        print(f"| {name} | {needed / 1e6:.0f} | {took / 1e6:.0f} | {took / needed:.2f} |{' TOO MUCH' if took > needed else ''}", flush=True)
    return 1 if failed else 0


if __name__ == "__main__":
    if len(sys.argv) not in (2, 3):
        sys.exit(__doc__)
    if len(sys.argv) == 3:
        Path(sys.argv[2]).mkdir(parents=True, exist_ok=True)
        sys.exit(measure(sys.argv[1], Path(sys.argv[2])))
    with tempfile.TemporaryDirectory() as temporary:
        sys.exit(measure(sys.argv[1], Path(temporary)))
