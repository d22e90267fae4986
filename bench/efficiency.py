#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Efficiency, 1 / (relMSE x seconds), of the Cornell box at 64 samples per pixel, beside Mitsuba 3 `llvm_ad_rgb` with
each of its unbiased samplers that supports 64 (`orthogonal` takes 121), against a reference by Fathom (another seed,
16,384 samples).

usage: bench/efficiency.py --peers FOLDER [--fathom PROGRAM] [--rounds 3] [--reference-spp 16384] [--threads 2]

FOLDER holds a module `cornell` that describes the box (`surfaces()` in quads), and a module `common` that finds
Mitsuba (`enter`, `mitsuba`). Seconds are rendering time; for Fathom, the time of a whole command minus that with 2
samples, for the 62 samples between, scaled to 64. relMSE: mean of (I - R)^2 / (R^2 + 0.01).
"""
import argparse, json, statistics, subprocess, sys, tempfile, time
from pathlib import Path

import machine

ROOT = Path(__file__).resolve().parent.parent
SAMPLERS = ["independent", "stratified", "multijitter"]
SPP = 64


def fathom(program, out, spp, seed, threads, kernel=None):
    command = [str(program), "render", str(ROOT / "scenes/cornell-box.json"), "--spp", str(spp), "--seed", str(seed), "--filter",
               "box", "--max-depth", "50", "--roulette-depth", "5", "--threads", str(threads), "-q", "-o", str(out)]
    start = time.perf_counter()
    subprocess.run(command, check=True, env=machine.environment_of(kernel))
    return time.perf_counter() - start


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--peers", required=True, type=Path)
    parser.add_argument("--fathom", default=ROOT / "build/release/bin/fathom")
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--reference-spp", type=int, default=16384)
    parser.add_argument("--threads", type=int, default=2)
    args = parser.parse_args()
    sys.path.insert(0, str(args.peers.resolve()))
    import common, cornell
    common.enter("mitsuba")
    mi = common.mitsuba("llvm_ad_rgb", args.threads)
    import numpy as np

    def read(path):
        bitmap = mi.Bitmap(str(path))
        names = [field.name for field in bitmap.struct_()]
        return np.array(bitmap, dtype="f8")[:, :, [names.index(c) for c in "RGB"]]

    def relmse(image):
        return float((((image - reference) ** 2) / (reference ** 2 + 0.01)).mean())

    with tempfile.TemporaryDirectory() as folder:
        out = Path(folder) / "picture.exr"
        fathom(args.fathom, out, args.reference_spp, 987654, args.threads)
        reference = read(out)
        scenes = {sampler: cornell_scene(mi, cornell, sampler) for sampler in SAMPLERS}
        for scene in scenes.values():
            np.array(mi.render(scene, spp=1, seed=1))
        results = {}
        for round in range(args.rounds):
            for kernel in machine.kernels_of(args.fathom)[:2]:
                few = fathom(args.fathom, out, 2, round, args.threads, kernel)
                seconds = (fathom(args.fathom, out, SPP, round, args.threads, kernel) - few) * SPP / (SPP - 2)
                results.setdefault("fathom " + kernel, []).append((relmse(read(out)), seconds))
            for sampler, scene in scenes.items():
                start = time.perf_counter()
                image = np.array(mi.render(scene, spp=SPP, seed=100 + round), dtype="f8")
                seconds = time.perf_counter() - start
                results.setdefault("mitsuba " + sampler, []).append((relmse(image[:, :, :3]), seconds))
    summary = {}
    for name, runs in results.items():
        error, seconds = (statistics.median(column) for column in zip(*runs))
        summary[name] = {"relmse": round_to(error), "seconds": round_to(seconds), "efficiency": round_to(1 / (error * seconds))}
    best = max(v["efficiency"] for k, v in summary.items() if k.startswith("mitsuba"))
    for name, value in summary.items():
        value["times_best_of_mitsuba"] = round_to(value["efficiency"] / best)
    print(json.dumps(summary, indent=1))


def round_to(x):
    return float(f"{x:.4g}")


def cornell_scene(mi, cornell, sampler):
    """The box as a Mitsuba scene, from its quads."""
    import numpy as np
    T = mi.ScalarTransform4f
    colours = {"green": cornell.GREEN, "red": cornell.RED, "white": cornell.WHITE, "back": cornell.WHITE}
    scene = {
        "type": "scene",
        "integrator": {"type": "path", "max_depth": cornell.BOUNCES + 1, "rr_depth": 5},
        "sensor": {"type": "perspective", "fov": cornell.FOV_Y, "fov_axis": "y",
                   "to_world": T().look_at(origin=cornell.EYE, target=cornell.TARGET, up=cornell.UP),
                   "film": {"type": "hdrfilm", "width": cornell.WIDTH, "height": cornell.HEIGHT, "rfilter": {"type": "box"},
                            "pixel_format": "rgb", "component_format": "float32"},
                   "sampler": {"type": sampler, "sample_count": SPP}},
    }
    for i, (corner, a, b, name) in enumerate(cornell.surfaces()):
        corner, a, b = (np.array(v, dtype="f8") for v in (corner, a, b))
        normal = np.cross(a, b)
        matrix = np.eye(4)
        matrix[:3, 0], matrix[:3, 1], matrix[:3, 2] = a / 2, b / 2, normal / np.linalg.norm(normal)
        matrix[:3, 3] = corner + a / 2 + b / 2
        shape = {"type": "rectangle", "to_world": T(matrix)}
        if name == "light":
            shape["bsdf"] = {"type": "diffuse", "reflectance": {"type": "rgb", "value": 0}}
            shape["emitter"] = {"type": "area", "radiance": {"type": "rgb", "value": cornell.RADIANCE}}
        else:
            shape["bsdf"] = {"type": "diffuse", "reflectance": {"type": "rgb", "value": list(colours[name])}}
        scene[f"shape{i}"] = shape
    return mi.load_dict(scene)


main()
