#!/usr/bin/env python3
"""pbrt-v4's scenes as they are, beside pbrt's own reference pictures: mean of each channel, samples/s and noise of a sample.

    bench/pbrt.py --fathom PROGRAM [--spp 256] [--scenes ../shared/scenes/pbrt-v4] [NAME ...]

One thread, pbrt's size and box filter. pbrt's speed and noise are those of its reference: two halves of 768 samples and what its JSON
says of their time, on the machine that is named there. So speeds are of two machines; noise and means are not. Wants numpy and OpenEXR.
"""
import argparse
import json
import subprocess
import tempfile
from pathlib import Path

import numpy as np
import OpenEXR


def picture(path):
    channels = OpenEXR.File(str(path)).channels()
    return np.asarray((channels.get("RGB") or channels["RGBA"]).pixels, dtype=np.float64)[..., :3]


def rendered(program, scene, size, spp, seed):
    """The picture, and its seconds without loading and building."""
    with tempfile.TemporaryDirectory() as folder:
        out = Path(folder) / "out.exr"
        result = subprocess.run([program, "render", scene, "-o", out, "--size", size, "--spp", str(spp), "--filter", "box", "--threads", "1",
                                 "--seed", str(seed), "--progress", "json"], capture_output=True, text=True, check=True)
        return picture(out), json.loads(result.stderr.splitlines()[-1])["render_s"]


def row(program, folder, spp):
    told = json.loads((folder / "reference-pbrt.json").read_text())
    width, height = told["resolution"]
    halves = [picture(folder / f"reference-pbrt-half{i}.exr") for i in (1, 2)]
    reference = (halves[0] + halves[1]) / 2
    runs = [rendered(program, next(folder.glob("*.pbrt")), f"{width}x{height}", spp, seed) for seed in (1, 2)]
    brightness = reference.mean(-1, keepdims=True)**2 + (0.01 * reference.mean())**2

    def noise(a, b, samples):
        """relMSE of one sample a pixel."""
        return float(np.mean((a - b)**2 / 2 / brightness) * samples)

    ours, theirs = noise(runs[0][0], runs[1][0], spp), noise(*halves, told["spp_per_half"])
    speed = width * height * spp / 1e6 / np.mean([seconds for _, seconds in runs])
    means = ((runs[0][0] + runs[1][0]) / 2).mean((0, 1)) / reference.mean((0, 1))
    other = told["million_samples_per_second_1_thread_independent_sampler"]
    return (f"| {folder.name} | {', '.join(f'{m:.3f}' for m in means)} | {speed:.2f} / {other:.3f} | {ours:.1f} / {theirs:.1f} | "
            f"{speed / other:.1f} | {speed / other * theirs / ours:.1f} |")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--fathom", required=True)
    parser.add_argument("--spp", type=int, default=256)
    parser.add_argument("--scenes", type=Path, default=Path("../shared/scenes/pbrt-v4"))
    parser.add_argument("names", nargs="*", default=["living-room", "modern-hall", "veach-ajar"])
    args = parser.parse_args()
    print("| scene | mean over pbrt's | million samples/s, ours / pbrt | relMSE of a sample | speed | efficiency |\n" + "| --- " * 6 + "|")
    for name in args.names:
        print(row(args.fathom, args.scenes / name, args.spp), flush=True)


if __name__ == "__main__":
    main()
