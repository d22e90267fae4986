#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Counts how often the noise test of `fathom diff` takes noise for a change, and which changes it finds.

usage: noise_test.py PROGRAM

Noise: five scenes at 2, 8 and 32 samples per pixel, four seeds each; pairs of images with different seeds. Changes: the
Cornell box with a darker red channel of its white walls.
"""
import itertools
import json
import pathlib
import subprocess
import sys
import tempfile

SCENES = pathlib.Path(__file__).resolve().parent.parent / "scenes"
NAMES = ("cornell-box", "cornell-box-mirror", "still-life", "report-checker", "environment")
SAMPLES, SEEDS = (2, 8, 32), (1, 2, 3, 4)


def render(program, scene, output, *options):
    subprocess.run([program, "render", scene, *map(str, options), "--aov", "variance", "-q", "-o", output],
                   check=True, stderr=subprocess.DEVNULL)


def noise(program, image, reference):
    result = subprocess.run([program, "diff", image, reference, "--json"], capture_output=True, text=True)
    return json.loads(result.stdout)["noise"]


def count_false_alarms(program, folder):
    for name in NAMES:
        for samples, seed in itertools.product(SAMPLES, SEEDS):
            render(program, SCENES / f"{name}.json", folder / f"{samples}-{seed}.exr", "--spp", samples, "--seed", seed,
                   "--size", "240x180")
        alarms = pairs = 0
        for (a, b), (i, j) in itertools.product(itertools.combinations_with_replacement(SAMPLES, 2),
                                                itertools.combinations(SEEDS, 2)):
            alarms += not noise(program, folder / f"{a}-{i}.exr", folder / f"{b}-{j}.exr")["explains_differences"]
            pairs += 1
        print(f"{name}: {alarms} of {pairs} pairs that differ by noise are taken for changes", flush=True)


def find_changes(program, folder):
    text = (SCENES / "cornell-box.json").read_text()
    render(program, SCENES / "cornell-box.json", folder / "a.exr", "--spp", 32, "--size", "320x240")
    for red in (0.725, 0.72, 0.71, 0.70):
        changed = folder / "changed.json"
        changed.write_text(text.replace("[0.73, 0.73, 0.73]", f"[{red}, 0.73, 0.73]"))
        render(program, changed, folder / "b.exr", "--spp", 32, "--size", "320x240", "--seed", 5)
        found = noise(program, folder / "b.exr", folder / "a.exr")
        print(f"albedo 0.73 to {red}: whole image {'found' if found['whole_image_changed'] else 'not found'}, "
              f"{len(found['changed_blocks'])} of {found['blocks']} blocks", flush=True)


with tempfile.TemporaryDirectory() as name:
    find_changes(sys.argv[1], pathlib.Path(name))
    count_false_alarms(sys.argv[1], pathlib.Path(name))
