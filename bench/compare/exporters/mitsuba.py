# SPDX-License-Identifier: Apache-2.0
"""A scene as a dictionary for mitsuba.load_dict (Mitsuba 3)."""
import numpy as np


def rgb(values):
    return {"type": "rgb", "value": list(values)}


def medium(source):
    extinction = np.add(source["sigma_a"], source["sigma_s"])
    scale = float(extinction.max())  # Colors above 1 are refused.
    return {"type": "homogeneous", "albedo": rgb(np.array(source["sigma_s"]) / extinction), "sigma_t": rgb(extinction / scale), "scale": scale,
            "phase": {"type": "hg", "g": source["g"]}}


def bsdf(source):
    kind = source["kind"]
    if kind == "diffuse":
        return {"type": "twosided", "bsdf": {"type": "diffuse", "reflectance": rgb(source["color"])}}
    if kind == "conductor":
        index = {"eta": rgb(source["eta"]), "k": rgb(source["k"])}
        rough = {"type": "roughconductor", "distribution": "ggx", "alpha": source["alpha"]} if source["alpha"] else {"type": "conductor"}
        return {"type": "twosided", "bsdf": {**rough, **index}}
    if kind == "dielectric":
        index = {"int_ior": source["ior"], "ext_ior": 1.0}
        if source["alpha"]:
            return {"type": "roughdielectric", "distribution": "ggx", "alpha": source["alpha"], **index}
        return {"type": "dielectric", **index}
    if kind == "medium":
        return {"type": "null"}
    return {"type": "hair", "sigma_a": rgb(source["sigma_a"]), "longitudinal_roughness": source["beta_m"],
            "azimuthal_roughness": source["beta_n"], "scale_tilt": source["tilt_deg"], "int_ior": 1.55, "ext_ior": 1.0}


def surface(mi, item, materials):
    """What a shape has beside its geometry."""
    if item.get("emission"):
        return {"bsdf": {"type": "diffuse", "reflectance": rgb([0, 0, 0])}, "emitter": {"type": "area", "radiance": rgb(item["emission"])}}
    source = materials[item["material"]]
    result = {"bsdf": {"type": "ref", "id": f"material-{item['material']}"}}
    if "sigma_s" in source:
        result["interior"] = medium(source)
    return result


def quad(mi, item):
    corner, u, v = (np.array(x, float) for x in item["quad"])
    normal = np.cross(u, v)
    matrix = np.eye(4)
    matrix[:3] = np.stack([u / 2, v / 2, normal / np.linalg.norm(normal), corner + u / 2 + v / 2], -1)
    return {"type": "rectangle", "to_world": mi.ScalarTransform4f(matrix)}


def shape(mi, item, scene, folder):
    if "quad" in item:
        geometry = quad(mi, item)
    elif "mesh" in item:
        smooth = "normals" in scene["meshes"][item["mesh"]]
        geometry = {"type": "ply", "filename": str(folder / f"{item['mesh']}.ply"), "face_normals": not smooth}
    else:
        path = folder / f"{item['curves']}.txt"
        text = "\n\n".join("\n".join(" ".join(f"{x:.7g}" for x in point) for point in curve) for curve in scene["curves"][item["curves"]])
        path.write_text(text + "\n")
        geometry = {"type": "bsplinecurve", "filename": str(path)}
    return {**geometry, **surface(mi, item, scene["materials"])}


def light(mi, source):
    if source["kind"] == "sun":
        return {"type": "directional", "direction": source["direction"], "irradiance": rgb(source["irradiance"])}
    if source["kind"] == "point":
        return {"type": "point", "position": source["position"], "intensity": rgb(source["intensity"])}
    at = np.array(source["position"])
    to_world = mi.ScalarTransform4f().look_at(origin=at, target=at + source["direction"], up=[0.1, 0.2, 1])
    angle = source["half_angle_deg"]
    return {"type": "spot", "to_world": to_world, "intensity": rgb(source["intensity"]), "cutoff_angle": angle, "beam_width": angle * 0.999}


def sky(mi, source):
    if "constant" in source:
        return {"type": "constant", "radiance": rgb(source["constant"])}
    # The middle of the image is towards +x; Mitsuba has +z there.
    return {"type": "envmap", "filename": source["image"], "to_world": mi.ScalarTransform4f().rotate([0, 1, 0], 90)}


def build(mi, scene, folder, integrator):
    camera, (width, height) = scene["camera"], scene["size"]
    to_world = mi.ScalarTransform4f().look_at(origin=camera["position"], target=camera["look_at"], up=camera["up"])
    media = any("sigma_s" in material for material in scene["materials"].values())
    kind = {"path": "volpath" if media else "path"}.get(integrator, integrator)
    result = {
        "type": "scene", "integrator": {"type": kind, "max_depth": scene["depth"] + 1},
        "sensor": {"type": "perspective", "fov": camera["fov_y_deg"], "fov_axis": "y", "to_world": to_world, "near_clip": 1e-3, "far_clip": 1e5,
                   "film": {"type": "hdrfilm", "width": width, "height": height, "pixel_format": "rgb", "component_format": "float32",
                            "rfilter": {"type": "box"}},
                   "sampler": {"type": "independent"}}}
    for name, material in scene["materials"].items():
        result[f"material-{name}"] = {**bsdf(material), "id": f"material-{name}"}
    for i, item in enumerate(scene["objects"]):
        result[f"shape{i}"] = shape(mi, item, scene, folder)
    for i, source in enumerate(scene["lights"]):
        result[f"light{i}"] = light(mi, source)
    if scene["sky"]:
        result["sky"] = sky(mi, scene["sky"])
    return result
