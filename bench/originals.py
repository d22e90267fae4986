#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""An unmodified Mitsuba scene in Mitsuba 3 `llvm_ad_rgb` and in Fathom, in turns: samples/s, relMSE at equal samples,
mean radiance; prints a line of JSON.

    bench/originals.py --peers FOLDER --fathom PROGRAM [--width 640] [--spp 32] [--rounds 3] [--reference-spp 512]
    SCENE_FOLDER

The scene keeps its integrator, materials and lights; both renderers use a box filter and the given width. Mitsuba's
time is that of `render` after a first image; Fathom's is that of a whole command minus that with 2 samples. relMSE
refers to a long render by Fathom, without the largest 0.1 % of errors; differences of the means are included. Called
by scenes.py --originals.
"""
import argparse
import json
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
parser.add_argument("--peers", type=Path, required=True)
parser.add_argument("--fathom", required=True)
parser.add_argument("--width", type=int, default=640)
parser.add_argument("--spp", type=int, default=32)
parser.add_argument("--rounds", type=int, default=3)
parser.add_argument("--reference-spp", type=int, default=512)
parser.add_argument("folder", type=Path)
args = parser.parse_args()
sys.path.insert(0, str(args.peers))
import common  # noqa: E402

common.enter("clay")  # restarts in an environment with the packages imported below
import numpy as np  # noqa: E402

import exr  # noqa: E402

mi = common.mitsuba("llvm_ad_rgb", 2)


def scene_of(path):
    """Loads the scene with the film's size and filter replaced: both are fixed afterwards."""
    mi.file_resolver().append(str(path.parent))
    state = mi.parser.parse_file(mi.parser.ParserConfig(mi.variant()), str(path))
    size = None
    for node in state.nodes:
        kind = node.props.plugin_name()
        if kind == "hdrfilm":
            size = args.width, node.props["height"] * args.width // node.props["width"]
            node.props["width"], node.props["height"] = size
        if kind in ("gaussian", "tent", "mitchell", "catmullrom", "lanczos"):
            for name in node.props.keys():
                node.props.remove_property(name)
            node.props.set_plugin_name("box")
    config = mi.parser.ParserConfig(mi.variant())
    mi.parser.transform_all(config, state)
    return mi.parser.instantiate(config, state), size


path = next(p for p in (args.folder / "scene.xml", *sorted(args.folder.glob("*.xml"))) if p.exists())
scene, (width, height) = scene_of(path)
pictures = tempfile.TemporaryDirectory()
picture = pictures.name + "/o.exr"


def mitsuba(samples, seed):
    start = time.time()
    pixels = np.array(mi.render(scene, spp=samples, seed=seed)).astype(np.float64)
    return time.time() - start, pixels[..., :3]


def fathom(samples, seed):
    start = time.time()
    subprocess.run([args.fathom, "render", str(path), "--spp", str(samples), "--seed", str(seed), "--size", f"{width}x{height}", "--filter", "box",
                    "--threads", "2", "-q", "-o", picture], check=True, stderr=subprocess.DEVNULL)
    return time.time() - start, exr.picture(picture)


reference = fathom(args.reference_spp, 99)[1]
mitsuba(2, 1)
rounds = []
for r in range(args.rounds):
    theirs_s, theirs = mitsuba(args.spp, 10 + r)
    start_s, _ = fathom(2, 1)
    ours_s, ours = fathom(args.spp + 2, 20 + r)
    rounds.append((theirs_s, theirs, ours_s - start_s, ours))
speed = statistics.median(r[0] / r[2] for r in rounds)
their_error = statistics.median(exr.relmse(r[1], reference) for r in rounds)
our_error = statistics.median(exr.relmse(r[3], reference) for r in rounds)
million = args.spp * width * height / 1e6
print(json.dumps({
    "scene": args.folder.name, "size": [width, height], "speed": round(speed, 2), "efficiency": round(speed * their_error / our_error, 2),
    "fathom_msps": round(million / statistics.median(r[2] for r in rounds), 3),
    "mitsuba_msps": round(million / statistics.median(r[0] for r in rounds), 3),
    "relmse_fathom": float(f"{our_error:.3g}"), "relmse_mitsuba": float(f"{their_error:.3g}"),
    "mean_fathom": [round(float(v), 4) for v in reference.mean((0, 1))],
    "mean_mitsuba": [round(float(v), 4) for v in np.mean([r[1] for r in rounds], 0).mean((0, 1))]}))
