# SPDX-License-Identifier: Apache-2.0
"""Writes a scene as Fathom's JSON."""
import json
import math


def medium(material):
    """Scattering and absorption as keys of `glass`: the fraction that remains after a distance of about one mean free path."""
    extinction = [a + s for a, s in zip(material["sigma_a"], material["sigma_s"])]
    distance = 1 / max(extinction)
    return {"attenuation_color": [math.exp(-distance * x) for x in extinction], "attenuation_distance": distance,
            "transmission_scatter": [distance * s for s in material["sigma_s"]],
            "transmission_scatter_anisotropy": material["g"]}


def material(source):
    kind = source["kind"]
    if kind == "diffuse":
        return {"kind": "diffuse", "color": source["color"]}
    if kind == "conductor":
        return {"kind": "principled", "conductor": {"eta": source["eta"], "k": source["k"]},
                "roughness": math.sqrt(source["alpha"]), "energy_compensation": False}
    if kind == "dielectric":
        inside = medium(source) if "sigma_s" in source else {}
        return {"kind": "glass", "ior": source["ior"], "roughness": math.sqrt(source["alpha"]), "energy_compensation": False, **inside}
    if kind == "medium":
        return {"kind": "glass", "ior": 1, **medium(source)}
    return {"kind": "hair", "absorption": source["sigma_a"], "beta_m": source["beta_m"], "beta_n": source["beta_n"],
            "scale_tilt": source["tilt_deg"]}


def light(source):
    if source["kind"] == "sun":
        return {"kind": "directional", "direction": source["direction"], "color": source["irradiance"]}
    result = {"kind": source["kind"], "position": source["position"], "color": source["intensity"]}
    if source["kind"] == "spot":
        angle = source["half_angle_deg"]
        result |= {"direction": source["direction"], "inner_angle_deg": angle * 0.999, "outer_angle_deg": angle}
    return result


def node(item, materials):
    """A node; emissive objects get a material of their own."""
    if item.get("emission"):
        name = "emission " + " ".join(f"{x:g}" for x in item["emission"])
        materials[name] = {"kind": "none", "emission": item["emission"]}
    else:
        name = item["material"]
    if "quad" in item:
        corner, u, v = item["quad"]
        return {"material": name, "rectangle": {"corner": corner, "edge_u": u, "edge_v": v}}
    kind = "mesh" if "mesh" in item else "curves"
    return {"material": name, kind: item[kind]}


def environment(sky):
    if sky is None:
        return {"kind": "none"}
    if "constant" in sky:
        return {"kind": "constant", "color": sky["constant"]}
    return {"kind": "image", "image": sky["image"]}


def write(scene, folder):
    """Writes fathom.json beside the meshes that neutral.save has written; returns its path."""
    materials = {name: material(source) for name, source in scene["materials"].items()}
    nodes = [node(item, materials) for item in scene["objects"]]
    out = {"fathom": 1, "camera": scene["camera"], "environment": environment(scene["sky"]), "materials": materials,
           "lights": {f"light{i}": light(source) for i, source in enumerate(scene["lights"])},
           "meshes": {name: {"file": f"{name}.ply"} for name in scene["meshes"]},
           "curves": {name: {"basis": "bspline", "curves": curves.tolist()} for name, curves in scene["curves"].items()},
           "render": {"size": scene["size"], "max_depth": scene["depth"], "filter": "box"}, "scene": nodes}
    path = folder / "fathom.json"
    path.write_text(json.dumps(out) + "\n")
    return path
