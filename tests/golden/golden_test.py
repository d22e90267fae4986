#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Renders small images of every feature and compares their hashes with hashes.txt. There is one hash per image, because the
bits depend neither on the instruction set (all that this machine supports are tested) nor on the number of threads.

usage: golden_test.py FATHOM PICTURE_HASH [--accept] [--only NAME ...]

--accept writes the new hashes. Compare the images before and after, and explain the difference in the commit."""
import argparse
import concurrent.futures
import glob
import os
import pathlib
import subprocess
import sys
import tempfile

HERE = pathlib.Path(__file__).resolve().parent
LIST = HERE / "hashes.txt"
LEVELS = ["none", "x86-64-v3", "x86-64-v4"]  # "none" matches no library folder, so the loader takes the base library
LAYERS = "albedo,normal,depth,position,instance,material,variance"


def run(command):
    result = subprocess.run(command, capture_output=True, text=True)
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


def levels_of(program):
    """Returns commands that run the program, by the name of the kernel that they select."""
    loaders = glob.glob("/lib64/ld-linux-x86-64.so.2")
    if not loaders:
        return {"as it is": [program]}
    found = {}
    for level in LEVELS:
        command = [loaders[0], "--glibc-hwcaps-mask", level, program]
        found.setdefault(run(command + ["version"]).splitlines()[1].strip(), command)
    return found


def hash_of(command, hasher, picture, folder, number):
    out = os.path.join(folder, f"{number}.exr")
    options = picture["options"] if "--size" in picture["options"] else ["--size", "24x16", *picture["options"]]
    spp = [] if {"--spp", "--samples"} & set(options) else ["--spp", "8"]
    run([*command, "render", str(HERE / "scenes" / (picture["scene"] + ".json")), "-q", "-o", out, "--aov", LAYERS, *options, *spp])
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
    levels = levels_of(arguments.program)
    print("kernels:", ", ".join(levels))
    changed, apart = {}, 0
    with tempfile.TemporaryDirectory() as folder, concurrent.futures.ThreadPoolExecutor(2) as pool:
        jobs = [(p, name, pool.submit(hash_of, command, arguments.hasher, p, folder, f"{p['name']}-{i}"))
                for p in pictures for i, (name, command) in enumerate(levels.items())]
        seen = {}
        for p, name, job in jobs:
            seen.setdefault(p["name"], {})[name] = job.result()
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
