#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Tufts of hair by Fathom and Mitsuba 3, from the same files: mean of each channel, Fathom's over Mitsuba's.

    bench/hair.py --fathom PROGRAM [--spp 1024] [--keep FOLDER] [NAME ...]

Needs a Python with Mitsuba 3 (and LLVM for its variant llvm_ad_rgb), numpy, and OpenEXR or Mitsuba's EXR reader. The
scene has three hundred curves of 8 control points on a ball, under a gray sky, with a lamp behind and a point light in
front; pixels that show only sky are ignored. Roots are inside the ball and radii taper to zero, because curve ends
differ: open in Mitsuba, half balls in Fathom. The error is the standard error of the ratio, from 8 images each.
"""
import argparse
import math
import random
import subprocess
import tempfile
from pathlib import Path

import mitsuba as mi
import numpy as np

mi.set_variant("llvm_ad_rgb")

KINDS = {
    "brown": "",
    "blond": '<float name="eumelanin" value="0.2"/><float name="pheomelanin" value="0.4"/>',
    "white": '<rgb name="sigma_a" value="0.01,0.02,0.04"/>',
    "smooth": '<rgb name="sigma_a" value="0.1,0.3,0.9"/><float name="longitudinal_roughness" value="0.12"/>'
              '<float name="azimuthal_roughness" value="0.15"/><float name="scale_tilt" value="5"/>',
    "rough": '<float name="eumelanin" value="0.5"/><float name="longitudinal_roughness" value="0.7"/>'
             '<float name="azimuthal_roughness" value="0.8"/><float name="int_ior" value="1.4"/>',
}
SCENE = """<scene version="3.0.0"><integrator type="path"><integer name="max_depth" value="100"/><integer name="rr_depth" value="30"/></integrator>
<sensor type="perspective"><float name="fov" value="40"/><transform name="to_world"><lookat origin="0.5,1,5" target="0,0.2,0" up="0,1,0"/>
</transform><film type="hdrfilm"><integer name="width" value="96"/><integer name="height" value="96"/><rfilter type="box"/></film>
<sampler type="independent"><integer name="sample_count" value="64"/></sampler></sensor>
<emitter type="constant"><rgb name="radiance" value="0.2,0.2,0.25"/></emitter>
<emitter type="point"><point name="position" x="2" y="3" z="4"/><rgb name="intensity" value="8"/></emitter>
<shape type="rectangle"><transform name="to_world"><lookat origin="-5,4,-2" target="0,0,0" up="0,1,0"/></transform>
<emitter type="area"><rgb name="radiance" value="20,17,14"/></emitter></shape>
<shape type="bsplinecurve"><string name="filename" value="hair.txt"/><bsdf type="hair">%s</bsdf></shape>
<shape type="sphere"><float name="radius" value="0.6"/><bsdf type="diffuse"><rgb name="reflectance" value="0.5"/></bsdf></shape></scene>
"""


def curves():
    """Curves with roots in a ball, pointing outwards and down, wavy, and tapering."""
    rng, text = random.Random(7), []
    for _ in range(300):
        y, phi = rng.uniform(-0.3, 1), rng.uniform(0, 2 * math.pi)
        s = math.sqrt(1 - y * y)
        out = (s * math.cos(phi), y, s * math.sin(phi))
        bend, turn = rng.uniform(0.2, 0.5), rng.uniform(0, 6)
        for k in range(8):
            t = k / 7
            wave = 0.06 * math.sin(6 * t + turn)
            text.append(f"{out[0] * (0.4 + 0.9 * t) + wave} {out[1] * (0.4 + 0.9 * t) - bend * t * t} {out[2] * (0.4 + 0.9 * t) - wave} "
                        f"{0.004 * max(0, 6 - k)}")
        text.append("")
    return "\n".join(text)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--fathom", required=True)
    parser.add_argument("--spp", type=int, default=1024)
    parser.add_argument("--keep", type=Path)
    parser.add_argument("names", nargs="*", default=list(KINDS))
    args = parser.parse_args()
    print("| hair | mean over Mitsuba's | error |\n" + "| --- " * 3 + "|")
    with tempfile.TemporaryDirectory() as temporary:
        folder = args.keep or Path(temporary)
        (folder / "hair.txt").write_text(curves())
        for name in args.names or KINDS:
            file, runs, part = folder / f"{name}.xml", 8, max(1, args.spp // 8)
            file.write_text(SCENE % KINDS[name])
            ours, theirs = [], []
            scene = mi.load_file(str(file))
            for seed in range(runs):
                out = folder / f"{name}-{seed}.exr"
                subprocess.run([args.fathom, "render", file, "-o", out, "--spp", str(part), "--seed", str(seed)], check=True, capture_output=True)
                ours.append(np.array(mi.Bitmap(str(out)))[..., :3])
                theirs.append(np.array(mi.render(scene, spp=part, seed=seed))[..., :3])
            # Pixels that show only sky in both images.
            sky = np.logical_and(*(np.abs(np.mean(p, 0) - p[0][0, 0]).max(-1) < 1e-4 for p in (ours, theirs)))
            ours, theirs = (np.array([picture[~sky].mean(0) for picture in p]) for p in (ours, theirs))
            ratio = ours.mean(0) / theirs.mean(0)
            error = np.hypot(ours.std(0) / ours.mean(0), theirs.std(0) / theirs.mean(0)) / math.sqrt(runs)
            print(f"| {name} | {', '.join(f'{r:.3f}' for r in ratio)} | {max(error):.4f} |", flush=True)


if __name__ == "__main__":
    main()
