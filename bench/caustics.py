#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Efficiency, 1 / (relMSE x seconds), of `--caustics on` relative to `--caustics off` in rooms with glass.

usage: bench/caustics.py [--fathom PROGRAM] [--spp 32] [--reference-spp 2048] [--rounds 3] [--only NAME...] [SCENE...]

Two rooms are rendered under several lamps: `large`, a box with a ball of glass that takes much of the lamp's light, and
`small`, a room of 10 m in which a ball of 30 cm lies on the floor, seen from close by. SCENE: more scene files. References
have another seed and `--caustics on`, which is unbiased. Seconds are the rendering time that the program prints, which
includes learning. The first figure is of all errors, the second without the largest 0.1 %. Needs numpy and OpenEXR.
"""
import argparse, json, re, statistics, subprocess, tempfile
from pathlib import Path

import numpy as np

import exr

ROOT = Path(__file__).resolve().parent.parent
MATERIALS = {
    "white": {"kind": "diffuse", "color": [0.73, 0.73, 0.73]}, "green": {"kind": "diffuse", "color": [0.12, 0.45, 0.15]},
    "red": {"kind": "diffuse", "color": [0.65, 0.05, 0.05]}, "glass": {"kind": "glass", "ior": 1.5},
    "metal": {"kind": "metal", "color": [0.9, 0.7, 0.4], "roughness": 0.25}, "lamp": {"kind": "none", "emission": [60, 60, 60]}}


def rectangle(material, corner, u, v):
    return {"material": material, "rectangle": {"corner": corner, "edge_u": u, "edge_v": v}}


def ball(material, center, radius):
    return {"material": material, "sphere": {"center": center, "radius": radius}}


def walls(size, height):
    h = size / 2
    return [rectangle("white", [-h, height, -h], [size, 0, 0], [0, 0, size]),
            rectangle("red", [-h, 0, -h], [0, height, 0], [0, 0, size]), rectangle("green", [h, 0, -h], [0, 0, size], [0, height, 0]),
            rectangle("white", [-h, 0, -h], [size, 0, 0], [0, height, 0])]


def rooms():
    """Returns name: (shapes, walls, camera, size, place of the lamp)."""
    floor = lambda size: [rectangle("white", [-size / 2, 0, -size / 2], [0, 0, size], [size, 0, 0])]
    large = floor(5.5) + [ball("glass", [-1, 1, -1], 1), ball("metal", [1.1, 0.9, 0.6], 0.9)]
    small = floor(10) + [ball("glass", [1, 0.15, 1], 0.15), ball("metal", [0.5, 0.12, 1.2], 0.12)]
    view = lambda position, at, fov: {"position": position, "look_at": at, "up": [0, 1, 0], "fov_y_deg": fov}
    return {"large": (large, walls(5.5, 5.5), view([0, 2.8, 10.5], [0, 2.6, 0], 40), 0.6, [0, 5.4, 0]),
            "small": (small, walls(10, 4), view([1.9, 0.9, 2.4], [0.9, 0.1, 1], 35), 0.4, [0, 3.9, 0])}


def scenes():
    """Returns name: scene, for each room and lamp. Path tracing finds the caustics of all these lamps."""
    result = {}
    for name, (shapes, closed, camera, size, at) in rooms().items():
        h = size / 2
        below = [at[0], at[1] - 1, at[2]]
        grid = [rectangle("lamp", [-4.5 + 1.5 * i, at[1], -4.5 + 1.5 * k], [0.2, 0, 0], [0, 0, 0.2]) for i in range(6) for k in range(6)]
        lamps = {
            "rectangle": {"scene": shapes + closed + [rectangle("lamp", [at[0] - h, at[1], at[2] - h], [size, 0, 0], [0, 0, size])]},
            "sphere": {"scene": shapes + closed + [ball("lamp", below, h / 2)]},
            "sun": {"scene": shapes, "lights": {"sun": {"kind": "directional", "intensity": 10, "direction": [-0.3, -1, -0.4], "angle_deg": 2}}},
            "sky": {"scene": shapes, "environment": {"kind": "sky", "to_sun": [0.4, 0.7, 0.4]}}}
        if name == "small":
            lamps["36 rectangles"] = {"scene": shapes + closed + grid}
        for lamp, parts in lamps.items():
            result[f"{name}, {lamp}"] = {"fathom": 1, "camera": camera, "materials": MATERIALS, **parts}
    return result


def render(program, scene, spp, seed, caustics, out):
    command = [str(program), "render", str(scene), "--size", "320x240", "--spp", str(spp), "--seed", str(seed), "--guiding", "off",
               "--caustics", caustics, "-o", str(out)]
    out.unlink(missing_ok=True)
    run = subprocess.run(command, check=True, capture_output=True, text=True)
    return float(re.search(r"render ([\d.]+) s", run.stderr)[1])


def errors(image, reference):
    """relMSE of all pixels, and without the largest errors."""
    error = (image - reference) ** 2 / (reference ** 2 + 0.01 * (reference.mean() / 0.12) ** 2)
    return error.mean(), exr.relmse(image, reference)


def measure(options, scene, folder):
    out = folder / "image.exr"
    render(options.fathom, scene, options.reference_spp, 987654, "on", out)
    reference, results = exr.picture(out), {"off": [], "on": []}
    for seed in range(options.rounds):
        for caustics, runs in results.items():
            seconds = render(options.fathom, scene, options.spp, seed, caustics, out)
            runs.append((seconds, *errors(exr.picture(out), reference)))
    off, on = (([statistics.median(r[0] for r in runs)] + list(np.mean([r[1:] for r in runs], 0))) for runs in results.values())
    time = on[0] / off[0]
    return off[1] / on[1], off[2] / on[2], time


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--fathom", type=Path, default=ROOT / "build/release/bin/fathom")
    parser.add_argument("--spp", type=int, default=32)
    parser.add_argument("--reference-spp", type=int, default=2048)
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--only", nargs="+", default=[])
    parser.add_argument("scenes", nargs="*", metavar="SCENE")
    options = parser.parse_args()
    print("| scene | efficiency | without 0.1 % | noise | without 0.1 % | time |\n| --- | --- | --- | --- | --- | --- |")
    with tempfile.TemporaryDirectory() as folder:
        files = {}
        for name, scene in scenes().items():
            files[name] = Path(folder) / (name.replace(", ", "-") + ".json")
            files[name].write_text(json.dumps(scene))
        if options.scenes:
            files = {}
        files |= {Path(s).parent.name + "/" + Path(s).name: Path(s) for s in options.scenes}
        for name, file in files.items():
            if options.only and name not in options.only:
                continue
            noise, trimmed, time = measure(options, file, Path(folder))
            print(f"| {name} | {noise / time:.2g} | {trimmed / time:.2g} | {noise:.3g} | {trimmed:.3g} | {time:.2f} |", flush=True)


if __name__ == "__main__":
    main()
