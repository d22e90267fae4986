#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Checks that an image has the same bits for all numbers of threads, instruction sets, parts and interruptions.

    one_hash.py PROGRAM PICTURE_HASH SCENE...

Each scene is rendered with 48 samples per pixel and all layers: with 1, 2, 3, 7 and 64 threads, with each instruction
set of this machine, in 1, 3 and 16 parts, and in 1, 2 and 6 runs that resume from a checkpoint. Exits with 1 if two
hashes differ.
"""
import os
import subprocess
import sys
import tempfile

SAMPLES = 48
KERNELS = ["base", "avx2", "avx512"]  # values of FATHOM_KERNEL
OPTIONS = ["--size", "96x64", "--aov", "albedo,normal,depth,position,instance,material,variance", "--guiding", "on", "-q"]


def run(*words, kernel=None):
    environment = {**os.environ, "FATHOM_KERNEL": kernel} if kernel else None
    result = subprocess.run([str(word) for word in words], capture_output=True, text=True, env=environment)
    if result.returncode != 0:
        sys.exit(f"failed: {' '.join(map(str, words))}\n{result.stderr}")
    return result.stdout


def kernels_of(program):
    """Kernels that are built and that this machine supports."""
    def runs(kernel):
        environment = {**os.environ, "FATHOM_KERNEL": kernel}
        return subprocess.run([program, "version"], capture_output=True, env=environment).returncode == 0
    return [kernel for kernel in KERNELS if runs(kernel)]


def pictures_of(program, scene, folder):
    """Description of a run and the file that it wrote."""
    def file(name):
        return os.path.join(folder, name + ".exr")
    kernels = kernels_of(program)
    for kernel in kernels:
        for threads in (1, 2, 3, 7, 64):
            out = file(f"{kernel}-{threads}")
            run(program, "render", scene, *OPTIONS, "--spp", SAMPLES, "--threads", threads, "-o", out, kernel=kernel)
            yield f"{kernel}, {threads} threads", out
    for parts in (1, 3, 16):
        names = [file(f"part-{k}") for k in range(1, parts + 1)]
        # Parts take turns at the kernels, as in a mix of machines.
        for k, name in enumerate(names, 1):
            run(program, "render", scene, *OPTIONS, "--spp", SAMPLES, "--part", f"{k}/{parts}", "-o", name,
                kernel=kernels[k % len(kernels)])
        run(program, "merge", *reversed(names), "-o", file(f"merged-{parts}"))
        yield f"{parts} parts, merged", file(f"merged-{parts}")
    for runs in (1, 2, 6):
        kept, out = file(f"kept-{runs}"), file(f"resumed-{runs}")
        for k in range(1, runs + 1):
            run(program, "render", scene, *OPTIONS, "--spp", SAMPLES * k // runs, "--checkpoint", kept, "-o", out)
        yield f"{runs} runs", out


def main():
    if len(sys.argv) < 4:
        sys.exit(__doc__)
    program, hasher, *scenes = map(os.path.abspath, sys.argv[1:])
    differ = False
    for scene in scenes:
        hashes = {}
        with tempfile.TemporaryDirectory() as folder:
            for what, file in pictures_of(program, scene, folder):
                hashes.setdefault(run(hasher, file).strip(), []).append(what)
        differ |= len(hashes) != 1
        print(f"{os.path.basename(scene)}: {sum(map(len, hashes.values()))} pictures, {len(hashes)} hash{'es' * (len(hashes) > 1)}")
        if len(hashes) > 1:
            for value, made in hashes.items():
                print(f"    {value}: {'; '.join(made)}")
    sys.exit(differ)


if __name__ == "__main__":
    main()
