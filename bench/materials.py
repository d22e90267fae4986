#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Cost of many materials beside one of the same kind, and of textures on everything beside plain colors.

A closed room of 8 x 4 x 8 m has 300 balls, each a mesh with uv coordinates, and two lamps. It is rendered with one
material on everything and with N materials of one kind, spread over the balls; then with and without a texture of 2048
x 2048 pixels of 8 bits in each material. Plain colors are the textures' means, so path lengths are equal. Each pair is
rendered in turns at equal samples; the result is the median ratio of the cost per sample. The scenes are equal on
every machine.
"""
import argparse, json, math, random, struct, subprocess, sys, tempfile, zlib
from pathlib import Path

import machine

ROOT = Path(__file__).resolve().parent.parent
BALLS, PICTURES, SIDE = 300, 8, 2048
KINDS = {"diffuse": {}, "principled": {"roughness": 0.5}}


def write_ball(path, center, radius, rows=12, columns=24):
    """The ball as a mesh with uv coordinates."""
    vertices, faces = [], []
    for i in range(rows + 1):
        for j in range(columns + 1):
            theta, phi = math.pi * i / rows, 2 * math.pi * j / columns
            n = (math.sin(theta) * math.cos(phi), math.cos(theta), math.sin(theta) * math.sin(phi))
            vertices.append((*(c + radius * x for c, x in zip(center, n)), j / columns, i / rows))
    for i in range(rows):
        for j in range(columns):
            a, b = i * (columns + 1) + j, (i + 1) * (columns + 1) + j
            faces += [face for face, is_there in (((a, a + 1, b + 1), i > 0), ((a, b + 1, b), i < rows - 1)) if is_there]
    with open(path, "wb") as ply:
        ply.write(f"ply\nformat binary_little_endian 1.0\nelement vertex {len(vertices)}\nproperty float x\nproperty float y\n"
                  f"property float z\nproperty float u0\nproperty float v0\nelement face {len(faces)}\n"
                  f"property list uchar int vertex_indices\nend_header\n".encode())
        for v in vertices:
            ply.write(struct.pack("<5f", *v))
        for f in faces:
            ply.write(struct.pack("<B3i", 3, *f))


def write_picture(path, seed):
    """Incompressible noise, unfriendly to caches: each channel of each pixel is 128 or 192 at random."""
    rng = random.Random(seed)
    levels = bytes(192 if byte & 1 else 128 for byte in range(256))
    rows = b"".join(b"\0" + rng.randbytes(3 * SIDE).translate(levels) for _ in range(SIDE))

    def chunk(name, data):
        return struct.pack(">I", len(data)) + name + data + struct.pack(">I", zlib.crc32(name + data))
    path.write_bytes(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">2I5B", SIDE, SIDE, 8, 2, 0, 0, 0)) +
                     chunk(b"IDAT", zlib.compress(rows, 1)) + chunk(b"IEND", b""))


def linear(code):
    return ((code / 255 + 0.055) / 1.055) ** 2.4


def write_scene(path, kind, count, textured):
    mean = (linear(128) + linear(192)) / 2

    def material(i):
        # Values differ by less than a hundredth, and none is repeated.
        value = 1 - 0.01 * i / count
        color = {"texture": f"t{i % PICTURES}", "value": [value] * 3} if textured else [mean * value] * 3
        return {"kind": kind, "color": color, **KINDS[kind]}

    def wall(corner, u, v):
        return {"material": "m0", "rectangle": {"corner": corner, "edge_u": u, "edge_v": v}}
    # The order is unrelated to position.
    order = list(range(BALLS))
    random.Random(5).shuffle(order)
    path.write_text(json.dumps({
        "fathom": 1, "render": {"size": [320, 240], "max_depth": 6},
        "camera": {"position": [0, 2, 3.9], "look_at": [0, 1.8, 0], "up": [0, 1, 0], "fov_y_deg": 70},
        "textures": {f"t{i}": {"image": f"picture-{i}.png"} for i in range(PICTURES)} if textured else {},
        "materials": {**{f"m{i}": material(i) for i in range(count)}, "lamp": {"kind": "none", "emission": [20, 20, 20]}},
        "scene": [wall([-4, 0, 4], [8, 0, 0], [0, 0, -8]), wall([-4, 4, -4], [8, 0, 0], [0, 0, 8]), wall([-4, 0, -4], [8, 0, 0], [0, 4, 0]),
                  wall([4, 0, 4], [-8, 0, 0], [0, 4, 0]), wall([-4, 0, 4], [0, 0, -8], [0, 4, 0]), wall([4, 0, -4], [0, 0, 8], [0, 4, 0]),
                  *({"material": "lamp", "rectangle": {"corner": [x, 3.9, -0.5], "edge_u": [1, 0, 0], "edge_v": [0, 0, 1]}} for x in (-2.5, 1.5)),
                  *({"material": f"m{order[i] % count}", "mesh": {"file": f"ball-{i}.ply"}} for i in range(BALLS))]}) + "\n")


def write_room(folder):
    rng = random.Random(1)
    for i in range(BALLS):
        place = (rng.uniform(-3.6, 3.6), rng.uniform(0.3, 3.6), rng.uniform(-3.6, 2.5))
        write_ball(folder / f"ball-{i}.ply", place, rng.uniform(0.15, 0.35))
    for i in range(PICTURES):
        write_picture(folder / f"picture-{i}.png", i)


def events_of(args, scene, *options):
    command = [str(args.fathom), "render", str(scene), "--spp", str(args.spp), "--threads", str(args.threads), "--guiding", "off",
               "--progress", "json", "-o", str(scene.with_suffix(".exr")), *options]
    lines = subprocess.run(command, check=True, capture_output=True, text=True).stderr.splitlines()
    return {event["event"]: event for event in map(json.loads, lines)}


def row(args, name, scene, other):
    """Cost per sample of `scene` relative to `other`, and time per stage of both."""
    ratios = []
    for round_number in range(args.rounds + 1):
        seconds = [events_of(args, path)["summary"]["render_s"] for path in (scene, other)]
        ratios += [seconds[0] / seconds[1]] if round_number > 0 else []  # the first round warms file caches
    ratios.sort()
    stages = [events_of(args, path, "--stats")["stats"]["stages"] for path in (scene, other)]
    more = {stage: costs["ns_per_vertex"] - stages[1].get(stage, {"ns_per_vertex": 0})["ns_per_vertex"] for stage, costs in stages[0].items()}
    most = sorted(more.items(), key=lambda item: -abs(item[1]))[:4]
    return (f"| {name} | {ratios[len(ratios) // 2]:.3f} | {ratios[0]:.3f} to {ratios[-1]:.3f} | "
            + ", ".join(f"{stage} {ns:+.1f}" for stage, ns in most) + " |")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--fathom", type=Path, default=ROOT / "build/release/bin/fathom")
    parser.add_argument("--materials", type=int, default=200)
    parser.add_argument("--spp", type=int, default=64)
    parser.add_argument("--threads", type=int, default=2)
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--folder", type=Path, help="where scenes are written and kept; else nowhere")
    args = parser.parse_args()
    with tempfile.TemporaryDirectory() as temporary:
        folder = args.folder or Path(temporary)
        folder.mkdir(parents=True, exist_ok=True)
        write_room(folder)
        version = subprocess.run([str(args.fathom), "version"], check=True, capture_output=True, text=True).stdout.splitlines()
        print(f"{machine.processor()}; {version[1].strip()}; {args.threads} threads, {args.spp} samples, {args.rounds} rounds\n")
        print("| room | cost of a sample | least, most | nanoseconds a vertex more |\n| --- | --- | --- | --- |")

        def scene(kind, count, textured):
            path = folder / f"{kind}-{count}{'-textured' if textured else ''}.json"
            write_scene(path, kind, count, textured)
            return path
        for kind in KINDS:
            one, many, pictures = scene(kind, 1, False), scene(kind, args.materials, False), scene(kind, args.materials, True)
            print(row(args, f"{args.materials} {kind} materials against one", many, one))
            print(row(args, f"pictures on all {args.materials} {kind} ones against none", pictures, many), flush=True)


if __name__ == "__main__":
    sys.exit(main())
