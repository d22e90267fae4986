#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Lights with images beside Mitsuba 3: a projector and a textured spot, over a floor, a wall and a ball.

    bench/light_pictures.py --fathom PROGRAM [--spp 4096]

Needs a Python with Mitsuba's module. Prints the mean of each channel relative to Mitsuba's, and differences of blocks
of 8x8 pixels: root mean square and maximum, in standard errors of both renderers' eight runs plus a ten-thousandth of
the value.
"""
import argparse
import subprocess
import tempfile
from pathlib import Path

import mitsuba as mi
import numpy as np

RUNS, WIDTH, HEIGHT, BLOCK = 8, 160, 120, 8

SCENE = """<scene version="3.0.0">
<integrator type="path"><integer name="max_depth" value="6"/></integrator>
<sensor type="perspective"><float name="fov" value="50"/>
 <transform name="to_world"><lookat origin="0.3,1.5,5" target="0,1.1,0" up="0,1,0"/></transform>
 <film type="hdrfilm"><integer name="width" value="160"/><integer name="height" value="120"/><rfilter type="box"/></film>
 <sampler type="independent"><integer name="sample_count" value="16"/></sampler></sensor>
<shape type="rectangle"><transform name="to_world"><scale value="3"/><translate value="0,1,-1"/></transform>
 <bsdf type="twosided"><bsdf type="diffuse"><rgb name="reflectance" value="0.7,0.7,0.7"/></bsdf></bsdf></shape>
<shape type="rectangle"><transform name="to_world"><scale value="4"/><rotate x="1" angle="-90"/></transform>
 <bsdf type="twosided"><bsdf type="diffuse"><rgb name="reflectance" value="0.5,0.5,0.5"/></bsdf></bsdf></shape>
<shape type="sphere"><point name="center" x="0.5" y="0.5" z="0.2"/><float name="radius" value="0.5"/>
 <bsdf type="diffuse"><rgb name="reflectance" value="0.6,0.6,0.6"/></bsdf></shape>
{emitter}
</scene>"""
PLACE = '<transform name="to_world"><lookat origin="-0.8,1.9,2.6" target="0.2,0.8,-1" up="0.1,1,0"/></transform>'
EMITTERS = {
    "projector": f"""<emitter type="projector"><texture type="bitmap" name="irradiance"><string name="filename" value="picture.exr"/>
 <string name="wrap_mode" value="clamp"/></texture><float name="scale" value="5"/><float name="fov" value="45"/>{PLACE}</emitter>""",
    "spot with a texture": f"""<emitter type="spot"><texture type="bitmap" name="texture"><string name="filename" value="picture.png"/>
 <string name="wrap_mode" value="clamp"/></texture><rgb name="intensity" value="9,8,7"/><float name="cutoff_angle" value="28"/>
 {PLACE}</emitter>"""}


def write_pictures(folder):
    """An image without symmetry, which reveals wrong rotations and mirroring."""
    random = np.random.default_rng(3)
    picture = random.random((8, 12, 3)).astype(np.float32)
    picture[0, 0], picture[0, 11], picture[7, 0], picture[3, 5] = (3, 0, 0), (0, 3, 0), (0, 0, 3), (2, 2, 2)
    mi.Bitmap(picture).write(str(folder / "picture.exr"))
    codes = (random.random((10, 10, 3)) * 255).astype(np.uint8)
    codes[0, :], codes[:, 0] = (255, 0, 0), (0, 255, 0)
    mi.Bitmap(codes).write(str(folder / "picture.png"))


def by_fathom(program, file, spp, seed):
    out = file.with_suffix(".exr")
    subprocess.run([program, "render", file, "--spp", str(spp), "--seed", str(seed), "--filter", "box", "--light", "file", "--exposure", "0",
                    "--exr", "float", "-q", "-o", out], check=True)
    return np.array(mi.Bitmap(str(out)), dtype=np.float64)[..., :3]


def blocks(picture):
    return picture.reshape(HEIGHT // BLOCK, BLOCK, WIDTH // BLOCK, BLOCK, 3).mean((1, 3))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--fathom", required=True)
    parser.add_argument("--spp", type=int, default=4096)
    args = parser.parse_args()
    mi.set_variant("llvm_ad_rgb")
    print(f"Mitsuba {mi.__version__}\n| light | mean over Mitsuba's | differences of blocks, in standard errors: rms, largest |\n| --- | --- | --- |")
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        write_pictures(folder)
        for light, emitter in EMITTERS.items():
            file = folder / "scene.xml"
            file.write_text(SCENE.format(emitter=emitter))
            scene = mi.load_file(str(file))
            spp = args.spp // RUNS
            theirs = [np.array(mi.render(scene, spp=spp, seed=1 + i), dtype=np.float64)[..., :3] for i in range(RUNS)]
            ours = [by_fathom(args.fathom, file, spp, 1 + i) for i in range(RUNS)]
            means = np.mean(ours, (0, 1, 2)) / np.mean(theirs, (0, 1, 2))
            a, b = np.array([blocks(p) for p in ours]), np.array([blocks(p) for p in theirs])
            error = np.sqrt((a.var(0, ddof=1) + b.var(0, ddof=1)) / RUNS) + 1e-4 * b.mean(0) + 1e-9
            z = (a.mean(0) - b.mean(0)) / error
            print(f"| {light} | {', '.join(f'{m:.4f}' for m in means)} | {np.sqrt((z * z).mean()):.2f}, {np.abs(z).max():.1f} of {z.size} |",
                  flush=True)


if __name__ == "__main__":
    main()
