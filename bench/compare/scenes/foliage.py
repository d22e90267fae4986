# SPDX-License-Identifier: Apache-2.0
"""A bush of 60,000 leaves and grass under an environment: deep occlusion and much light from neighboring leaves."""
import neutral
import numpy as np
import shapes

from .sky import IMAGE


def leaves(center, normal, along, length, width):
    """Two triangles for each leaf, in the shape of a diamond."""
    across = shapes.unit(np.cross(normal, along)) * width
    along = shapes.unit(np.cross(across, normal)) * length
    return shapes.quads(np.stack([center, center + 0.5 * along + across, center + along, center + 0.5 * along - across], 1))


def foliage():
    rng = np.random.default_rng(60)
    scene = neutral.scene("foliage", neutral.camera((0, 1.5, 5), (0, 1.05, 0), 38))
    scene["sky"] = {"image": str(IMAGE)}
    scene["materials"] = {"leaf": {"kind": "diffuse", "color": [0.22, 0.5, 0.1]}, "grass": {"kind": "diffuse", "color": [0.3, 0.45, 0.12]},
                          "soil": {"kind": "diffuse", "color": [0.25, 0.18, 0.12]}}
    count = 60000
    normal = shapes.unit(rng.normal(size=(count, 3)))
    lobes = np.array([[0, 1.2, 0], [-0.7, 0.9, 0.2], [0.7, 0.95, -0.1], [0.1, 1.6, -0.2], [0.2, 0.6, 0.4]])
    center = lobes[rng.integers(len(lobes), size=count)] + shapes.unit(rng.normal(size=(count, 3))) * 0.62 * rng.random((count, 1)) ** (1 / 3)
    scene["meshes"]["leaves"] = leaves(center, normal, rng.normal(size=(count, 3)), rng.uniform(0.03, 0.07, (count, 1)), 0.013)
    blades = 40000
    root = np.stack([rng.uniform(-4, 4, blades), np.zeros(blades), rng.uniform(-4, 4, blades)], -1)
    up = np.array([0, 1, 0]) + rng.normal(scale=0.3, size=(blades, 3))
    scene["meshes"]["blades"] = leaves(root, np.cross(up, rng.normal(size=(blades, 3))), up, rng.uniform(0.08, 0.2, (blades, 1)), 0.006)
    scene["objects"] = [{"mesh": "leaves", "material": "leaf"}, {"mesh": "blades", "material": "grass"},
                        neutral.quad((-8, 0, -8), (0, 0, 16), (16, 0, 0), material="soil")]
    return scene


SCENES = {"foliage": foliage}
