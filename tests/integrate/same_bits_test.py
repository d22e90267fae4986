#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Checks that the bits of an image don't depend on instruction set, number of threads, BVH quality and rendering in
parts.

usage: same_bits_test.py FATHOM SCENES"""
import os, subprocess, sys, tempfile

KERNELS = ["avx512", "avx2", "base"]  # values of FATHOM_KERNEL


def run(program, *arguments, kernel=None):
    environment = {**os.environ, "FATHOM_KERNEL": kernel} if kernel else None
    return subprocess.run([program, *arguments], check=True, capture_output=True, text=True, env=environment).stdout


def runs(program, kernel):
    """Whether the kernel is built and this machine supports it."""
    environment = {**os.environ, "FATHOM_KERNEL": kernel}
    return subprocess.run([program, "version"], capture_output=True, env=environment).returncode == 0


WIDTH, HEIGHT = 64, 48
guided_mark, caustics_mark, merged_mark = " guided", " with caustics", " with merged caustics"
GUIDED = [scene + guided_mark for scene in ("cornell-box", "environment", "instances")]

CAUSTICS = [scene + caustics_mark for scene in ("report-spheres", "environment", "../tests/golden/scenes/moving-lamps")]
MERGED = ["still-life" + merged_mark]


def pixels(path):
    """Returns the pixel values, which end an uncompressed EXR file of one float layer."""
    plain = path + ".plain.exr"
    subprocess.run([sys.argv[1], "merge", path, "-o", plain, "--no-sums", "--exr", "float", "-q"], check=True)
    with open(plain, "rb") as file:
        data = file.read()
    row = 8 + WIDTH * 3 * 4  # a row has its number and size, then three channels
    values = data[-row * HEIGHT:]
    if int.from_bytes(values[4:8], "little") != row - 8 or not any(values[8:]):
        raise SystemExit(f"{plain}: not the layout that this test expects")
    return values


def main():
    program, scenes = sys.argv[1:3]
    kernels = [kernel for kernel in KERNELS if runs(program, kernel)]
    print("kernels:", ", ".join(kernels))
    failed = 0
    with tempfile.TemporaryDirectory() as folder:
        for scene in ["cornell-box", "cornell-box-triangles", "report-spheres", "report-marble", "environment", "textures",
                      "motion-blur", "motion-nodes", "motion-vertices", "curves",
                      "points", "depth-of-field", "model", "instances", "../tests/golden/scenes/hundreds-of-lamps",
                      "../tests/golden/scenes/moving-lamps", "../tests/golden/scenes/pictured-lights", "../tests/golden/scenes/glowing-curves",
                      "../tests/golden/scenes/moving-curves", "../tests/golden/scenes/fibres", *GUIDED, *CAUSTICS, *MERGED]:
            path = os.path.join(scenes, scene.removesuffix(guided_mark).removesuffix(merged_mark).removesuffix(caustics_mark) + ".json")
            guiding = "on" if scene.endswith(guided_mark) else "off"
            caustics = "on" if scene.endswith(caustics_mark) else "merged" if scene.endswith(merged_mark) else "off"
            common = ["-q", "--caustics", caustics, "--size", f"{WIDTH}x{HEIGHT}", "--exr", "float", "--guiding", guiding]
            seen = {}
            for kernel in kernels:
                out = os.path.join(folder, "kernel.exr")
                run(program, "render", path, "--samples", "0:6", "-o", out, *common, kernel=kernel)
                seen[kernel] = pixels(out)
            for threads in ["1", "3"]:
                out = os.path.join(folder, "threads.exr")
                run(program, "render", path, "--samples", "0:6", "--threads", threads, "-o", out, *common)
                seen[threads + " threads"] = pixels(out)
            for build in ["fast", "high", "compact"]:
                out = os.path.join(folder, "build.exr")
                run(program, "render", path, "--samples", "0:6", "--build", build, "-o", out, *common)
                seen[build + " tree"] = pixels(out)
            parts = []
            for samples in ["0:1", "1:4", "4:6"]:
                parts.append(os.path.join(folder, samples.replace(":", "-") + ".exr"))
                run(program, "render", path, "--samples", samples, "-o", parts[-1], *common)
            out = os.path.join(folder, "merged.exr")
            run(program, "merge", *parts, "-o", out, "-q")
            seen["three parts"] = pixels(out)
            first = next(iter(seen.values()))
            different = [name for name, value in seen.items() if value != first]
            print(scene, "same" if not different else "DIFFERENT: " + ", ".join(different))
            failed += bool(different)
    return 1 if failed else 0


sys.exit(main())
