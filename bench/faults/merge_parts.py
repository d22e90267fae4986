#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Time, processor time and peak memory of merging many parts.

usage: merge_parts.py FATHOM FOLDER [PARTS [WIDTHxHEIGHT]]
    FOLDER  folder of the parts (33 GB for 256 parts of 1920x1080); existing parts are reused

Each part is a render of one sample per pixel; the merged film must have all samples.
"""
import json
import os
import resource
import subprocess
import sys
import time

SCENE = {"fathom": 1, "camera": {"position": [0, 0, 5], "look_at": [0, 0, 0]}, "environment": {"kind": "gradient"},
         "materials": {"wall": {"color": [0.8, 0.3, 0.2]}},
         "scene": [{"sphere": {"radius": 1}, "material": "wall"}, {"sphere": {"radius": 100, "center": [0, -101, 0]}}]}


def main():
    if len(sys.argv) < 3:
        print(__doc__)
        return 2
    fathom, folder = os.path.abspath(sys.argv[1]), sys.argv[2]
    count = int(sys.argv[3]) if len(sys.argv) > 3 else 256
    size = sys.argv[4] if len(sys.argv) > 4 else "1920x1080"
    os.makedirs(folder, exist_ok=True)
    os.chdir(folder)
    with open("scene.json", "w") as file:
        json.dump(SCENE, file)
    parts = [f"part{i}.exr" for i in range(1, count + 1)]
    for i, part in enumerate(parts, 1):
        if not os.path.exists(part):
            subprocess.run([fathom, "render", "scene.json", "--size", size, "--spp", str(count), "--part", f"{i}/{count}", "-q",
                            "--exr", "half", "--guiding", "off", "-o", part], check=True)
    start = time.monotonic()
    subprocess.run([fathom, "merge", *parts, "-o", "merged.exr"], check=True)
    seconds = time.monotonic() - start
    usage = resource.getrusage(resource.RUSAGE_CHILDREN)
    # RUSAGE_CHILDREN gives the maximum over all child processes; the renders above need less memory than merging.
    print(f"{count} parts of {size}, {sum(os.path.getsize(part) for part in parts) / 1e9:.1f} GB: {seconds:.1f} s, "
          f"peak memory {usage.ru_maxrss / 1024:.0f} MB")
    info = json.loads(subprocess.run([fathom, "info", "merged.exr", "--json"], check=True, capture_output=True).stdout)
    print("samples", info["samples"])
    return 0 if info["samples"] == [[0, count]] else 1


if __name__ == "__main__":
    sys.exit(main())
