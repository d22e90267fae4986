# SPDX-License-Identifier: Apache-2.0
"""A glass ball, a wine glass and a pool, each under a point light, a spot light, an area light and the sun (without extent).

The floor, where caustics fall, is diffuse. Lamps without surface are found by no camera path through glass.
"""
from functools import partial

import neutral
import numpy as np
import shapes

LAMP = np.array([2.2, 2.2, -0.5])
POWER = 40.0


def lamp(scene, kind, target):
    toward = shapes.unit(np.array(target) - LAMP)
    if kind == "area":
        side = 0.3
        u = shapes.unit(np.cross(toward, [0, 0, 1])) * side
        v = np.cross(toward, u)
        radiance = POWER / side**2
        scene["objects"].append(neutral.quad(LAMP - (u + v) / 2, u, v, emission=[radiance] * 3))
    else:
        more = {"point": {"position": list(LAMP), "intensity": [POWER] * 3},
                "spot": {"position": list(LAMP), "direction": list(toward), "half_angle_deg": 24.0, "intensity": [POWER] * 3},
                "sun": {"direction": list(toward), "irradiance": [4.0] * 3}}[kind]
        scene["lights"].append({"kind": kind, **more})


def glass_ball(scene):
    scene["meshes"]["ball"] = shapes.ball((0, 0.55, 0), 0.5)
    scene["objects"].append({"mesh": "ball", "material": "glass"})
    return (0, 0.5, 0)


def wine_glass(scene):
    """One closed profile: down the inside of the bowl, and up the outside from the foot."""
    outside = [(0, 0.01), (0.3, 0.01), (0.33, 0.02), (0.3, 0.035), (0.08, 0.06), (0.035, 0.12), (0.03, 0.3), (0.045, 0.48),
               (0.2, 0.58), (0.34, 0.78), (0.34, 1.0), (0.28, 1.2)]
    inside = [(0.275, 1.21), (0.265, 1.2), (0.325, 1.0), (0.325, 0.79), (0.19, 0.6), (0, 0.53)]
    profile, normals = shapes.smooth_profile(outside + inside, 12)
    scene["meshes"]["wine-glass"] = shapes.revolved(profile, normals, segments=160)
    scene["objects"].append({"mesh": "wine-glass", "material": "glass"})
    return (0, 0.6, 0)


def pool(scene):
    """Water with waves between four walls. The surface ends inside the walls, so that no path meets it from a side."""
    waves = [(9.0, 3.0, 0.010, 0.3), (-4.0, 10.0, 0.010, 1.9), (14.0, -9.0, 0.005, 4.0), (6.0, 17.0, 0.004, 2.2)]
    phase = lambda x, z, kx, kz, shift: kx * x + kz * z + shift
    height = lambda x, z: 0.5 + sum(a * np.sin(phase(x, z, kx, kz, s)) for kx, kz, a, s in waves)
    slope = lambda x, z: tuple(sum(a * (kx, kz)[i] * np.cos(phase(x, z, kx, kz, s)) for kx, kz, a, s in waves) for i in range(2))
    side = np.linspace(-2, 2, 241)
    scene["meshes"]["water"] = shapes.height_field(side, side, height, slope)
    scene["objects"].append({"mesh": "water", "material": "water"})
    for low, high in [((-2.1, 0, -2.1), (-1.9, 0.6, 2.1)), ((1.9, 0, -2.1), (2.1, 0.6, 2.1)), ((-1.9, 0, -2.1), (1.9, 0.6, -1.9)),
                      ((-1.9, 0, 1.9), (1.9, 0.6, 2.1))]:
        scene["objects"] += neutral.box(low, high, material="floor")
    return (0, 0, 0)


# Floor with the caustic: errors are measured there, because Mitsuba's ptracer shows no glass.
REGIONS = {"ball": [0.1, 0.6, 0.5, 0.85], "glass": [0.0, 0.5, 0.38, 0.86]}
THINGS = {"ball": glass_ball, "glass": wine_glass, "pool": pool}


def caustic(thing, kind):
    view = ((0, 2.2, 3.4), (0, 0.2, -0.1), 36) if thing != "pool" else ((0, 3.0, 3.2), (0, 0.2, 0), 28)
    scene = neutral.scene(f"caustic-{thing}-{kind}", neutral.camera(*view))
    scene["materials"] = {"floor": {"kind": "diffuse", "color": [0.6, 0.58, 0.55]}, "glass": {"kind": "dielectric", "ior": 1.5, "alpha": 0.0},
                          "water": {"kind": "dielectric", "ior": 1.33, "alpha": 0.0}}
    scene["sky"] = {"constant": [0.02, 0.02, 0.03]}
    if thing in REGIONS:
        scene["region"] = REGIONS[thing]
    scene["objects"] = [neutral.quad((-6, 0, -6), (0, 0, 12), (12, 0, 0), material="floor")]
    lamp(scene, kind, THINGS[thing](scene))
    return scene


SCENES = {f"caustic-{thing}-{kind}": partial(caustic, thing, kind) for thing in THINGS for kind in ("point", "spot", "area", "sun")}
