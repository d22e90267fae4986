#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Unmodified small scenes of Mitsuba's test suite beside their reference images.

    bench/test_scenes.py --fathom PROGRAM FOLDER [--spp 512]

FOLDER: `tests/scenes` of a checkout of github.com/mitsuba-renderer/mitsuba-data. Prints, for each scene, the mean of
red, green and blue relative to the reference of the variant `rgb`, and the worst and the median difference of blocks
of 8x8 pixels, relative to the block plus a fifth of the mean. Needs numpy and OpenEXR.
"""
import argparse
import re
import subprocess
import tempfile
from pathlib import Path

import numpy as np
from exr import picture

PARTS = 8


def parts_of(image):
    height, width = (n // PARTS for n in image.shape[:2])
    return image[:height * PARTS, :width * PARTS].reshape(PARTS, height, PARTS, width, 3).mean((1, 3))


def row(program, scene, spp):
    stem = re.sub(r"_(path|direct|volpath|volpathmis|ptracer)$", "", scene.stem)
    reference = scene.parent / "refs" / f"{stem}_ref_rgb.exr"
    if not reference.exists():
        return f"| {stem} | no reference | | |"
    with tempfile.TemporaryDirectory() as folder:
        out = Path(folder) / "out.exr"
        result = subprocess.run([program, "render", scene, "-o", out, "--spp", str(spp)], capture_output=True, text=True)
        if result.returncode != 0:
            return f"| {stem} | {result.stderr.strip().splitlines()[-1]} | | |"
        ours, theirs = picture(out), picture(reference)
    a, b = parts_of(ours), parts_of(theirs)
    difference = np.abs(a - b) / (0.2 * b.mean() + b)
    means = ", ".join(f"{m:.3f}" for m in ours.mean((0, 1)) / theirs.mean((0, 1)))
    return f"| {stem} | {means} | {difference.max():.3f} | {np.median(difference):.4f} |"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--fathom", required=True)
    parser.add_argument("--spp", type=int, default=512)
    parser.add_argument("folder", type=Path)
    args = parser.parse_args()
    print("| scene | mean over Mitsuba's | worst part | middle |\n" + "| --- " * 4 + "|")
    for scene in sorted(args.folder.glob("*/*.xml")):
        print(row(args.fathom, scene, args.spp), flush=True)


if __name__ == "__main__":
    main()
