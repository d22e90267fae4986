#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Cost of rendering an image in parts, one after the other: processor time relative to a single run, and whether the
bits are equal.

    bench/faults/parts_overhead.py FATHOM PICTURE_HASH SCENE [--parts 16] [--spp N] [--size WxH] [--runs 3] [--
    OPTION...]

Both ways keep their sums in films, as merging requires: the single run by --mergeable. They run in turns, and the
minimum counts, since other load only adds time. Prints processor seconds (user and system), those of merging, and
those of each part before its first sample.
"""
import argparse
import json
import os
import resource
import subprocess
import sys
import tempfile


def cpu_s():
    usage = resource.getrusage(resource.RUSAGE_CHILDREN)
    return usage.ru_utime + usage.ru_stime


def timed(words):
    """Returns processor seconds and the program's summary."""
    before = cpu_s()
    result = subprocess.run(words, capture_output=True, text=True)
    if result.returncode != 0:
        sys.exit(f"{' '.join(words)}: {result.stderr[-500:]}")
    lines = [line for line in result.stderr.splitlines() if line.startswith('{"')]
    return cpu_s() - before, json.loads(lines[-1]) if lines else {}


def main():
    p = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    p.add_argument("fathom"), p.add_argument("picture_hash"), p.add_argument("scene")
    p.add_argument("--parts", type=int, default=16)
    p.add_argument("--spp", type=int, default=1024)
    p.add_argument("--size", default="800x600")
    p.add_argument("--runs", type=int, default=3)
    p.add_argument("options", nargs="*")
    o = p.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        def path(name):
            return os.path.join(folder, name)

        def render(output, *more):
            return timed([o.fathom, "render", o.scene, "--spp", str(o.spp), "--size", o.size, "--mergeable", "--progress", "json", "-o", path(output),
                          *o.options, *more])
        whole, together, merging, start = [], [], [], []
        for _ in range(o.runs):
            whole.append(render("whole.exr")[0])
            parts = [render(f"part{k}.exr", "--part", f"{k}/{o.parts}") for k in range(1, o.parts + 1)]
            merge = timed([o.fathom, "merge", *(path(f"part{k}.exr") for k in range(1, o.parts + 1)), "-o", path("merged.exr"), "-q"])[0]
            together.append(sum(seconds for seconds, _ in parts)), merging.append(merge)
            start.append(sum(said["load_s"] + said["build_s"] for _, said in parts) / o.parts)
        hashes = [subprocess.run([o.picture_hash, path(name)], capture_output=True, text=True, check=True).stdout.split()[0] for name in ("whole.exr", "merged.exr")]
        one, many = min(whole), min(together)
        json.dump({"one_run_s": one, "parts_s": many, "overhead": many / one - 1, "merge_s": min(merging), "overhead_with_merging": (many + min(merging)) / one - 1,
                   "load_and_build_of_a_part_s": min(start), "same_bits": hashes[0] == hashes[1]}, sys.stdout, indent=1)
        print()
        return 0 if hashes[0] == hashes[1] else 1


if __name__ == "__main__":
    sys.exit(main())
