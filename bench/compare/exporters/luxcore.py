# SPDX-License-Identifier: Apache-2.0
"""A scene as properties of LuxCore's scene description, and its meshes.

LuxCore's rough metals have Schlick's distribution of normals, not GGX. It has no hair.
"""
import math

import neutral
import numpy as np


def unsupported(scene):
    """Why LuxCore can't render a scene, or None."""
    return "LuxCore has no hair material" if scene["curves"] else None


def z_up(points):
    """LuxCore's environments have their pole along z."""
    points = np.asarray(points, float)
    return np.stack([points[..., 0], -points[..., 2], points[..., 1]], -1)


def volume(name, source):
    return {f"scene.volumes.{name}.type": "homogeneous", f"scene.volumes.{name}.absorption": source["sigma_a"],
            f"scene.volumes.{name}.scattering": source["sigma_s"], f"scene.volumes.{name}.asymmetry": [source["g"]] * 3,
            f"scene.volumes.{name}.multiscattering": 1, f"scene.volumes.{name}.ior": source.get("ior", 1.0)}


def material(name, source):
    kind, key = source["kind"], f"scene.materials.{name}"
    rows = {}
    if "sigma_s" in source:
        rows |= volume(f"{name}-inside", source)
    if kind == "diffuse":
        rows |= {f"{key}.type": "matte", f"{key}.kd": source["color"]}
    elif kind == "conductor":
        fresnel = f"scene.textures.{name}-fresnel"
        rows |= {f"{fresnel}.type": "fresnelconst", f"{fresnel}.n": source["eta"], f"{fresnel}.k": source["k"]}
        rough = max(1e-4, source["alpha"])
        rows |= {f"{key}.type": "metal2", f"{key}.fresnel": f"{name}-fresnel", f"{key}.uroughness": rough, f"{key}.vroughness": rough}
    elif kind == "dielectric":
        rows |= {f"{key}.type": "glass", f"{key}.kr": [1.0] * 3, f"{key}.kt": [1.0] * 3,
                 f"{key}.interiorior": source["ior"], f"{key}.exteriorior": 1.0}
    else:
        rows |= {f"{key}.type": "null"}
    if "sigma_s" in source:
        rows[f"{key}.volume.interior"] = f"{name}-inside"
    return rows


def light(name, source):
    key = f"scene.lights.{name}"
    if source["kind"] == "sun":
        return {f"{key}.type": "sharpdistant", f"{key}.direction": z_up(source["direction"]), f"{key}.color": source["irradiance"]}
    # A point light of LuxCore divides its color by the solid angle of all directions, a spot light doesn't.
    color = [4 * math.pi * x for x in source["intensity"]] if source["kind"] == "point" else source["intensity"]
    rows = {f"{key}.type": source["kind"], f"{key}.position": z_up(source["position"]), f"{key}.color": color}
    if source["kind"] == "spot":
        target = np.add(source["position"], source["direction"])
        rows |= {f"{key}.target": z_up(target), f"{key}.coneangle": source["half_angle_deg"], f"{key}.conedeltaangle": 0.0}
    return rows


def sky(source):
    if "constant" in source:
        return {"scene.lights.sky.type": "constantinfinite", "scene.lights.sky.color": source["constant"]}
    # LuxCore's environments have +x at the left edge and are mirrored.
    mirror = [-1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0]
    return {"scene.lights.sky.type": "infinite", "scene.lights.sky.transformation": mirror, "scene.lights.sky.file": source["image"], "scene.lights.sky.gamma": 1.0}


def properties(scene):
    """All properties except those of objects."""
    source, (width, height) = scene["camera"], scene["size"]
    # The field of view is that of the longer side.
    tangent = math.tan(math.radians(source["fov_y_deg"] / 2)) * max(1.0, width / height)
    rows = {"scene.camera.type": "perspective", "scene.camera.lookat.orig": z_up(source["position"]),
            "scene.camera.lookat.target": z_up(source["look_at"]), "scene.camera.up": z_up(source["up"]),
            "scene.camera.fieldofview": 2 * math.degrees(math.atan(tangent)), "scene.camera.autofocus.enable": 0}
    for name, made in scene["materials"].items():
        rows |= material(name, made)
    for i, item in enumerate(scene["objects"]):
        if item.get("emission"):
            rows |= {f"scene.materials.emission{i}.type": "matte", f"scene.materials.emission{i}.kd": [0.0] * 3,
                     f"scene.materials.emission{i}.emission": item["emission"]}
    for i, made in enumerate(scene["lights"]):
        rows |= light(f"light{i}", made)
    if scene["sky"]:
        rows |= sky(scene["sky"])
    return rows


def mesh(item, scene):
    """Points, triangles and normals of an object."""
    if "quad" in item:
        return z_up(neutral.quad_corners(item)), [[0, 1, 2], [0, 2, 3]], None
    made = scene["meshes"][item["mesh"]]
    normals = made.get("normals")
    return z_up(made["positions"]), made["triangles"], None if normals is None else z_up(normals)


def build(pyluxcore, to_properties, scene):
    made = pyluxcore.Scene()
    made.Parse(to_properties(properties(scene)))
    tuples = lambda array, kind: [tuple(map(kind, row)) for row in array]
    rows = {}
    for i, item in enumerate(scene["objects"]):
        points, triangles, normals = mesh(item, scene)
        made.DefineMesh(f"mesh{i}", tuples(points, float), tuples(triangles, int), None if normals is None else tuples(normals, float),
                        None, None, None)
        rows |= {f"scene.objects.object{i}.shape": f"mesh{i}",
                 f"scene.objects.object{i}.material": f"emission{i}" if item.get("emission") else item["material"]}
    made.Parse(to_properties(rows))
    return made
