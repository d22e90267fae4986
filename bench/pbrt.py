#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Unmodified pbrt-v4 scenes beside pbrt's own reference images: mean of each channel, samples/s and noise per sample.

    bench/pbrt.py --fathom PROGRAM [--pbrt PROGRAM] [--spp 256] [--scenes ../shared/scenes/pbrt-v4] [NAME ...]

One thread, pbrt's image size and box filter. pbrt's noise is estimated from two halves of its reference, of 384
samples each. Its speed is measured with the given program, in turns with Fathom, as processor time with its fastest
sampler (`independent`); without a program it is taken from the reference's JSON file, and so from another machine.
Needs numpy and OpenEXR.
"""
import argparse
import json
import re
import resource
import statistics
import subprocess
import tempfile
from pathlib import Path

import numpy as np
from exr import picture


def processor_seconds(command):
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    subprocess.run(command, check=True, capture_output=True)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime - before.ru_utime + after.ru_stime - before.ru_stime


def speed_of_pbrt(program, scene, width, height, rounds=3, few=4, many=36):
    """Million samples/s of one thread, from the difference of two sample counts, so that loading is excluded."""
    text = scene.read_text()
    text = re.sub(r'^Integrator "\w+"', 'Integrator "path"', text, flags=re.M)
    text = re.sub(r'^Sampler "\w+"', 'Sampler "independent"', text, flags=re.M)
    text = re.sub(r'^PixelFilter "\w+"(\s+"float \w+" \[[^]]*\])*', 'PixelFilter "box"', text, flags=re.M)
    text = re.sub(r'("integer xresolution" \[)[^]]*', rf"\1 {width} ", text)
    text = re.sub(r'("integer yresolution" \[)[^]]*', rf"\1 {height} ", text)
    with tempfile.TemporaryDirectory() as folder:
        for other in scene.parent.iterdir():
            (Path(folder) / other.name).symlink_to(other.resolve())
        copy = Path(folder) / "copy.pbrt"
        copy.write_text(text)

        def seconds(spp):
            return processor_seconds([program, "--quiet", "--nthreads", "1", "--spp", str(spp), "--outfile", copy.with_suffix(".exr"), copy])

        return width * height * (many - few) / 1e6 / statistics.median(seconds(many) - seconds(few) for _ in range(rounds))


def rendered(program, scene, size, spp, seed):
    """The image and its processor seconds, minus those for one sample."""
    with tempfile.TemporaryDirectory() as folder:
        out = Path(folder) / "out.exr"

        def seconds(samples):
            return processor_seconds([program, "render", scene, "-o", out, "--size", size, "--spp", str(samples), "--filter", "box", "--threads",
                                      "1", "--seed", str(seed)])

        one_sample = seconds(1)
        spent = seconds(spp) - one_sample
        return picture(out), spent


def row(program, pbrt, folder, spp):
    told = json.loads((folder / "reference-pbrt.json").read_text())
    width, height = told["resolution"]
    halves = [picture(folder / f"reference-pbrt-half{i}.exr") for i in (1, 2)]
    reference = (halves[0] + halves[1]) / 2
    runs = [rendered(program, next(folder.glob("*.pbrt")), f"{width}x{height}", spp, seed) for seed in (1, 2)]
    brightness = reference.mean(-1, keepdims=True)**2 + (0.01 * reference.mean())**2

    def noise(a, b, samples):
        """relMSE of one sample per pixel."""
        return float(np.mean((a - b)**2 / 2 / brightness) * samples)

    ours, theirs = noise(runs[0][0], runs[1][0], spp), noise(*halves, told["spp_per_half"])
    speed = width * height * spp / 1e6 / np.mean([seconds for _, seconds in runs])
    means = ((runs[0][0] + runs[1][0]) / 2).mean((0, 1)) / reference.mean((0, 1))
    other = told["million_samples_per_second_1_thread_independent_sampler"]
    if pbrt:
        other = speed_of_pbrt(pbrt, next(folder.glob("*.pbrt")), width, height)
    return (f"| {folder.name} | {', '.join(f'{m:.3f}' for m in means)} | {speed:.2f} / {other:.3f} | {ours:.1f} / {theirs:.1f} | "
            f"{speed / other:.1f} | {speed / other * theirs / ours:.1f} |")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--fathom", required=True)
    parser.add_argument("--pbrt")
    parser.add_argument("--spp", type=int, default=256)
    parser.add_argument("--scenes", type=Path, default=Path("../shared/scenes/pbrt-v4"))
    parser.add_argument("names", nargs="*", default=["living-room", "modern-hall", "veach-ajar"])
    args = parser.parse_args()
    print("| scene | mean over pbrt's | million samples/s, ours / pbrt | relMSE of a sample | speed | efficiency |\n" + "| --- " * 6 + "|")
    for name in args.names:
        print(row(args.fathom, args.pbrt, args.scenes / name, args.spp), flush=True)


if __name__ == "__main__":
    main()
