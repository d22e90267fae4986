#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Renders small images of every feature and compares their hashes with hashes.txt. There is one hash per image, because the
bits depend neither on the instruction set (all that this machine supports are tested) nor on the number of threads.

usage: golden_test.py FATHOM PICTURE_HASH [--accept] [--only NAME ...]

--accept writes the new hashes. Compare the images before and after, and explain the difference in the commit."""
import argparse
import concurrent.futures
import os
import pathlib
import subprocess
import sys
import tempfile

HERE = pathlib.Path(__file__).resolve().parent
LIST = HERE / "hashes.txt"
KERNELS = ["base", "avx2", "avx512"]  # values of FATHOM_KERNEL
LAYERS = "albedo,normal,depth,position,instance,material,variance"


def run(command, kernel=None):
    environment = {**os.environ, "FATHOM_KERNEL": kernel} if kernel else None
    result = subprocess.run(command, capture_output=True, text=True, env=environment)
    if result.returncode:
        sys.exit(f"failed: {' '.join(command)}\n{result.stderr}")
    return result.stdout


def read_list():
    """Returns the lines of hash, image name, scene and options."""
    for number, line in enumerate(LIST.read_text().splitlines(), 1):
        words = line.split()
        if not words or words[0] == "#":
            continue
        if len(words) < 3:
            sys.exit(f"{LIST}:{number}: expected a hash, a name, a scene, and options")
        yield {"hash": words[0], "name": words[1], "scene": words[2], "options": words[3:]}


def kernels_of(program):
    """Returns the kernels that are built and that this machine supports."""
    def runs(kernel):
        environment = {**os.environ, "FATHOM_KERNEL": kernel}
        return subprocess.run([program, "version"], capture_output=True, env=environment).returncode == 0
    kernels = [kernel for kernel in KERNELS if runs(kernel)]
    return kernels or sys.exit(f"{program} has no kernel for this machine")


def hash_of(program, kernel, hasher, picture, folder, number):
    out = os.path.join(folder, f"{number}.exr")
    options = picture["options"] if "--size" in picture["options"] else ["--size", "24x16", *picture["options"]]
    spp = [] if {"--spp", "--samples"} & set(options) else ["--spp", "8"]
    run([program, "render", str(HERE / "scenes" / (picture["scene"] + ".json")), "-q", "-o", out, "--aov", LAYERS, *options, *spp],
        kernel)
    return run([hasher, out]).strip()


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("program")
    parser.add_argument("hasher")
    parser.add_argument("--accept", action="store_true")
    parser.add_argument("--only", nargs="+", default=[])
    arguments = parser.parse_args()
    pictures = list(read_list())
    unused = {p.stem for p in (HERE / "scenes").glob("*.json")} - {p["scene"] for p in pictures}
    if unused:
        sys.exit(f"{LIST}: no picture of the scenes {', '.join(sorted(unused))}")
    if arguments.only:
        pictures = [p for p in pictures if p["name"] in arguments.only]
    kernels = kernels_of(arguments.program)
    print("kernels:", ", ".join(kernels))
    changed, apart = {}, 0
    with tempfile.TemporaryDirectory() as folder, concurrent.futures.ThreadPoolExecutor(2) as pool:
        jobs = [(p, kernel, pool.submit(hash_of, arguments.program, kernel, arguments.hasher, p, folder, f"{p['name']}-{kernel}"))
                for p in pictures for kernel in kernels]
        seen = {}
        for p, kernel, job in jobs:
            seen.setdefault(p["name"], {})[kernel] = job.result()
    for p in pictures:
        hashes = seen[p["name"]]
        if len(set(hashes.values())) > 1:
            print(f"{p['name']}: kernels disagree: {hashes}")
            apart += 1
        elif p["hash"] != next(iter(hashes.values())):
            changed[p["name"]] = next(iter(hashes.values()))
    if apart:
        return 1
    if arguments.accept:
        lines = LIST.read_text().splitlines()
        for i, line in enumerate(lines):
            words = line.split()
            if len(words) > 2 and words[0] != "#" and words[1] in changed:
                lines[i] = line.replace(words[0], changed[words[1]], 1)
        LIST.write_text("\n".join(lines) + "\n")
        print(f"{len(changed)} of {len(pictures)} hashes accepted")
        return 0
    for name in changed:
        print(f"{name}: differs from the accepted image")
    if changed:
        print(f"{len(changed)} of {len(pictures)} pictures changed. If that is meant, accept them, and say in the commit why:")
        print(f"  {sys.executable} {pathlib.Path(__file__).resolve()} {arguments.program} {arguments.hasher} --accept")
        return 1
    print(f"{len(pictures)} pictures as accepted")
    return 0


sys.exit(main())
