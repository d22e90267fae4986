#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Measures what calls from Python cost: docs/measurements/python.md.

usage: PYTHONPATH=build/release/python python_calls.py PROGRAM

Times are the least of several runs, since other programs only make runs longer. Needs trimesh for the large mesh.
"""
import json
import pathlib
import subprocess
import sys
import tempfile
import time

import numpy as np

import fathom

program = sys.argv[1]


def seconds(action):
    begin = time.perf_counter()
    result = action()
    return time.perf_counter() - begin, result


def overhead():
    """One sample of 64x64 pixels of a scene that is compiled already: the call without the rendering itself."""
    scene = fathom.Scene()
    scene.add(sphere={"radius": 1}, material=fathom.Material("diffuse"))
    scene.environment = fathom.Environment("constant")
    scene.camera = fathom.Camera.look_at((0, 0, 4), (0, 0, 0))
    scene.render(size=(64, 64), spp=1)
    rest = []
    for seed in range(200):
        whole, image = seconds(lambda: scene.render(size=(64, 64), spp=1, seed=seed))
        rest.append(whole - float(image.attributes["fathom.render_s"]))
    print(f"overhead of a call: least {1e3 * min(rest):.2f} ms, median {1e3 * float(np.median(rest)):.2f} ms")


def large_mesh(folder):
    """A trimesh of a million triangles to the start of rendering, and the program with the same PLY."""
    import trimesh
    side = 708
    x, y = np.meshgrid(np.linspace(0, 1, side), np.linspace(0, 1, side))
    vertices = np.stack([x, 0.1 * np.sin(9 * x) * np.cos(7 * y), y], axis=-1).reshape(-1, 3)
    corner = (np.arange(side - 1)[:, None] * side + np.arange(side - 1)).reshape(-1, 1)
    faces = np.concatenate([corner + [0, side, 1], corner + [1, side, side + 1]])
    mesh = trimesh.Trimesh(vertices, faces, process=False)
    mesh.export(folder / "mesh.ply")
    options = {"size": (64, 48), "spp": 1}
    words = ["--size", "64x48", "--spp", "1", "--up-axis", "y", "--progress", "json", "-o", folder / "a.png"]
    in_python, by_program = [], []
    for _ in range(5):
        whole, image = seconds(lambda: fathom.render(mesh, **options))
        in_python.append(whole - float(image.attributes["fathom.render_s"]))
        events = subprocess.run([program, "render", folder / "mesh.ply", *words], check=True, capture_output=True, text=True)
        summary = next(event for line in events.stderr.splitlines() if (event := json.loads(line))["event"] == "summary")
        by_program.append(summary["load_s"] + summary["build_s"])
    image.save(folder / "b.png")
    same = (folder / "a.png").read_bytes() == (folder / "b.png").read_bytes()
    print(f"{len(faces)} triangles to the start of rendering: Python {min(in_python):.3f} s, program {min(by_program):.3f} s, "
          f"equal images: {same}")


overhead()
with tempfile.TemporaryDirectory() as name:
    large_mesh(pathlib.Path(name))
