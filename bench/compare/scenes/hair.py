# SPDX-License-Identifier: Apache-2.0
"""A ball with 6,000 blond hairs under a lamp and a dim sky: light passes through dozens of fibers."""
import neutral
import numpy as np
import shapes

HAIRS, POINTS = 6000, 8


def hairs(rng):
    """Control points (x, y, z, radius) of curves that start inside a ball of radius 0.6 and hang down."""
    y = rng.uniform(-0.3, 1, HAIRS)
    phi = rng.uniform(0, 2 * np.pi, HAIRS)
    root = np.stack([np.sqrt(1 - y * y) * np.cos(phi), y, np.sqrt(1 - y * y) * np.sin(phi)], -1)[:, None]
    t = np.linspace(0, 1, POINTS)[None, :, None]
    bend, turn = rng.uniform(0.2, 0.5, (HAIRS, 1, 1)), rng.uniform(0, 6, (HAIRS, 1, 1))
    wave = 0.03 * np.sin(6 * t + turn) * np.array([1, 0, -1])
    points = root * (0.55 + 0.75 * t) + wave - np.array([0, 1, 0]) * bend * t * t
    radius = np.broadcast_to(0.004 * (1 - 0.8 * t), (HAIRS, POINTS, 1))
    return np.concatenate([points, radius], -1).astype(np.float32)


def hair():
    scene = neutral.scene("hair", neutral.camera((0.5, 1, 5), (0, 0.1, 0), 38), depth=100)
    scene["sky"] = {"constant": [0.2, 0.2, 0.25]}
    scene["materials"] = {"hair": {"kind": "hair", "sigma_a": [0.06, 0.1, 0.2], "beta_m": 0.3, "beta_n": 0.3, "tilt_deg": 2.0},
                          "skin": {"kind": "diffuse", "color": [0.5, 0.4, 0.35]}}
    scene["meshes"]["head"] = shapes.ball((0, 0, 0), 0.6, 96)
    scene["curves"]["hairs"] = hairs(np.random.default_rng(6))
    scene["objects"] = [{"curves": "hairs", "material": "hair"}, {"mesh": "head", "material": "skin"},
                        neutral.quad((-3, 4, 1), (2, 0, 0), (0, -1, 2), emission=[20.0, 18, 15])]
    return scene


SCENES = {"hair": hair}
