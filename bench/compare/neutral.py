# SPDX-License-Identifier: Apache-2.0
"""The scene description that every exporter reads: dictionaries with the keys below, and meshes as arrays.

A scene has `name`, `size`, `depth` (scattering events), `camera`, `materials`, `objects`, `lights`, `sky` and `meshes`. The
space is right-handed with y up, lengths are meters, radiance is linear Rec.709. Surfaces reflect on both sides, emissive
objects emit on the side of their normal only, and solids of `dielectric` and `medium` are closed.

| material | keys |
| --- | --- |
| diffuse | color |
| conductor | eta, k (RGB, exact Fresnel equations), alpha (GGX with one scattering event; 0: smooth) |
| dielectric | ior (outside: 1), alpha; sigma_a, sigma_s, g: a homogeneous medium inside |
| medium | sigma_a, sigma_s, g inside an invisible boundary |
| hair | sigma_a (for a fiber of radius 1), beta_m, beta_n, tilt_deg, as in pbrt-v4 |

`region`, if any, is the part of the image that is compared: fractions of width and height from the top left corner.

An object is a `quad` (corner, u, v; the normal is along u x v), the name of a `mesh`, or the name of `curves` (cubic B-splines
with a radius at each control point), with a `material` or an `emission`.
"""
import json

import numpy as np

import ply


def scene(name, camera, size=(256, 192), depth=50):
    return {"name": name, "size": list(size), "depth": depth, "camera": camera, "materials": {}, "objects": [], "lights": [],
            "sky": None, "meshes": {}, "curves": {}}


def camera(position, look_at, fov_y_deg, up=(0, 1, 0)):
    return {"position": list(position), "look_at": list(look_at), "up": list(up), "fov_y_deg": fov_y_deg}


def quad(corner, u, v, **keys):
    return {"quad": [list(map(float, x)) for x in (corner, u, v)], **keys}


def quad_corners(item):
    corner, u, v = (np.array(x, float) for x in item["quad"])
    return np.array([corner, corner + u, corner + u + v, corner + v])


def box(low, high, **keys):
    """Six quads with outward normals."""
    low, high = np.array(low, float), np.array(high, float)
    quads = []
    for axis in range(3):
        u, v = np.zeros(3), np.zeros(3)
        u[(axis + 1) % 3], v[(axis + 2) % 3] = (high - low)[(axis + 1) % 3], (high - low)[(axis + 2) % 3]
        top = low.copy()
        top[axis] = high[axis]
        quads += [quad(low, v, u, **keys), quad(top, u, v, **keys)]
    return quads


def save(scene, folder):
    """Writes scene.json, and each mesh as PLY and as arrays."""
    folder.mkdir(parents=True, exist_ok=True)
    for name, mesh in scene["meshes"].items():
        ply.write(folder / f"{name}.ply", **mesh)
        np.savez(folder / f"{name}.npz", **{key: value for key, value in mesh.items() if value is not None})
    for name, curves in scene["curves"].items():
        np.save(folder / f"{name}.npy", curves)
    rest = {**scene, "meshes": list(scene["meshes"]), "curves": list(scene["curves"])}
    (folder / "scene.json").write_text(json.dumps(rest, indent=1) + "\n")


def load(folder):
    scene = json.loads((folder / "scene.json").read_text())
    scene["meshes"] = {name: dict(np.load(folder / f"{name}.npz")) for name in scene["meshes"]}
    scene["curves"] = {name: np.load(folder / f"{name}.npy") for name in scene["curves"]}
    return scene
