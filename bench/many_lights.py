#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""A scene of many lights: a closed room of 10 x 4 x 10 m with N emissive, one-sided triangles at random positions and
orientations. Their total area is 1 m2 for every N.

usage: bench/many_lights.py N FOLDER [--dark M] [--equal]

Writes FOLDER/lamps-N.json and its meshes. Edge lengths vary by a factor of a hundred, or are equal with --equal.
--dark adds M triangles that don't emit, so that scenes of few and of many lights take the same time to trace. The
scenes are equal on every machine.
"""
import argparse, json, math, random, struct
from pathlib import Path


def direction(rng):
    z, phi = rng.uniform(-1, 1), rng.uniform(0, 2 * math.pi)
    r = math.sqrt(1 - z * z)
    return (r * math.cos(phi), r * math.sin(phi), z)


def cross(a, b):
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def triangle(rng, size):
    """Corners of an equilateral triangle with edges of length `size`."""
    n = direction(rng)
    s = cross(n, direction(rng))
    length = math.sqrt(sum(x * x for x in s))
    s = tuple(x / length for x in s)
    t = cross(n, s)
    center = (rng.uniform(-4.8, 4.8), rng.uniform(0.2, 3.8), rng.uniform(-4.8, 4.8))
    for k in range(3):
        c, d = math.cos(2 * math.pi * k / 3), math.sin(2 * math.pi * k / 3)
        yield tuple(center[i] + size / math.sqrt(3) * (c * s[i] + d * t[i]) for i in range(3))


def write_triangles(path, count, equal, seed):
    """A mesh with an area of 1 m2."""
    rng = random.Random(seed)
    sizes = [1.0 if equal else 100 ** rng.random() for _ in range(count)]
    scale = 1 / math.sqrt(sum(math.sqrt(3) / 4 * s * s for s in sizes))
    corners = [corner for s in sizes for corner in triangle(rng, s * scale)]
    with open(path, "wb") as ply:
        ply.write(f"ply\nformat binary_little_endian 1.0\nelement vertex {len(corners)}\nproperty float x\nproperty float y\n"
                  f"property float z\nelement face {count}\nproperty list uchar int vertex_indices\nend_header\n".encode())
        for corner in corners:
            ply.write(struct.pack("<3f", *corner))
        for i in range(count):
            ply.write(struct.pack("<B3i", 3, 3 * i, 3 * i + 1, 3 * i + 2))


def wall(corner, u, v):
    return {"material": "grey", "rectangle": {"corner": corner, "edge_u": u, "edge_v": v}}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("lamps", type=int)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--dark", type=int, default=0)
    parser.add_argument("--equal", action="store_true")
    args = parser.parse_args()
    meshes = {"lamps": args.lamps, **({"dark": args.dark} if args.dark else {})}
    for seed, (name, count) in enumerate(meshes.items()):
        write_triangles(args.folder / f"{name}-{count}.ply", count, args.equal, seed)
    scene = {
        "fathom": 1,
        "render": {"size": [320, 240], "max_depth": 4},
        "camera": {"position": [0, 2, 4.9], "look_at": [0, 1.8, 0], "up": [0, 1, 0], "fov_y_deg": 60},
        "materials": {"grey": {"kind": "diffuse", "color": [0.5, 0.5, 0.5]}, "lamps": {"kind": "none", "emission": [30, 30, 30]},
                      "dark": {"kind": "diffuse", "color": [0.2, 0.2, 0.2]}},
        "meshes": {name: {"file": f"{name}-{count}.ply"} for name, count in meshes.items()},
        "scene": [wall([-5, 0, 5], [10, 0, 0], [0, 0, -10]), wall([-5, 4, -5], [10, 0, 0], [0, 0, 10]),
                  wall([-5, 0, -5], [10, 0, 0], [0, 4, 0]), wall([5, 0, 5], [-10, 0, 0], [0, 4, 0]),
                  wall([-5, 0, 5], [0, 0, -10], [0, 4, 0]), wall([5, 0, -5], [0, 0, 10], [0, 4, 0]),
                  *({"material": name, "mesh": name} for name in meshes)],
    }
    (args.folder / f"lamps-{args.lamps}.json").write_text(json.dumps(scene, indent=1) + "\n")


main()
