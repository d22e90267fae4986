# SPDX-License-Identifier: Apache-2.0
"""Scattering in volumes: a room with fog, and solids of wax with a refracting boundary (subsurface scattering by random walks)."""
import neutral
import shapes


def fog():
    """A room of fog, seen from outside through its open front: no camera is inside a medium."""
    scene = neutral.scene("fog", neutral.camera((0, 1.5, 7.5), (0, 1.3, 0), 36))
    scene["materials"] = {"wall": {"kind": "diffuse", "color": [0.6] * 3}, "ball": {"kind": "diffuse", "color": [0.7, 0.3, 0.2]},
                          "fog": {"kind": "medium", "sigma_s": [0.25] * 3, "sigma_a": [0.02] * 3, "g": 0.4}}
    low, high = (-2, 0, -2), (2, 3, 2)
    walls = neutral.box((-2.01, -0.01, -2.01), (2.01, 3.01, 2.01))
    scene["meshes"] = {"ball": shapes.ball((-0.6, 0.6, -0.3), 0.6, 96), "fog": shapes.quads(corners(neutral.box(low, high)))}
    scene["objects"] = [*({**wall, "material": "wall"} for wall in walls[:5]), {"mesh": "ball", "material": "ball"},
                        {"mesh": "fog", "material": "fog"}, neutral.quad((0.3, 2.9, -0.6), (0.5, 0, 0), (0, 0, 0.5), emission=[40.0, 36, 30])]
    return scene


def corners(quads):
    import numpy as np
    return np.array([neutral.quad_corners(quad) for quad in quads])


def subsurface():
    scene = neutral.scene("subsurface", neutral.camera((0, 1.3, 4), (0, 0.5, 0), 36), depth=1000)
    wax = {"kind": "dielectric", "ior": 1.4, "alpha": 0.0, "sigma_s": [14.0, 12.0, 9.0], "sigma_a": [0.03, 0.12, 0.4], "g": 0.0}
    scene["materials"] = {"floor": {"kind": "diffuse", "color": [0.5] * 3}, "wax": wax}
    scene["sky"] = {"constant": [0.3, 0.3, 0.35]}
    scene["meshes"] = {"left": shapes.ball((-0.75, 0.55, 0), 0.55, 128), "right": shapes.ball((0.6, 0.35, 0.5), 0.35, 128)}
    scene["objects"] = [neutral.quad((-5, -0.001, -5), (0, 0, 10), (10, 0, 0), material="floor"),
                        *({"mesh": name, "material": "wax"} for name in scene["meshes"]),
                        neutral.quad((-1.5, 3, -1.5), (1, 0, 0), (0, 0, 1), emission=[14.0, 14, 13])]
    return scene


SCENES = {"fog": fog, "subsurface": subsurface}
