#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Speed of the Cornell box in million samples per second, beside Mitsuba 3 `llvm_ad_rgb` if a script for it is given.

Fathom: time of whole commands with 66 samples per pixel minus that with 2, which cancels the start-up; 800x600, box
filter, depth 50, roulette from bounce 5, variance on. Runs alternate; results are medians.

Mitsuba: `--peers FILE` names a script that is called as `FILE mitsuba --spp 64 --threads N` and prints a line of JSON
with "million_samples_per_s". Without it only Fathom is measured.
"""
import argparse, json, statistics, subprocess, sys, tempfile, time
from pathlib import Path

import machine

ROOT = Path(__file__).resolve().parent.parent
SAMPLES = 800 * 600 * 64


def fathom_command(program, scene, spp, threads, out):
    return [str(program), "render", str(ROOT / "scenes" / scene), "--spp", str(spp), "--threads", str(threads), "--filter",
               "box", "--max-depth", "50", "--roulette-depth", "5", "--aov", "variance", "-q", "-o", out]


def seconds(command, kernel):
    start = time.perf_counter()
    subprocess.run(command, check=True, capture_output=True, env=machine.environment_of(kernel))
    return time.perf_counter() - start


def fathom_rate(*arguments):
    program, scene, threads, kernel, out = arguments
    few = seconds(fathom_command(program, scene, 2, threads, out), kernel)
    many = seconds(fathom_command(program, scene, 66, threads, out), kernel)
    return SAMPLES / (many - few) / 1e6


def mitsuba_rate(peers, threads):
    run = subprocess.run([sys.executable, str(Path(peers).resolve()), "mitsuba", "--spp", "64", "--threads", str(threads)], check=True,
                         capture_output=True, text=True, cwd=Path(peers).resolve().parent)
    return json.loads(run.stdout.strip().splitlines()[-1])["million_samples_per_s"]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--fathom", default=ROOT / "build/release/bin/fathom")
    parser.add_argument("--peers", help="the script that renders the box with Mitsuba")
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--threads", type=int, default=2)
    args = parser.parse_args()
    kernels = [kernel for kernel in machine.kernels_of(args.fathom) if kernel != "base"]
    cases = [(scene, kernel) for scene in ["cornell-box.json", "cornell-box-triangles.json"] for kernel in kernels]
    names = {}
    for kernel in kernels:
        version = subprocess.run([str(args.fathom), "version"], check=True, capture_output=True, text=True,
                                 env=machine.environment_of(kernel)).stdout
        names[kernel] = version.splitlines()[1].split(":")[1].split(",")[0].strip()
    ours = {case: [] for case in cases}
    theirs, ratios = [], {case: [] for case in cases}
    with tempfile.TemporaryDirectory() as folder:
        out = str(Path(folder) / "picture.exr")
        for _ in range(args.rounds):
            if args.peers:
                theirs.append(mitsuba_rate(args.peers, args.threads))
            for case in cases:
                ours[case].append(fathom_rate(args.fathom, case[0], args.threads, case[1], out))
                if args.peers:
                    ratios[case].append(ours[case][-1] / theirs[-1])
        one = [fathom_rate(args.fathom, "cornell-box.json", 1, None, out) for _ in range(args.rounds)]
        two = [fathom_rate(args.fathom, "cornell-box.json", 2, None, out) for _ in range(args.rounds)]
    median = lambda values: round(statistics.median(values), 3) if values else None
    print(json.dumps({
        "machine": machine.processor(), "threads": args.threads, "rounds": args.rounds, "mitsuba": median(theirs),
        "cases": [{"scene": scene, "isa": names[kernel], "million_samples_per_s": median(ours[scene, kernel]),
                   "ratio": median(ratios[scene, kernel])} for scene, kernel in cases],
        "two_threads_over_one": median([b / a for a, b in zip(one, two)]),
    }, indent=1))


main()
