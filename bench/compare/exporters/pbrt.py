# SPDX-License-Identifier: Apache-2.0
"""Writes a scene in pbrt-v4's format."""
import numpy as np


def numbers(values):
    return "[" + " ".join(f"{float(x):.9g}" for x in np.ravel(values)) + "]"


def points(values):
    return "[" + " ".join(f"{float(x):.9g}" for x in np.ravel(np.asarray(values, np.float32))) + "]"


def medium(name, source):
    return (f'MakeNamedMedium "{name}" "string type" "homogeneous" "rgb sigma_a" {numbers(source["sigma_a"])} '
            f'"rgb sigma_s" {numbers(source["sigma_s"])} "float g" {source["g"]} "float scale" 1\n')


def material(source):
    kind = source["kind"]
    if kind == "diffuse":
        return f'Material "diffuse" "rgb reflectance" {numbers(source["color"])}\n'
    rough = f'"float roughness" {source.get("alpha", 0)} "bool remaproughness" false'
    if kind == "conductor":
        return f'Material "conductor" "rgb eta" {numbers(source["eta"])} "rgb k" {numbers(source["k"])} {rough}\n'
    if kind == "dielectric":
        return f'Material "dielectric" "float eta" {source["ior"]} {rough}\n'
    if kind == "medium":
        return 'Material "interface"\n'
    return (f'Material "hair" "rgb sigma_a" {numbers(source["sigma_a"])} "float beta_m" {source["beta_m"]} '
            f'"float beta_n" {source["beta_n"]} "float alpha" {source["tilt_deg"]} "float eta" 1.55\n')


def curve_shapes(curves):
    """pbrt's cubic B-splines have a width that changes linearly along the curve: every span is a curve of its own, and has
    the widths of its ends."""
    lines = []
    for curve in np.asarray(curves, float):
        knots = 2 * (curve[:-2, 3] + 4 * curve[1:-1, 3] + curve[2:, 3]) / 6
        for i in range(len(curve) - 3):
            lines.append(f'Shape "curve" "string basis" "bspline" "string type" "cylinder" "point3 P" {points(curve[i:i + 4, :3])} '
                         f'"float width0" {knots[i]:.7g} "float width1" {knots[i + 1]:.7g}\n')
    return "".join(lines)


def shape(item, scene):
    if "quad" in item:
        corner, u, v = (np.array(x, float) for x in item["quad"])
        return f'Shape "trianglemesh" "point3 P" {numbers([corner, corner + u, corner + u + v, corner + v])} "integer indices" [0 1 2 0 2 3]\n'
    if "mesh" in item:
        return f'Shape "plymesh" "string filename" "{item["mesh"]}.ply"\n'
    return curve_shapes(scene["curves"][item["curves"]])


def attribute(item, scene):
    lines = ["AttributeBegin\n"]
    if item.get("emission"):
        lines += ['Material "diffuse" "rgb reflectance" [0 0 0]\n',
                  f'AreaLightSource "diffuse" "rgb L" {numbers(item["emission"])} "float scale" 1\n']
    else:
        source = scene["materials"][item["material"]]
        lines.append(material(source))
        if "sigma_s" in source:
            lines.append(f'MediumInterface "{item["material"]}" ""\n')
    return "".join([*lines, shape(item, scene), "AttributeEnd\n"])


def light(source):
    if source["kind"] == "sun":
        return f'LightSource "distant" "point3 from" [0 0 0] "point3 to" {numbers(source["direction"])} "rgb L" {numbers(source["irradiance"])}\n'
    begin = f'LightSource "{source["kind"]}" "rgb I" {numbers(source["intensity"])} "point3 from" {numbers(source["position"])}'
    if source["kind"] == "point":
        return begin + "\n"
    to = np.add(source["position"], source["direction"])
    angle = source["half_angle_deg"]
    return begin + f' "point3 to" {numbers(to)} "float coneangle" {angle} "float conedeltaangle" {0.001 * angle:.6g}\n'


def sky(source):
    if "constant" in source:
        return f'LightSource "infinite" "rgb L" {numbers(source["constant"])}\n'
    raise ValueError("pbrt-v4 reads environments in its equal-area mapping only")


def unsupported(scene):
    return "pbrt-v4 reads equal-area environments only" if scene["sky"] and "image" in scene["sky"] else None


def text(scene, integrator="volpath", spp=16, seed=0, out="out.exr"):
    camera, (width, height) = scene["camera"], scene["size"]
    # The angle is that of the smaller side. pbrt's space is left-handed, so the image is mirrored.
    fov = camera["fov_y_deg"] if height <= width else np.degrees(2 * np.arctan(np.tan(np.radians(camera["fov_y_deg"] / 2)) * width / height))
    parts = ["Scale -1 1 1\n", f'LookAt {" ".join(f"{x:.9g}" for x in [*camera["position"], *camera["look_at"], *camera["up"]])}\n',
             f'Camera "perspective" "float fov" {fov:.9g}\n',
             f'Film "rgb" "integer xresolution" {width} "integer yresolution" {height} "string filename" "{out}" "string sensor" "cie1931"\n',
             f'Sampler "zsobol" "integer pixelsamples" {spp} "integer seed" {seed}\nPixelFilter "box" "float xradius" 0.5 "float yradius" 0.5\n',
             f'Integrator "{integrator}" "integer maxdepth" {scene["depth"]}\n', "WorldBegin\n"]
    parts += [medium(name, source) for name, source in scene["materials"].items() if "sigma_s" in source]
    parts += [light(source) for source in scene["lights"]]
    if scene["sky"]:
        parts.append(sky(scene["sky"]))
    return "".join(parts + [attribute(item, scene) for item in scene["objects"]])


def write(scene, folder, **settings):
    path = folder / "scene.pbrt"
    path.write_text(text(scene, **settings))
    return path
