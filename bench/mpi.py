#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Overhead of MPI: 2 ranks of one thread each beside one process of two threads, in turns.

usage: mpi.py FATHOM SCENE [OPTION]... [--turns N]
    options  of `fathom render`, such as --spp 1024 --guiding off

Prints medians of wall clock time and of processor time of all processes, and the relative difference of each pair; on
a busy machine processor time is more reliable. Needs mpirun and two cores.
"""
import json
import os
import re
import resource
import statistics
import subprocess
import sys
import tempfile
import time

from machine import processor

ENVIRONMENT = {**os.environ, "OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1"}


def processors_s():
    usage = resource.getrusage(resource.RUSAGE_CHILDREN)
    return usage.ru_utime + usage.ru_stime


def run(command):
    """Seconds of wall clock time, of processor time, and of rendering."""
    start, start_processors = time.monotonic(), processors_s()
    result = subprocess.run(command, env=ENVIRONMENT, capture_output=True, text=True, check=False)
    taken = time.monotonic() - start, processors_s() - start_processors
    if result.returncode != 0:
        sys.exit(f"{' '.join(command)}: {result.stderr}")
    events = [json.loads(line) for line in re.findall(r"^\{.*\}$", result.stderr, re.M)]
    return *taken, next(e["render_s"] for e in events if e["event"] == "summary")


def main():
    words = sys.argv[1:]
    turns = 5
    if "--turns" in words:
        turns = int(words.pop(words.index("--turns") + 1))
        words.remove("--turns")
    if len(words) < 2:
        print(__doc__)
        return 2
    fathom, scene = (os.path.abspath(word) for word in words[:2])
    with tempfile.TemporaryDirectory() as folder:
        render = [fathom, "render", scene, *words[2:], "--progress", "json", "-o", os.path.join(folder, "out.exr")]
        ways = {"2 threads": [*render, "--threads", "2"],
                "2 ranks": ["mpirun", "-n", "2", "--bind-to", "none", *render, "--threads", "1"]}
        taken = {name: [] for name in ways}
        for turn in range(turns):
            for name in sorted(ways, reverse=turn % 2 == 1):
                taken[name].append(run(ways[name]))
    print(f"{processor()}; {os.path.basename(scene)} {' '.join(words[2:])}; {turns} turns, medians")
    for place, what in enumerate(("whole run", "processors", "rendering")):
        pairs = [b[place] / a[place] for a, b in zip(taken["2 threads"], taken["2 ranks"])]
        a, b = (statistics.median(t[place] for t in taken[name]) for name in ways)
        print(f"{what:11}  2 threads {a:7.2f} s   2 ranks {b:7.2f} s   {100 * (statistics.median(pairs) - 1):+.1f} % "
              f"({100 * (min(pairs) - 1):+.1f} to {100 * (max(pairs) - 1):+.1f})")
    return 0


if __name__ == "__main__":
    sys.exit(main())
