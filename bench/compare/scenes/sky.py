# SPDX-License-Identifier: Apache-2.0
"""Diffuse and glossy things on a plane under a photograph-like environment with a small bright sun."""
from pathlib import Path

import neutral
import shapes

IMAGE = Path(__file__).resolve().parents[3] / "scenes/images/sky.hdr"


def environment():
    scene = neutral.scene("environment", neutral.camera((2.5, 1.8, 4.5), (0, 0.6, 0), 38))
    scene["sky"] = {"image": str(IMAGE)}
    scene["materials"] = {"ground": {"kind": "diffuse", "color": [0.45, 0.4, 0.35]}, "clay": {"kind": "diffuse", "color": [0.7, 0.35, 0.25]},
                          "gold": {"kind": "conductor", "eta": [0.17, 0.35, 1.5], "k": [3.1, 2.7, 1.9], "alpha": 0.1}}
    scene["meshes"] = {"left": shapes.ball((-1.1, 0.6, 0), 0.6), "right": shapes.ball((0.7, 0.6, -0.5), 0.6)}
    scene["objects"] = [neutral.quad((-8, 0, -8), (0, 0, 16), (16, 0, 0), material="ground"), {"mesh": "left", "material": "clay"},
                        {"mesh": "right", "material": "gold"}, *neutral.box((-0.4, 0, 0.8), (0.2, 0.5, 1.4), material="clay")]
    return scene


SCENES = {"environment": environment}
