# SPDX-License-Identifier: Apache-2.0
"""Balls and a floor of rough metals in a room with a large and a small lamp: many glossy reflections of each other."""
import neutral
import numpy as np
import shapes

METALS = {"copper": ([0.21, 0.76, 1.2], [3.6, 2.6, 2.3]), "gold": ([0.17, 0.35, 1.5], [3.1, 2.7, 1.9]), "iron": ([2.9, 2.9, 2.6], [3.1, 2.9, 2.8])}


def metals():
    scene = neutral.scene("metals", neutral.camera((0, 1.6, 5.5), (0, 0.7, 0), 38))
    scene["materials"]["wall"] = {"kind": "diffuse", "color": [0.6, 0.6, 0.65]}
    alphas = [0.02, 0.06, 0.12, 0.25, 0.4]
    for i, alpha in enumerate(alphas):
        eta, k = METALS[list(METALS)[i % 3]]
        scene["materials"][f"metal{i}"] = {"kind": "conductor", "eta": eta, "k": k, "alpha": alpha}
        scene["meshes"][f"ball{i}"] = shapes.ball((-2 + i, 0.45, 0.6 * np.cos(2.2 * i)), 0.45, 96)
        scene["objects"].append({"mesh": f"ball{i}", "material": f"metal{i}"})
    scene["materials"]["floor"] = {"kind": "conductor", "eta": METALS["iron"][0], "k": METALS["iron"][1], "alpha": 0.15}
    low, high = (-3.5, 0, -3), (3.5, 3, 6)
    for i, wall in enumerate(neutral.box(low, high)):
        scene["objects"].append({**wall, "material": "floor" if i == 2 else "wall"})
    scene["objects"] += [neutral.quad((-2.5, 2.99, -1), (1.5, 0, 0), (0, 0, 1.5), emission=[6.0, 6, 6]),
                         neutral.quad((1.8, 2.5, 0.5), (0.12, 0, 0), (0, 0, 0.12), emission=[300.0, 240, 180])]
    return scene


SCENES = {"metals": metals}
