#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Noise at equal samples beside each sampler of Mitsuba 3: relMSE of diffuse twins of its scenes; a table in Markdown.

    bench/samplers.py [--peers FOLDER] [--fathom PROGRAM] [--width 320] [--spp 64] [--seeds 2] [--reference-spp 1024]
    TWIN...

TWIN: a folder made by scenes.py, by default in ~/.cache/fathom-scenes. FOLDER holds a module `common` that finds
Mitsuba (`enter`, `mitsuba`). `orthogonal` needs squares of primes: the next lower one is used, and its error is scaled
to the others' number of samples. Fathom runs without guiding and with default settings. relMSE refers to a long render
by Fathom, without the largest 0.1 % of errors. Nothing is timed.
"""
import argparse
import json
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
SAMPLERS = ["independent", "stratified", "multijitter", "orthogonal", "ldsampler"]

parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
parser.add_argument("--peers", type=Path, default=ROOT / "../shared/peers")
parser.add_argument("--fathom", type=Path, default=ROOT / "build/release/bin/fathom")
parser.add_argument("--width", type=int, default=320)
parser.add_argument("--spp", type=int, default=64)
parser.add_argument("--seeds", type=int, default=2)
parser.add_argument("--reference-spp", type=int, default=1024)
parser.add_argument("twins", type=Path, nargs="+")
args = parser.parse_args()
sys.path.insert(0, str(args.peers.resolve()))
import common  # noqa: E402

common.enter("clay")  # restarts in an environment with the packages imported below
import numpy as np  # noqa: E402

import exr  # noqa: E402
from scenes import options_of  # noqa: E402

mi = common.mitsuba("llvm_ad_rgb", 2)


def square_of_prime(most):
    primes = [n for n in range(2, int(most ** 0.5) + 1) if all(n % k for k in range(2, n))]
    return primes[-1] ** 2


def mitsuba_scene(twin, sampler, size):
    """Writes the scene with another sampler beside the original temporarily: its files are found relative to it."""
    text = (twin / "scene.xml").read_text().replace('<sampler type="independent">', f'<sampler type="{sampler}">')
    with tempfile.NamedTemporaryFile("w", suffix=".xml", dir=twin) as file:
        file.write(text)
        file.flush()
        scene = mi.load_file(file.name)
    sensor = mi.traverse(scene.sensors()[0])
    sensor["film.size"] = size
    sensor.update()
    return scene


def vertical_fov(scene, size):
    across = np.radians(float(np.ravel(mi.traverse(scene.sensors()[0])["x_fov"])[0]))
    return 2 * np.degrees(np.arctan(np.tan(across / 2) * size[1] / size[0]))


def errors(twin, pictures):
    width, height = json.loads((twin / "scene.json").read_text())["render"]["size"]
    size = [args.width, height * args.width // width]
    fov = vertical_fov(mitsuba_scene(twin, "independent", size), size)

    def fathom(samples, seed, *options):
        out = Path(pictures) / "picture.exr"
        subprocess.run([args.fathom, "render", twin / "scene.json", "--spp", str(samples), "--seed", str(seed), "--size", f"{size[0]}x{size[1]}", "--filter",
                        "box", "--fov", f"{fov:.9g}", "--threads", "2", "-q", "-o", out, *options_of(twin), *options], check=True, stderr=subprocess.DEVNULL)
        return exr.picture(out)

    reference = fathom(args.reference_spp, 99)
    path = mi.load_dict({"type": "path", "max_depth": -1, "rr_depth": 5})
    seeds = range(1, args.seeds + 1)
    for sampler in SAMPLERS:
        scene, samples = mitsuba_scene(twin, sampler, size), square_of_prime(args.spp) if sampler == "orthogonal" else args.spp
        pictures_of = (np.array(mi.render(scene, integrator=path, sensor=0, spp=samples, seed=k)).astype(np.float64)[..., :3] for k in seeds)
        yield np.mean([exr.relmse(p, reference) for p in pictures_of]) * samples / args.spp
    for options in (["--guiding", "off"], []):
        yield np.mean([exr.relmse(fathom(args.spp, k, *options), reference) for k in seeds])


print("| scene | " + " | ".join(SAMPLERS) + " | ours, not guided | ours |\n|" + " --- |" * (len(SAMPLERS) + 3))
for twin in args.twins:
    with tempfile.TemporaryDirectory() as pictures:
        print(f"| {twin.name} | " + " | ".join(f"{e:.3g}" for e in errors(twin, pictures)) + " |", flush=True)
