#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""How often the interval that `fathom render` prints contains the true error of the image.

usage: bench/error_coverage.py [--fathom PROGRAM] [--renders 200] [--spp 16 64] [--size 160x120] [SCENE...]

Each scene is rendered with many seeds. The reference of each image is the mean of the others, whose own noise is
subtracted from the squared error. Columns: samples per pixel; mean true error; mean of the estimate relative to it; half
the width of the interval relative to the error; share of renders whose interval contains the true error; shares whose
interval is above and below it; share that was called unreliable. A perfect method has 95 % in the interval, which 200
renders show as 90.5 to 99 %. Needs numpy and OpenEXR.
"""
import argparse, json, subprocess, tempfile
from pathlib import Path

import numpy as np

import exr

ROOT = Path(__file__).resolve().parent.parent


def render(program, scene, size, spp, seed, out):
    """Returns the image and the estimate of its error."""
    command = [str(program), "render", str(scene), "--size", size, "--spp", str(spp), "--seed", str(seed), "--exr", "float",
               "--progress", "json", "-o", str(out)]
    out.unlink(missing_ok=True)
    run = subprocess.run(command, check=True, capture_output=True, text=True)
    events = [json.loads(line) for line in run.stderr.splitlines() if line.startswith("{")]
    estimate = next(event for event in events if event["event"] == "error_estimate")
    return exr.picture(out), estimate


def coverage(program, scene, size, spp, renders, folder):
    results = [render(program, scene, size, spp, 1 + seed, Path(folder) / "image.exr") for seed in range(renders)]
    images = np.array([image for image, _ in results])
    total, variance = images.sum(0), images.var(0, ddof=1)
    true = []
    for image in images:
        reference = (total - image) / (renders - 1)
        squares = (image - reference) ** 2 - variance / (renders - 1)
        true.append(np.sqrt((squares / (reference ** 2 + 0.01)).mean()))
    true = np.array(true)
    error, low, high = (np.array([estimate[name] for _, estimate in results]) for name in ("error", "low", "high"))
    unreliable = 1 - np.mean([estimate["reliable"] for _, estimate in results])
    return {"scene": str(scene), "spp": spp, "true": true.mean(), "ratio": (error / true).mean(),
            "half_width": ((high - low) / 2 / error).mean(), "inside": ((low <= true) & (true <= high)).mean(),
            "above": (low > true).mean(), "below": (high < true).mean(), "unreliable": unreliable}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--fathom", type=Path, default=ROOT / "build/release/bin/fathom")
    parser.add_argument("--renders", type=int, default=200)
    parser.add_argument("--spp", type=int, nargs="+", default=[16, 64])
    parser.add_argument("--size", default="160x120")
    parser.add_argument("scenes", type=Path, nargs="*", default=[ROOT / "scenes" / f"{name}.json" for name in (
        "cornell-box", "textures", "depth-of-field", "points", "motion-blur", "cornell-box-mirror")])
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        for scene in options.scenes:
            for spp in options.spp:
                r = coverage(options.fathom, scene, options.size, spp, options.renders, folder)
                print(f"{scene.stem:24} {spp:5} error {r['true']:7.4f}  estimate {r['ratio']:.3f}  half width {r['half_width']:.3f}  "
                      f"inside {r['inside']:.3f}  above {r['above']:.3f}  below {r['below']:.3f}  unreliable {r['unreliable']:.3f}",
                      flush=True)


if __name__ == "__main__":
    main()
