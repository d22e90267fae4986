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
LEVELS = ["none", "x86-64-v3", "x86-64-v4"]  # "none" matches no library folder, so the loader takes the base library
LOADER = "/lib64/ld-linux-x86-64.so.2"
OPTIONS = ["--size", "96x64", "--aov", "albedo,normal,depth,position,instance,material,variance", "--guiding", "on", "-q"]


def run(*words):
    result = subprocess.run([str(word) for word in words], capture_output=True, text=True)
    if result.returncode != 0:
        sys.exit(f"failed: {' '.join(map(str, words))}\n{result.stderr}")
    return result.stdout


def kernels(program):
    """Commands of the program by instruction set."""
    found = {}
    for level in LEVELS:
        command = [LOADER, "--glibc-hwcaps-mask", level, program]
        found.setdefault(run(*command, "version").splitlines()[1].strip(), command)
    return found


def pictures_of(program, scene, folder):
    """Description of a run and the file that it wrote."""
    def file(name):
        return os.path.join(folder, name + ".exr")
    for kernel, command in kernels(program).items():
        for threads in (1, 2, 3, 7, 64):
            out = file(f"{len(kernel)}-{threads}")
            run(*command, "render", scene, *OPTIONS, "--spp", SAMPLES, "--threads", threads, "-o", out)
            yield f"{kernel}, {threads} threads", out
    for parts in (1, 3, 16):
        names = [file(f"part-{k}") for k in range(1, parts + 1)]
        # Every second part uses the base library, as in a mix of machines.
        commands = list(kernels(program).values())
        for k, name in enumerate(names, 1):
            run(*commands[k % len(commands)], "render", scene, *OPTIONS, "--spp", SAMPLES, "--part", f"{k}/{parts}", "-o", name)
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
