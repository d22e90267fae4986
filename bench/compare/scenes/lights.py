# SPDX-License-Identifier: Apache-2.0
"""A closed room lit by 1,000 small lamps of random places, directions, colors and brightness."""
import neutral
import numpy as np
import shapes

COLORS = 10


def lamps(count, rng):
    """Corners of quads with an edge of 2 to 8 cm."""
    normal = shapes.unit(rng.normal(size=(count, 3)))
    u = shapes.unit(np.cross(normal, rng.normal(size=(count, 3))))
    v = np.cross(normal, u)
    edge = rng.uniform(0.02, 0.08, (count, 1))
    center = rng.uniform((-4.8, 0.2, -4.8), (4.8, 3.8, 4.8), (count, 3))
    return np.stack([center, center + edge * u, center + edge * (u + v), center + edge * v], 1)


def thousand():
    rng = np.random.default_rng(1000)
    scene = neutral.scene("lights-1000", neutral.camera((0, 2, 4.9), (0, 1.8, 0), 60))
    scene["materials"] = {"gray": {"kind": "diffuse", "color": [0.5] * 3}}
    corners = lamps(1000, rng)
    for i in range(COLORS):
        scene["meshes"][f"lamps{i}"] = shapes.quads(corners[i::COLORS])
        color = rng.uniform(0.3, 1, 3) * 4 ** rng.uniform(1, 3)
        scene["objects"].append({"mesh": f"lamps{i}", "emission": [round(float(c), 3) for c in color]})
    scene["objects"] += [{**wall, "material": "gray"} for wall in neutral.box((-5, 0, -5), (5, 4, 5))]
    return scene


SCENES = {"lights-1000": thousand}
