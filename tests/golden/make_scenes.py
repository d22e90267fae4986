#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Writes the small scenes of tests/golden/scenes, which together use every feature that affects an image.

usage: make_scenes.py [FOLDER]      default: the folder `scenes` beside this file

The scenes are stored in the repository, so a changed image means that the program changed. After editing this script, run it
and accept the new images (golden_test.py --accept)."""
import base64
import json
import math
import pathlib
import struct
import sys
import zlib

import measured_file

FOLDER = pathlib.Path(sys.argv[1]) if len(sys.argv) > 1 else pathlib.Path(__file__).parent / "scenes"
FLOOR = {"material": {"color": [0.6, 0.5, 0.4]}, "rectangle": {"corner": [-3, 0, 3], "edge_u": [6, 0, 0], "edge_v": [0, 0, -6]}}
BALL = {"sphere": {"center": [0, 0.7, 0], "radius": 0.7}}
CAMERA = {"position": [0.5, 1.6, 4], "look_at": [0, 0.6, 0], "fov_y_deg": 35}
SKY = {"kind": "gradient", "bottom": [0.3, 0.3, 0.35], "top": [0.7, 0.9, 1.2]}
LAMP = {"name": "lamp", "material": {"kind": "none", "emission": [6, 5, 4]},
        "rectangle": {"corner": [-1, 3, -1], "edge_u": [1.5, 0, 0], "edge_v": [0, 0, 1.2]}}


def write(name, **content):
    scene = {"fathom": 1, "camera": CAMERA, "environment": SKY, **content}
    if scene["environment"] is None:
        del scene["environment"]
    if scene["camera"] is None:
        del scene["camera"]
    (FOLDER / f"{name}.json").write_text(json.dumps(scene, indent=1) + "\n")


def with_material(**material):
    return [FLOOR, {**BALL, "material": material}]


def wall(**material):
    """A wall that fills the image."""
    return [{"material": material, "rectangle": {"corner": [-3, -1, 0], "edge_u": [6, 0, 0], "edge_v": [0, 4, 0]}}, FLOOR]


def png(name, width, height, channels, value, bits=8):
    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
    most = 2 ** bits - 1
    rows = b""
    for y in range(height):
        rows += b"\0"
        for x in range(width):
            for v in value(x, y):
                code = round(max(0, min(1, v)) * most)
                rows += struct.pack(">H" if bits == 16 else ">B", code)
    header = struct.pack(">IIBBBBB", width, height, bits, {1: 0, 3: 2, 4: 6}[channels], 0, 0, 0)
    (FOLDER / name).write_bytes(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(rows, 9)) +
                                chunk(b"IEND", b""))


def hdr(name, width, height, value):
    data = f"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y {height} +X {width}\n".encode()
    for y in range(height):
        for x in range(width):
            rgb = value(x, y)
            mantissa, exponent = math.frexp(max(rgb))
            data += bytes([int(math.ldexp(v, 8 - exponent)) for v in rgb] + [exponent + 128])
    (FOLDER / name).write_bytes(data)


def assets():
    png("bands.png", 8, 8, 3, lambda x, y: ((x % 4) / 3, (y % 4) / 3, 0.2 + 0.1 * ((x + y) % 5)))
    png("wide.png", 5, 3, 3, lambda x, y: (0.1 + 0.15 * x, 0.9 - 0.3 * y, 0.5), bits=16)
    png("channels.png", 4, 4, 4, lambda x, y: (x / 3, y / 3, ((x + y) % 3) / 2, 0.25 + 0.25 * ((x * y) % 4)))
    png("bumps.png", 8, 8, 3, lambda x, y: (0.5 + 0.3 * math.sin(x * math.pi / 4), 0.5 + 0.2 * math.cos(y * math.pi / 2), 0.9))
    hdr("sky.hdr", 12, 6, lambda x, y: (20.0, 16.0, 8.0) if (x, y) == (8, 1) else (0.25 + 0.0625 * y, 0.5, 0.5 + 0.0625 * x))
    (FOLDER / "model.mtl").write_text("newmtl red\nKd 0.8 0.1 0.1\nnewmtl shiny\nKd 0.2 0.3 0.8\nKs 0.5 0.5 0.5\nNs 60\n"
                                      "newmtl picture\nKd 1 1 1\nmap_Kd -s 2 2 -o 0.25 0.125 bands.png\n")
    (FOLDER / "model.obj").write_text(
        "mtllib model.mtl\nv -0.6 0 0\nv 0.6 0 0\nv 0.6 1.2 -0.2\nv -0.6 1.2 -0.2\nv 0 0.6 0.8\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n"
        "vn 0 0.16 0.98\nvn 0.5 0 0.8\nusemtl picture\nf 1/1 2/2 3/3 4/4\nusemtl red\nf 1//1 2//2 5//1\n"
        "usemtl shiny\nf -2 -3 -1\nf 1 5 4\n")
    points = [(-0.7, 0, 0), (0.7, 0, 0.1), (0.5, 1.2, -0.2), (-0.5, 1.1, 0), (0, 0.5, 0.7)]
    faces = [(0, 1, 4), (1, 2, 4), (2, 3, 4), (3, 0, 4), (3, 2, 1, 0)]
    ply = ("ply\nformat binary_big_endian 1.0\nelement vertex 5\nproperty float x\nproperty float y\nproperty float z\n"
           "property uchar red\nproperty uchar green\nproperty uchar blue\nelement face 5\n"
           "property list uchar int vertex_indices\nend_header\n").encode()
    for i, p in enumerate(points):
        ply += struct.pack(">fffBBB", *p, 250 - 40 * i, 60 + 30 * i, 128)
    for f in faces:
        ply += struct.pack(f">B{len(f)}i", len(f), *f)
    (FOLDER / "model.ply").write_bytes(ply)
    stl = b" " * 80 + struct.pack("<I", 4)
    for f in faces[:4]:
        stl += struct.pack("<3f", 0, 0, 0)
        for i in f:
            x, y, z = points[i]
            stl += struct.pack("<3f", x, -z, y)  # STL has z up
        stl += b"\0\0"
    (FOLDER / "model.stl").write_bytes(stl)
    gltf()


def gltf():
    data, views, accessors = b"", [], []

    def view(fmt, values, stride=None):
        nonlocal data
        data += b"\0" * (-len(data) % 4)
        packed = struct.pack(f"<{len(values)}{fmt}", *values)
        views.append({"buffer": 0, "byteOffset": len(data), "byteLength": len(packed), **({"byteStride": stride} if stride else {})})
        data += packed
        return len(views) - 1

    def accessor(v, kind, count, component=5126, **more):
        accessors.append({"bufferView": v, "componentType": component, "count": count, "type": kind, **more})
        return len(accessors) - 1

    # A bent quad has interleaved positions and normals, 16-bit uv, 8-bit colors, and one position by a sparse accessor.
    corners = [(-0.8, 0, 0), (0.8, 0, 0.2), (0.7, 1.4, 0), (-0.7, 1.3, 0.3)]
    normals = [(-0.3, 0, 0.95), (0.3, 0, 0.95), (0.3, 0.3, 0.9), (-0.3, 0.3, 0.9)]
    mixed = view("f", [x for p, n in zip(corners, normals) for x in (*p, *n)], 24)
    sparse = {"count": 1, "indices": {"bufferView": view("H", [2]), "componentType": 5123},
              "values": {"bufferView": view("f", [0.9, 1.5, -0.1])}}
    position = accessor(mixed, "VEC3", 4, sparse=sparse)
    normal = accessor(mixed, "VEC3", 4, byteOffset=12)
    uv = accessor(view("H", [0, 65535, 65535, 65535, 65535, 0, 0, 0]), "VEC2", 4, 5123, normalized=True)
    color = accessor(view("B", [255, 200, 150, 255, 200, 255, 150, 255, 150, 200, 255, 255, 255, 255, 255, 255]), "VEC4", 4, 5121,
                     normalized=True)
    indices = accessor(view("B", [0, 1, 2, 0, 2, 3]), "SCALAR", 6, 5121)
    primitive = {"attributes": {"POSITION": position, "NORMAL": normal, "TEXCOORD_0": uv, "COLOR_0": color}, "indices": indices,
                 "material": 0}
    document = {
        "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}],
        "extensionsUsed": ["KHR_lights_punctual", "KHR_texture_transform"],
        "extensions": {"KHR_lights_punctual": {"lights": [{"type": "spot", "intensity": 30, "color": [1, 0.8, 0.6],
                                                           "spot": {"innerConeAngle": 0.2, "outerConeAngle": 0.6}}]}},
        "nodes": [{"children": [1, 2], "rotation": [0.1, 0.3, -0.05, 0.94]}, {"mesh": 0, "translation": [0.1, 0.1, 0]},
                  {"translation": [0.5, 2, 2], "rotation": [-0.38, 0, 0, 0.92], "extensions": {"KHR_lights_punctual": {"light": 0}}}],
        "images": [{"uri": "bands.png"}, {"uri": "channels.png"}], "samplers": [{"wrapS": 33648, "wrapT": 33071}],
        "textures": [{"source": 0, "sampler": 0}, {"source": 1}],
        "materials": [{"doubleSided": True, "pbrMetallicRoughness": {
            "baseColorTexture": {"index": 0, "extensions": {"KHR_texture_transform":
                {"offset": [0.2, 0.1], "scale": [1.5, 0.75], "rotation": 0.4}}},
            "metallicRoughnessTexture": {"index": 1}, "metallicFactor": 0.8, "roughnessFactor": 0.9}}],
        "meshes": [{"primitives": [primitive]}], "accessors": accessors, "bufferViews": views,
        "buffers": [{"byteLength": len(data), "uri": "data:application/octet-stream;base64," + base64.b64encode(data).decode()}]}
    (FOLDER / "model.gltf").write_text(json.dumps(document) + "\n")
    del document["buffers"][0]["uri"]
    text = json.dumps(document).encode()
    text += b" " * (-len(text) % 4)
    data += b"\0" * (-len(data) % 4)
    body = struct.pack("<II", len(text), 0x4e4f534a) + text + struct.pack("<II", len(data), 0x004e4942) + data
    (FOLDER / "model.glb").write_bytes(b"glTF" + struct.pack("<II", 2, 12 + len(body)) + body)


def materials():
    write("diffuse", scene=with_material(color=[0.8, 0.3, 0.2]))
    write("diffuse-rough", scene=with_material(color=[0.8, 0.3, 0.2], roughness=0.8))
    write("mirror", scene=with_material(kind="metal", color=[0.9, 0.7, 0.4]))
    write("metal-rough", scene=with_material(kind="metal", color=[0.9, 0.7, 0.4], roughness=0.45), lights={
        "sun": {"kind": "directional", "direction": [-1, -2, -1], "intensity": 2}})
    write("fuzz-metal", scene=with_material(kind="fuzz_metal", color=[0.9, 0.7, 0.4], fuzz=0.4))
    write("plastic", scene=with_material(kind="plastic", color=[0.8, 0.3, 0.2], roughness=0.3))
    write("mixture", scene=with_material(
        kind="mix", factor={"texture": {"image": "channels.png"}, "channel": "g", "value": 0.5},
        material_a={"kind": "two_sided", "front": {"kind": "glass", "thin": True, "color": [0.5, 0.8, 0.9]},
                    "back": {"color": [0.2, 0.7, 0.2], "black_behind": True}},
        material_b={"kind": "mix", "material_a": {"kind": "metal", "color": [0.9, 0.6, 0.2], "roughness": 0.2},
                    "material_b": {"kind": "plastic", "color": [0.7, 0.1, 0.1]}, "factor": 0.25}))
    write("hosek-wilkie", scene=with_material(kind="plastic"), environment={
        "kind": "hosek-wilkie", "to_sun": [-1, 0.5, 1], "turbidity": 4.3, "ground_albedo": 0.6, "color": 5, "rotate": {"axis": [0, 1, 0], "angle_deg": 30}})
    for kind in ["spherical", "equal-area"]:
        write(f"camera-{kind}", scene=with_material(kind="diffuse") + [LAMP], camera={"kind": kind, "position": [0.5, 1.6, 2], "look_at": [0, 0.6, 0]})
    write("beckmann", scene=with_material(kind="principled", metallic=1, color=[0.9, 0.6, 0.3], edge_color=[1, 0.9, 0.8], roughness=0.4, anisotropy=0.5,
                                          beckmann=True, energy_compensation=False) + [
        LAMP, {"material": {"kind": "glass", "roughness": 0.3, "beckmann": True}, "sphere": {"center": [-1.1, 0.3, 0.8], "radius": 0.3}},
        {"material": {"kind": "plastic", "roughness": 0.3, "beckmann": True}, "sphere": {"center": [1.1, 0.3, 0.8], "radius": 0.3}},
        {"material": {"kind": "metal", "roughness": 0.3, "beckmann": True}, "sphere": {"center": [0.2, 0.2, 1.3], "radius": 0.2}}])
    write("glass", scene=with_material(kind="glass", ior=1.5))
    write("glass-rough", scene=with_material(kind="glass", ior=1.4, roughness=0.4, color=[0.6, 0.9, 0.8]))
    write("glass-absorbing", scene=with_material(kind="glass", attenuation_color=[0.2, 0.6, 0.9], attenuation_distance=0.5))
    write("glass-thin", scene=with_material(kind="glass", thin=True, color=[0.5, 0.8, 0.9], roughness=0.2))
    write("principled", scene=with_material(kind="principled", color=[0.7, 0.2, 0.1], roughness=0.3, ior=1.6) + [LAMP])
    write("principled-metal", scene=with_material(kind="principled", color=[0.7, 0.5, 0.1], roughness=0.5, metallic=0.7) + [LAMP])
    principled = {"kind": "principled", "color": [0.7, 0.3, 0.2], "roughness": 0.4}
    write("layers-sheen-coat", scene=with_material(
        **principled, sheen_color=[0.3, 0.4, 0.6], sheen_roughness={"texture": {"image": "channels.png"}, "channel": "g"}, coat=0.8,
        coat_roughness=0.15, coat_color=[0.9, 0.8, 0.7], coat_normal_map={"image": "bumps.png", "uv_scale": [4, 4]}, diffuse_roughness=0.5) +
        [LAMP])
    write("layers-film-anisotropy", scene=with_material(
        **principled, metallic=0.6, edge_color=[0.8, 0.9, 1], thin_film=0.8, thin_film_thickness=450, specular=0.7,
        specular_color=[1.5, 1, 0.5], anisotropy=0.8, anisotropy_rotation=30, anisotropy_map={"image": "bumps.png"},
        energy_compensation=False) + [LAMP])
    write("layers-solid", scene=with_material(
        **principled, transmission={"texture": {"image": "channels.png"}, "channel": "r", "value": 0.9}, transmission_color=[0.8, 0.9, 1],
        dispersion=4, attenuation_color=[0.5, 0.9, 0.7], attenuation_distance=1) + [LAMP])
    write("subsurface", scene=with_material(
        kind="principled", color=[0.2, 0.5, 0.3], roughness=0.3, subsurface={"texture": {"image": "channels.png"}, "channel": "r", "value": 0.9},
        subsurface_color=[0.9, 0.6, 0.4], subsurface_radius=0.1, subsurface_scatter_anisotropy=0.3) + [LAMP])
    write("cloudy-solids", scene=with_material(
        kind="glass", ior=1.33, attenuation_color=[0.3, 0.5, 0.2], attenuation_distance=0.2, transmission_scatter=[1.1, 0.6, 1.7],
        transmission_scatter_anisotropy=-0.4) + [
            {"material": {"kind": "principled", "transmission": 0.5, "subsurface": 1, "subsurface_color": [0.3, 0.8, 0.9],
                          "subsurface_radius": 0.05, "priority": 1, "attenuation_color": [0.9, 0.8, 0.7], "attenuation_distance": 0.3,
                          "transmission_scatter": 0.2},
             "sphere": {"center": [0.6, 0.5, 0.4], "radius": 0.5}}, LAMP])
    write("cloudy-solids-counted", scene=with_material(
        kind="glass", ior=1.33, attenuation_color=[0.3, 0.5, 0.2], attenuation_distance=0.4, transmission_scatter=[1.1, 0.6, 1.7],
        transmission_scatter_bounces=True) + [LAMP])
    write("layers-sheet", scene=wall(**principled, transmission=0.5, thin=True, diffuse_transmission=0.6,
                                     diffuse_transmission_color=[0.3, 0.9, 0.4]) + [{"sphere": {"center": [0, 0.6, -0.8], "radius": 0.5}}])
    write("single-sided", scene=[FLOOR, LAMP, BALL, {"material": {"color": [0.2, 0.3, 0.8], "single_sided": True}, "mesh": {
        "positions": [[-0.8, 0, 1], [1, 0, 1], [0, 1.3, 1], [0.4, 1.5, 1], [1.2, 1.6, 1], [0.8, 0.5, 1]], "indices": [[0, 2, 1], [3, 5, 4]]}}])
    write("unlit-and-emission", scene=with_material(color=0.2, emission=[0.4, 0.1, 0.2]) + [
        {"material": {"kind": "unlit", "color": [0.2, 0.8, 0.4]}, "disk": {"center": [1, 0.6, 0.6], "normal": [0, 0, 1], "radius": 0.4}},
        {"material": {"kind": "none", "emission": [1, 2, 3], "emission_two_sided": True},
         "rectangle": {"corner": [-1.4, 0.2, 0.5], "edge_u": [0, 0, 0.5], "edge_v": [0, 0.7, 0]}}])
    write("alpha", scene=[FLOOR, LAMP] + [
        {"material": {"color": [0.2, 0.5, 0.9], "alpha": {"texture": {"image": "channels.png"}}, "alpha_mode": mode,
                      "alpha_cutoff": 0.6},
         "rectangle": {"corner": [x, 0.1, 0.5], "edge_u": [1.1, 0, 0], "edge_v": [0, 1.2, 0.1]}}
        for mode, x in (("blend", -1.2), ("mask", 0.1))] + [
        {"material": {"color": 0.9, "alpha": 0.4}, "sphere": {"center": [0, 1.5, -1], "radius": 0.5}}])


def textures():
    write("image-textures", scene=wall(color={"texture": {
        "image": "bands.png", "wrap_u": "mirror", "wrap_v": "clamp", "uv_scale": [2, 1.5], "uv_offset": [0.1, -0.3],
        "uv_rotation_deg": 20}, "value": [0.9, 0.8, 0.7]}))
    write("nearest-16-bits", scene=wall(color={"texture": {"image": "wide.png", "lookup": "nearest", "uv_scale": [1.7, 2.3]}}))
    write("channels", scene=wall(kind="principled", color=[0.8, 0.6, 0.4],
                                 roughness={"texture": {"image": "channels.png", "uv_scale": [2, 2]}, "channel": "b", "value": 0.9},
                                 metallic={"texture": {"image": "channels.png"}, "channel": "r"}) + [LAMP])
    write("normal-map", scene=wall(kind="principled", color=0.7, roughness=0.4, normal_map={"image": "bumps.png", "uv_scale": [3, 2]},
                                   normal_scale=0.8) + [LAMP])
    for name, more in (("checker_uv", {"scale": 5}), ("checker_space", {"scale": 4}), ("noise", {"scale": 3}),
                       ("turbulence", {"scale": 2, "octaves": 4}), ("marble", {"scale": 3, "octaves": 5, "turbulence_weight": 4})):
        texture = {"kind": name, "color_a": [0.1, 0.2, 0.6], "color_b": [0.9, 0.8, 0.3], **more}
        write(name.replace("_", "-"), scene=[FLOOR, {**BALL, "material": {"color": {"texture": texture}}},
                                             {"material": {"color": {"texture": texture}}, "disk": {"center": [1.2, 0.6, 0], "normal": [-0.3, 0, 1], "radius": 0.5}}])
    write("fractals", scene=[
        FLOOR, {**BALL, "material": {"color": {"texture": {"kind": "veined_marble", "scale": 6, "turbulence_weight": 3, "octaves": 6}}}},
        {"material": {"color": {"texture": {"kind": "wrinkled", "scale": 4, "gain": 0.6, "octaves": 5, "transform": {"translate": [0.3, 0.2, 0.1]}}}},
         "disk": {"center": [1.2, 0.6, 0], "normal": [-0.3, 0, 1], "radius": 0.5}},
        {"material": {"color": {"texture": {"kind": "clamp", "input": {"texture": {
            "kind": "fbm", "scale": 5, "color_a": [0.5, 0.4, 0.3], "color_b": [1.4, 0.2, 0.1],
            "transform": {"scale": [1, 4, 1], "rotate": {"axis": [0, 0, 1], "angle_deg": 30}}}}}}},
         "box": {"min": [-1.9, 0, -0.5], "max": [-1.1, 0.9, 0.2]}},
        {"material": {"color": {"texture": {"kind": "windy", "scale": 9, "color_a": 0.5, "color_b": 2}}},
         "rectangle": {"corner": [-2, 1.2, -0.6], "edge_u": [1, 0, 0], "edge_v": [0, 0.8, 0]}}])
    by_place = {"transform": {"translate": [-0.1, 0.5, 0.2], "rotate": {"axis": [1, 0, 0], "angle_deg": -60}}}
    write("mappings", scene=[
        FLOOR, {**BALL, "material": {"color": {"texture": {"image": "bands.png", "mapping": "spherical", "uv_scale": [3, 2], **by_place}}}},
        {"material": {"color": {"texture": {"kind": "dots", "scale": 6, "mapping": "planar", "color_a": {"texture": {"kind": "coordinates"}},
                                            "color_b": [0.9, 0.1, 0.1], **by_place}}}, "disk": {"center": [1.2, 0.6, 0], "normal": [-0.3, 0, 1], "radius": 0.5}},
        {"material": {"color": {"texture": {"kind": "uv_transform", "mapping": "cylindrical", "input": {"texture": {"kind": "checker_uv", "scale": 6}}, **by_place}}},
         "box": {"min": [-1.9, 0, -0.5], "max": [-1.1, 0.9, 0.2]}},
        {"material": {"color": {"texture": {"kind": "invert", "input": {"texture": {
            "kind": "facing", "direction": [0, 1, 1], "color_a": [0.9, 0.2, 0.1], "color_b": [0.1, 0.3, 1.5]}}}}},
         "sphere": {"center": [1.1, 1.5, -0.3], "radius": 0.35}}])
    write("image-edges", scene=[
        {"material": {"color": {"texture": {"image": "bands.png", "wrap_u": "black", "wrap_v": "repeat", "uv_scale": [2, 2], "uv_offset": [-0.5, 0]}}},
         "rectangle": {"corner": [-2, 0, 0], "edge_u": [2, 0, 0], "edge_v": [0, 2, 0]}},
        {"material": {"color": {"texture": {"image": "bands.png", "wrap_u": "octahedral", "wrap_v": "octahedral", "lookup": "nearest",
                                            "uv_scale": [2, 2], "uv_offset": [-0.5, -0.5]}}},
         "rectangle": {"corner": [0, 0, 0], "edge_u": [2, 0, 0], "edge_v": [0, 2, 0]}}])
    # Bump maps are applied to every shape with tangents, by 3D textures and by images in both sets of texture
    # coordinates.
    fbm, picture = {"kind": "fbm", "scale": 5, "octaves": 4}, {"image": "bands.png", "uv_scale": [2, 2]}
    write("bump", scene=[
        FLOOR, LAMP, {**BALL, "material": {"color": 0.7, "bump": {"texture": fbm, "value": 0.06}}},
        {"children": [{"material": {"color": 0.7, "bump": {"texture": picture, "value": 0.05, "channel": "g"}},
                       "box": {"min": [-1, 0, -0.5], "max": [0, 1, 0.5]}}], "transform": {"scale": [0.8, 1, 0.6], "translate": [-1, 0, 0]}},
        {"material": {"kind": "principled", "roughness": 0.3, "bump": {"texture": picture, "value": 0.04}},
         "disk": {"center": [1.2, 0.6, 0], "normal": [-0.3, 0, 1], "radius": 0.5}},
        {"mesh": {"positions": [[-0.9, 1.1, -0.6], [1, 1.1, -0.9], [0, 2.2, -0.5]], "uvs": [[0, 0]] * 3, "uvs_1": [[0, 1], [1, 1], [0.5, 0]],
                  "normals": [[-0.3, 0, 1], [0.3, 0, 1], [0, 0.3, 1]]},
         "material": {"color": 0.6, "bump": {"texture": {**picture, "uv_set": 1}, "value": -0.1}}}])
    # Displacement is applied to a sphere with a seam, a box with hard edges and a mesh, by a small image and by 3D
    # textures.
    raised = {"color": 0.7, "displacement": {"texture": {"image": "bands.png", "uv_scale": [2, 1]}, "value": 0.2}}
    write("displacement", scene=[
        FLOOR, LAMP, {**BALL, "material": raised},
        {"box": {"min": [0.8, 0, -0.4], "max": [1.6, 0.8, 0.4]}, "material": {**raised, "displacement_midlevel": 0.5, "kind": "principled"}},
        {"mesh": {"positions": [[-1.8, 0, 0.5], [-0.6, 0, 0.9], [-1.1, 1.2, 0.3]], "uvs": [[0, 1], [1, 1], [0.5, 0]]}, "material": {
            "color": [0.7, 0.4, 0.2], "displacement_edge_length": 0.1,
            "displacement": {"texture": {"kind": "noise", "scale": 6, "color_a": 0, "color_b": 1}, "value": 0.15}}}])
    quad = {"positions": [[-1, 0, 0], [1, 0, 0.3], [0.8, 1.5, 0], [-0.8, 1.4, 0.2]], "indices": [[0, 1, 2], [0, 2, 3]],
            "normals": [[-0.3, 0, 1], [0.3, 0, 1], [0.2, 0.3, 1], [-0.2, 0.3, 1]], "uvs": [[0, 1], [1, 1], [1, 0], [0, 0]],
            "uvs_1": [[0, 0.5], [2, 0.5], [2, 0], [0, 0]], "colors": [[1, 1, 0.5, 1], [1, 0.5, 1, 1], [0.5, 1, 1, 1], [1, 1, 1, 1]],
            "tangents": [[1, 0, 0, -1]] * 4}
    write("mesh-attributes", scene=[FLOOR, LAMP, {"mesh": quad, "material": {
        "color": {"texture": {"image": "bands.png", "uv_set": 1}}, "normal_map": {"image": "bumps.png"}, "use_vertex_color": True}}])


def hundreds_of_lamps():
    """A light tree of several levels: triangles of all orientations, spheres, disks, spots, points and a sun."""
    def place(i):
        return [2.6 * math.sin(2.4 * i), 0.3 + 2.4 * ((0.618 * i) % 1), 2.6 * math.cos(1.7 * i) - 0.5]

    def triangles(numbers):
        mesh = {"positions": [], "indices": []}
        for i in numbers:
            x, y, z = place(i)
            size, first = 0.03 + 0.1 * ((0.37 * i) % 1), len(mesh["positions"])
            mesh["indices"].append([first, first + 1, first + 2])
            for k in range(3):
                a, b = i + 2.1 * k, 0.7 * i + 2.1 * k
                corner = (x + size * math.sin(a), y + size * math.cos(a), z + size * math.sin(b))
                mesh["positions"].append([round(v, 4) for v in corner])
        return mesh
    rounded = lambda i: [round(v, 4) for v in place(i)]
    lamp = lambda i, **shape: {"material": {"kind": "none", "emission": [3 + i % 4, 4, 6 - i % 4], "emission_two_sided": i % 2 == 0}, **shape}
    write("hundreds-of-lamps", environment=None, scene=[
        FLOOR, {**BALL, "material": {"color": 0.7}}, lamp(1, mesh=triangles(range(70))), lamp(2, mesh=triangles(range(70, 140))),
        *(lamp(i, sphere={"center": rounded(i), "radius": 0.02 + 0.005 * (i % 5)}) for i in range(200, 220)),
        *(lamp(i, disk={"center": rounded(i), "normal": [math.sin(i), -1, 0.5], "radius": 0.05}) for i in range(300, 312))],
        lights={**{f"spot {i}": {"kind": "spot", "position": rounded(i), "direction": [math.sin(i), -1, 0.2], "intensity": 1 + i % 3,
                                 "inner_angle_deg": 5, "outer_angle_deg": 10 + 7 * (i % 9)} for i in range(400, 412)},
                **{f"point {i}": {"kind": "point", "position": rounded(i), "intensity": 0.3} for i in range(500, 508)},
                "sun": {"kind": "directional", "direction": [-1, -2, -0.5], "intensity": 0.5}})


def moving_lamps():
    """Moving lights: all shapes in nodes that translate, rotate, scale and shear, moving vertices, a point and spots."""
    def lamp(i, motion=None, **shape):
        return {"material": {"kind": "none", "emission": [6 - i % 3, 5, 3 + i % 3], "emission_two_sided": i % 2 == 0}, **shape,
                **({"motion": motion} if motion else {})}

    def way(i, end):
        start = [-1.5 + 0.6 * i, 1.6 + 0.1 * i, 0.4]
        return [{"time": 0, "transform": {"translate": start}},
                {"time": 0.3, "transform": {"translate": [start[0] + 0.3, start[1], start[2]], **end}},
                {"time": 1, "transform": {"translate": [start[0] + 0.2, start[1] + 0.5, 0], **end}}]
    turned, grown, sheared = {"rotate": {"axis": [0, 1, 1], "angle_deg": 80}}, {"scale": 1.6}, {"scale": [1.5, 0.7, 1]}
    triangle = {"positions": [[-0.3, 0, 0.2], [0.3, 0, 0.2], [0, 0.1, -0.3]], "indices": [[0, 2, 1]]}
    keys = [{"time": t, "positions": [[x + 0.5 * t - 0.9, y + 0.7, z + t * t] for x, y, z in triangle["positions"]]} for t in (0, 0.6, 1)]
    write("moving-lamps", environment=None, camera={**CAMERA, "shutter": [0, 1]}, scene=[
        FLOOR, {**BALL, "material": {"color": 0.7}},
        lamp(0, way(0, turned), mesh=triangle), lamp(1, way(1, sheared), mesh=triangle),
        lamp(2, way(2, grown), rectangle={"corner": [-0.2, 0, -0.2], "edge_u": [0.4, 0, 0], "edge_v": [0, 0, 0.4]}),
        lamp(3, way(3, turned), disk={"center": [0, 0, 0], "normal": [0, -1, 0], "radius": 0.2}),
        lamp(4, way(4, grown), sphere={"center": [0, 0.2, 0], "radius": 0.1}),
        lamp(5, way(5, sheared), box={"min": [0, 0, 0], "max": [0.2, 0.1, 0.1]}), lamp(6, mesh={**triangle, "motion": keys}),
        {"motion": way(1, turned), "light": "spot"}, {"motion": way(3, sheared), "light": "point"}],
        lights={"spot": {"kind": "spot", "intensity": 4, "outer_angle_deg": 40}, "point": {"kind": "point", "intensity": 1}})


def image_lights():
    """Image lights: projectors, goniometric maps, an IES profile and a spot, in static, moving and mirroring nodes."""
    (FOLDER / "lamp.ies").write_text("IESNA:LM-63-2002\n[TEST] made up\nTILT=NONE\n1 1000 1\n5 3 1 1 0.1 0.1 0.1\n1 1 60\n0 20 45 90 110\n0 45 90\n"
                                     "3 2.8 1 0.2 0\n3 2.5 1.6 0.3 0.1\n3 1 0.4 0.2 0\n")
    down = {"rotate": {"axis": [1, 0, 0], "angle_deg": -80}}
    at = lambda x, y, z, **more: {"transform": [*([more] if more else []), down, {"translate": [x, y, z]}]}
    write("pictured-lights", environment=None, camera={**CAMERA, "shutter": [0, 1]}, scene=[
        FLOOR, {**BALL, "material": {"color": 0.7}}, {"light": "window", **at(-1, 1.8, 0.6)}, {"light": "screen", **at(1, 1.6, 0.8, scale=[-1, 1, 1])},
        {"light": "map", **at(0.3, 2, -0.9)}, {"light": "nearest", **at(-1.2, 0.6, -0.3)}, {"light": "lamp", **at(0.9, 1.5, -0.4)},
        {"light": "spot", "motion": [{"time": 0, "transform": [{"rotate": {"axis": [1, 0, 0], "angle_deg": -40}}, {"translate": [-0.6, 1.5, 1.5]}]},
                                     {"time": 1, "transform": [{"rotate": {"axis": [1, 0, 0.5], "angle_deg": -60}}, {"translate": [-0.2, 1.7, 1.4]}]}]}],
        lights={"window": {"kind": "projector", "image": "bands.png", "intensity": 4, "fov_deg": 40},
                "screen": {"kind": "projector", "image": "channels.png", "color_space": "linear", "intensity": 2, "unit": "lm", "flat_field": True,
                           "fov_deg": 50, "fov_axis": "diagonal"},
                "map": {"kind": "goniometric", "image": "bumps.png", "color": [0.5, 0.4, 0.8]},
                "nearest": {"kind": "goniometric", "image": "channels.png", "lookup": "nearest", "intensity": 0.4},
                "lamp": {"kind": "goniometric", "image": "lamp.ies", "color": [0.7, 0.6, 0.4]},
                "spot": {"kind": "spot", "image": "channels.png", "intensity": 5, "outer_angle_deg": 35}})


def beams():
    """Beams from rectangles and ellipses, also in fog, in static, stretching and moving nodes."""
    down = {"rotate": {"axis": [1, 0, 0.2], "angle_deg": -70}}
    write("beams", environment=None, camera={**CAMERA, "shutter": [0, 1]}, scene=[
        FLOOR, {**BALL, "material": {"color": 0.7}},
        {"sphere": {"center": [1.1, 0.6, 0.3], "radius": 0.5},
         "material": {"kind": "glass", "ior": 1, "attenuation_distance": 1, "attenuation_color": 0.3, "transmission_scatter": [0.9, 1, 1.1]}},
        {"light": "panel"}, {"light": "laser"}, {"light": "oval", "transform": [{"scale": [1, 1.4, 1]}, down, {"translate": [-0.6, 2, 0.5]}]},
        {"light": "oval", "motion": [{"time": 0, "transform": [down, {"translate": [-1.6, 2, 1]}]},
                                     {"time": 1, "transform": [down, {"translate": [-1.2, 2, 1.4]}]}]}],
        lights={"panel": {"kind": "beam", "position": [0.2, 2.2, 0], "direction": [-0.2, -1, -0.1], "width": 0.8, "height": 0.5, "intensity": 3},
                "laser": {"kind": "beam", "position": [2.4, 0.7, 0.3], "direction": [-1, 0, 0], "width": 0.05, "height": 0.05, "round": True,
                          "color": [1, 0.1, 0.1], "intensity": 40},
                "oval": {"kind": "beam", "width": 0.7, "height": 0.3, "round": True, "color": [0.3, 0.5, 1], "intensity": 4}})


def tubes():
    """Tubes near a floor and a ball, in fog, and in static, stretching and moving nodes."""
    write("tubes", environment=None, camera={**CAMERA, "shutter": [0, 1]}, scene=[
        FLOOR, {**BALL, "material": {"color": 0.7}},
        {"sphere": {"center": [1.1, 0.6, 0.3], "radius": 0.5},
         "material": {"kind": "glass", "ior": 1, "attenuation_distance": 1, "attenuation_color": 0.3, "transmission_scatter": [0.9, 1, 1.1]}},
        {"light": "ceiling"}, {"light": "thick", "transform": [{"scale": [1, 1.4, 1.2]}, {"translate": [-1.3, 0.5, 0.5]}]},
        {"light": "rod", "motion": [{"time": 0, "transform": {"translate": [0.3, 0.1, 1.2]}},
                                    {"time": 1, "transform": [{"scale": [1, 1, 2]}, {"rotate": {"axis": [0, 1, 0], "angle_deg": 50}},
                                                              {"translate": [0.6, 0.3, 1.2]}]}]}],
        lights={"ceiling": {"kind": "tube", "position": [0, 2.2, 0], "direction": [1, 0, 0.2], "length": 1.5, "intensity": 60, "unit": "lm"},
                "thick": {"kind": "tube", "direction": [0, 1, 0.2], "length": 0.4, "radius": 0.15, "color": [0.3, 0.5, 1], "intensity": 2},
                "rod": {"kind": "tube", "length": 0.3, "radius": 0.02, "color": [1, 0.4, 0.2], "intensity": 8}})


def emissive_curves():
    """Emissive curves, round and ribbons, linear and cubic, in world space, instanced twice, and in a moving node."""
    points = lambda z: [[round(0.9 * math.sin(1.3 * i), 4), 1.2 + 0.2 * i, z + round(0.3 * math.cos(1.3 * i), 4), 0.02 + 0.01 * (i % 3)]
                        for i in range(7)]
    curves = lambda z, basis, style: {"curves": [points(z), points(z - 0.4)], "basis": basis, "style": style}
    emit = {"kind": "none", "emission": {"texture": {"kind": "checker_uv", "scale": 6, "color_a": [3, 2, 1], "color_b": [6, 6, 9]}}}
    write("glowing-curves", environment=None, camera={**CAMERA, "shutter": [0, 1]}, scene=[
        FLOOR, {**BALL, "material": {"color": 0.7}},
        {"material": emit, "curves": curves(0.6, "bspline", "round")}, {"material": emit, "curves": curves(-0.4, "linear", "ribbon")},
        *({"material": emit, "curves": "placed", "transform": {"translate": [x, 0, 0], "scale": 0.7}} for x in (-1, 1)),
        {"material": emit, "curves": curves(0.2, "linear", "round"),
         "motion": [{"time": 0, "transform": {"translate": [-1, 0, 0]}},
                    {"time": 1, "transform": {"translate": [-0.6, 0.2, 0], "rotate": {"axis": [0, 1, 0], "angle_deg": 50}}}]}],
        curves={"placed": curves(0, "bezier", "ribbon")})


def hair():
    """Hair with each color parameter, round and ribbons, on curves and on a sphere, with a texture and a backlight."""
    points = lambda z: [[0.25 * k - 0.9, 0.5 + 0.25 * (k % 3), z + 0.1 * (k % 2), 0.05 - 0.004 * k] for k in range(8)]
    curves = lambda z, style: {"curves": [points(z), points(z - 0.2)], "style": style}
    write("hair", scene=[
        {"material": {"kind": "hair", "eumelanin": 0.4, "pheomelanin": 0.3}, "curves": curves(0.6, "round")},
        {"material": {"kind": "hair", "color": [0.9, 0.6, 0.4], "beta_m": 0.15, "beta_n": 0.2, "scale_tilt": 4}, "curves": curves(0, "ribbon")},
        {"material": {"kind": "hair", "absorption": {"texture": {"image": "bands.png"}, "value": [0.3, 0.6, 1.2]}, "ior": 1.4}, "curves": "placed",
         "transform": {"translate": [0.2, 0.2, -0.6], "rotate": {"axis": [0, 1, 0], "angle_deg": 30}, "scale": 0.8}},
        {"material": {"kind": "hair", "color": [0.7, 0.7, 0.9], "beta_m": 0.6}, "sphere": {"center": [0.9, 0.3, -0.4], "radius": 0.3}},
        LAMP], curves={"placed": curves(0, "round")})


def measured():
    """An isotropic and a brushed measured metal: bump-mapped, two-sided and mixed, under a light and a sky."""
    (FOLDER / "gold.bsdf").write_bytes(measured_file.gold())
    (FOLDER / "brushed.bsdf").write_bytes(measured_file.brushed())
    gold, brushed = {"kind": "measured", "file": "gold.bsdf"}, {"kind": "measured", "file": "brushed.bsdf"}
    ball = lambda x, z, r, **keys: {"material": keys, "sphere": {"center": [x, r, z], "radius": r}}
    sheet = lambda x, y, z, u, **keys: {"material": keys, "rectangle": {"corner": [x, y, z], "edge_u": u, "edge_v": [0, 0.7, 0.1]}}
    write("measured", scene=[
        FLOOR, LAMP, ball(-0.8, 0, 0.55, **gold), ball(0.45, 0, 0.55, **brushed),
        ball(-0.2, 0.9, 0.25, **gold, bump={"texture": {"image": "bumps.png"}, "value": 0.02}),
        sheet(-1.5, 0, -0.8, [1, 0, 0], kind="two_sided", front=brushed, back=gold),
        sheet(1.6, 0, -0.8, [-1, 0, 0], kind="two_sided", front=gold, back=brushed),
        ball(1.1, 0.7, 0.3, kind="mix", material_a=brushed, material_b={"color": [0.1, 0.2, 0.6]})])


def disney():
    """Disney materials: opaque, brushed metal, coated, nested solids and a thin sheet, with textured parameters."""
    ball = lambda x, z, r, **keys: {"material": {"kind": "disney", **keys}, "sphere": {"center": [x, r, z], "radius": r}}
    bands = lambda value: {"texture": {"image": "bands.png", "color_space": "linear"}, "value": value}
    write("disney", scene=[
        FLOOR, LAMP, ball(-1, 0.2, 0.35, color=[0.7, 0.3, 0.2], roughness=0.6, sheen=0.8, sheen_tint=0.5, flatness=bands(0.9)),
        ball(-0.3, -0.5, 0.4, color=[0.9, 0.7, 0.4], metallic=bands(1), roughness=0.4, anisotropy=0.8, specular_tint=0.5),
        ball(0.5, 0.1, 0.4, color=[0.8, 0.9, 0.9], transmission=0.9, roughness=0.2, ior=1.4, attenuation_color=[0.5, 0.9, 0.6], attenuation_distance=0.5),
        ball(0.5, 0.1, 0.15, color=[0.2, 0.3, 0.8], coat=1, coat_gloss=0.4, roughness=0.7),
        {"material": {"kind": "disney", "thin": True, "color": [0.6, 0.8, 0.4], "diffuse_transmission": 0.4, "transmission": bands(0.5), "roughness": 0.3},
         "rectangle": {"corner": [0.9, 0, -0.6], "edge_u": [0.4, 0, 0.5], "edge_v": [0, 0.9, 0]}}])


def adjacent_features():
    """Adjacent spheres with different features, because lanes must not change each other's bits."""
    parts = [{}, {"sheen_color": 0.5}, {"coat": 0.7, "coat_roughness": 0.2}, {"thin_film": 0.8}, {"diffuse_roughness": 0.6}, {"anisotropy": 0.7},
             {"specular": 0.5}, {"conductor": "copper"}, {"two_roughnesses": True, "anisotropy": 0.3}, {"sheen_color": 0.4, "sheen_reciprocal": True},
             {"specular": 0.5, "energy_compensation": False}, {"specular": 0.6, "beckmann": True}, {"specular": 0.6, "separable_shadowing": True},
             {"transmission": 0.6}, {"diffuse_transmission": 0.5}, {"transmission": 0.5, "dispersion": 2}, {"subsurface": 0.6},
             {"diffuse_transmission": 0.3, "diffuse_transmission_added": True, "color": 0.5, "diffuse_transmission_color": 0.3},
             {"coat": {"texture": {"kind": "checker_uv", "scale": 5, "color_a": 0.1, "color_b": 0.9}}},
             {"kind": "disney"}, {"kind": "disney", "anisotropy": 0.6, "coat": 0.5}, {"kind": "disney", "transmission": 0.6},
             {"kind": "disney", "thin": True, "transmission": 0.6, "diffuse_transmission": 0.3}]
    write("neighbours", scene=[FLOOR, LAMP, *(
        {"material": {"kind": "principled", **({} if "conductor" in part else {"color": [0.7, 0.5, 0.3]}), "roughness": 0.4, **part},
         "sphere": {"center": [round(0.4 * (i % 6) - 1, 3), 0.2, round(0.4 * (i // 6) - 0.8, 3)], "radius": 0.19}} for i, part in enumerate(parts))])


def seen_through():
    """Fog, a sphere of fog inside thin glass, a colored pane, and lights in and behind them."""
    fog = {"kind": "glass", "attenuation_distance": 0.5, "attenuation_color": [0.5, 0.4, 0.3], "transmission_scatter": 0.6}
    lamp = {"kind": "none", "emission": [9, 8, 7]}
    write("seen-through", scene=[
        FLOOR, LAMP, {"material": {**fog, "ior": 1, "transmission_scatter_anisotropy": 0.4}, "box": {"min": [-2, 0, -1.5], "max": [2, 0.4, 1]}},
        {"material": {**fog, "ior": 1.4, "thin": True}, "sphere": {"center": [-0.6, 0.9, 0], "radius": 0.4}},
        {"material": lamp, "sphere": {"center": [-0.6, 0.9, 0], "radius": 0.1}},
        {"material": {"color": [0.3, 0.5, 0.7]}, "sphere": {"center": [0.6, 0.4, -0.2], "radius": 0.3}},
        {"material": {"kind": "glass", "thin": True, "color": [0.8, 0.9, 0.5]}, "rectangle": {"corner": [0.2, 0, 0.6], "edge_u": [1, 0, 0.3], "edge_v": [0, 1, 0]}}])


def moving_curves():
    """Moving control points and radii: hair with an additional key, glass, a light, and one in a moving node."""
    def keys(points, way, times=(0, 0.4, 1)):
        move = lambda p, t: [round(p[0] + way[0] * t, 4), round(p[1] + way[1] * t * t, 4), round(p[2] + way[2] * t, 4), round(p[3] * (1 + 0.5 * t), 4)]
        return [{"time": t, "curves": [[move(p, t) for p in curve] for curve in points]} for t in times]

    def curves(z, basis, style, way, n=2):
        points = [[[round(0.9 * math.sin(1.3 * i), 4), 0.4 + 0.2 * i, round(z - 0.3 * k + 0.3 * math.cos(1.3 * i), 4), 0.03 + 0.01 * (i % 3)]
                   for i in range(7)] for k in range(n)]
        return {"curves": points, "basis": basis, "style": style, "motion": keys(points, way)}
    write("moving-curves", camera={**CAMERA, "shutter": [0.1, 0.9]}, scene=[
        FLOOR, LAMP, {"material": {"color": [0.5, 0.3, 0.1]}, "curves": curves(0.6, "catmull-rom", "ribbon", [0.4, 0.2, 0], 5)},
        {"material": {"kind": "glass"}, "curves": curves(0, "bspline", "round", [-0.5, 0.3, 0.2])},
        {"material": {"kind": "none", "emission": [9, 7, 4]}, "curves": curves(-0.6, "linear", "round", [0.3, -0.2, 0.4], 1)},
        {"material": {"color": 0.8}, "curves": curves(0.2, "bezier", "round", [0, 0.6, 0]),
         "motion": [{"time": 0, "transform": {"translate": [1, 0, 0]}},
                    {"time": 1, "transform": {"translate": [1.3, 0, 0], "rotate": {"axis": [0, 1, 0], "angle_deg": 40}}}]}])


def lights():
    def lit(name, nodes=(), lights=None, **more):
        write(name, scene=[FLOOR, {**BALL, "material": {"color": 0.7}}, *nodes], environment=None, lights=lights or {}, **more)
    lit("point", lights={"l": {"kind": "point", "position": [1, 2, 1.5], "intensity": 8, "color": [1, 0.7, 0.4]}})
    lit("spot", lights={"l": {"kind": "spot", "position": [1, 3, 1.5], "direction": [-0.3, -1, -0.4], "intensity": 20,
                              "inner_angle_deg": 8, "outer_angle_deg": 25}})
    lit("suns", lights={"a": {"kind": "directional", "direction": [-1, -2, -0.5], "intensity": 2},
                        "b": {"kind": "directional", "direction": [1, -1, 0], "intensity": 1, "angle_deg": 20, "color": [0.4, 0.6, 1]}})
    emit = {"kind": "none", "emission": [5, 4, 3]}
    lit("lamp-rectangle", [LAMP])
    lit("lamp-parallelogram", [{"material": {**emit, "emission_two_sided": True},
                                "rectangle": {"corner": [-1, 2, 0], "edge_u": [1, 0.2, 0.5], "edge_v": [0.4, 0.3, 1]}}])
    lit("lamp-triangles", [{"material": emit, "mesh": {"positions": [[-1, 2.2, -1], [1, 2, -0.5], [0, 2.4, 1], [1.2, 1.5, 1]],
                                                       "indices": [[0, 1, 2], [1, 3, 2]]}}])
    lit("lamp-disk", [{"material": emit, "disk": {"center": [0.5, 2.2, 0.5], "normal": [-0.2, -1, -0.1], "radius": 0.7}}])
    lit("lamp-sphere", [{"material": emit, "sphere": {"center": [1, 2, 0.8], "radius": 0.4}}])
    lit("lamp-textured", [{"material": {"kind": "none", "emission": {"texture": {"image": "bands.png"}, "value": [6, 6, 6]}},
                           "rectangle": {"corner": [-1, 2.5, -1], "edge_u": [2, 0, 0], "edge_v": [0, 0, 2]}}])
    lit("many-lamps", [{"material": {"kind": "none", "emission": [2 + i % 3, 3, 5 - i % 4]},
                        "sphere": {"center": [0.4 * i - 2.2, 1.8 + 0.1 * (i % 4), 0.3 * (i % 5) - 0.5], "radius": 0.06 + 0.01 * (i % 3)}}
                       for i in range(12)], {"p": {"kind": "point", "position": [0, 2.5, 2], "intensity": 2}})
    hundreds_of_lamps()
    moving_lamps()
    image_lights()
    beams()
    tubes()
    emissive_curves()
    hair()
    measured()
    disney()
    adjacent_features()
    seen_through()
    moving_curves()
    write("fibres", scene=[FLOOR, LAMP, *({"material": {"kind": "glass", "attenuation_color": [0.4, 0.8, 0.6], "attenuation_distance": 0.3}, "curves": {
        "basis": basis, "curves": [[[0.25 * k - 1.5 + 0.3 * math.sin(k), 0.3 * (k % 4) + y, z, 0.08 + 0.03 * (k % 2)] for k in range(10)]]}}
        for basis, y, z in (("linear", 0.3, 0.8), ("bspline", 0.8, 0)))])
    write("sky-constant", scene=with_material(color=0.7), environment={"kind": "constant", "color": [0.5, 0.7, 0.9]})
    write("sky-gradient", scene=with_material(color=0.7),
          environment={**SKY, "rotate": {"axis": [1, 0, 0.5], "angle_deg": 50}})
    write("sky-image", scene=with_material(kind="principled", color=0.7, roughness=0.3),
          environment={"kind": "image", "image": "sky.hdr", "color": [0.9, 1, 1.1], "rotate": {"axis": [0.2, 1, 0], "angle_deg": 70}})
    write("sky-studio", scene=with_material(color=0.7),
          environment={"kind": "studio", "color": [1, 0.9, 0.8], "rotate": {"axis": [0, 1, 0], "angle_deg": 40}})
    write("sky-sun", scene=with_material(color=0.7),
          environment={"kind": "sky", "to_sun": [0.8, 0.5, 0.3], "color": [1, 0.9, 1.1], "rotate": {"axis": [0, 1, 0], "angle_deg": 20}})


def shapes():
    grey, red, green = {"color": 0.7}, {"color": [0.7, 0.1, 0.1]}, {"color": [0.1, 0.6, 0.2]}
    def face(corner, u, v, material):
        return {"material": material, "rectangle": {"corner": corner, "edge_u": u, "edge_v": v}}
    write("room", environment=None, camera={"position": [0, 1, 3.4], "look_at": [0, 1, 0], "fov_y_deg": 40}, scene=[
        face([-1, 0, 1], [2, 0, 0], [0, 0, -2], grey), face([-1, 2, 1], [0, 0, -2], [2, 0, 0], grey),
        face([-1, 0, -1], [2, 0, 0], [0, 2, 0], grey), face([-1, 0, 1], [0, 0, -2], [0, 2, 0], red),
        face([1, 0, 1], [0, 2, 0], [0, 0, -2], green),
        face([-0.3, 1.99, -0.3], [0.6, 0, 0], [0, 0, 0.6], {"kind": "none", "emission": 12}),
        {"material": grey, "box": {"min": [-0.3, 0, -0.3], "max": [0.3, 0.6, 0.3]},
         "transform": {"rotate": {"axis": [0, 1, 0], "angle_deg": 20}, "translate": [0.35, 0, 0.3]}},
        {"material": grey, "box": {"min": [-0.7, 0, -0.6], "max": [-0.2, 1.1, -0.1]}}])
    write("solids", scene=[FLOOR, LAMP, {"material": red, "box": {"min": [-1.4, 0, -0.3], "max": [-0.7, 0.9, 0.4]}},
                           {"material": green, "disk": {"center": [1.1, 0.5, 0.2], "normal": [-0.5, 0.2, 1], "radius": 0.5}},
                           {"material": grey, "sphere": {"center": [0, 0.5, 0], "radius": -0.5}},
                           {"material": grey, "sphere": {}, "transform": {"scale": [0.6, 0.2, 0.3], "translate": [0.2, 1.3, 0]}}])
    for basis, count in (("linear", 4), ("bezier", 7), ("bspline", 6), ("catmull-rom", 6)):
        nodes = [FLOOR, LAMP]
        for k, style in enumerate(("round", "ribbon")):
            curves = [[[0.25 * j - 0.8 + 0.8 * k, 0.15 + 0.25 * i + 0.1 * j, 0.4 * math.sin(i + j), 0.03 + 0.012 * (i % 3)]
                       for i in range(count)] for j in range(3)]
            nodes.append({"material": [red, green][k], "curves": {"basis": basis, "style": style, "curves": curves}})
        write(f"curves-{basis}", scene=nodes)
    write("points", scene=[FLOOR, LAMP, {"material": red, "points": {"points": [
        [0.9 * math.sin(2.4 * i), 0.2 + 0.03 * i, 0.9 * math.cos(2.4 * i), 0.08 + 0.02 * (i % 3)] for i in range(40)]}},
        {"material": {"kind": "none", "emission": 3}, "points": {"points": [[0, 0.4, 0], [0.4, 1.5, 0.4]], "radius": 0.1}}])
    write("instances", nodes={
        "tuft": {"material": green, "curves": {"radius": 0.06, "curves": [
            [[0.1 * i, 0, 0], [0.1 * i, 0.3, 0.1], [0.1 * i + 0.1, 0.5, 0.1], [0.1 * i + 0.1, 0.8, 0.3]] for i in range(3)]}},
        "cluster": {"children": ["tuft", {"instance": "tuft", "transform": {"scale": [-1, 1.2, 1], "translate": [-0.2, 0, 0.4]}}]}},
        scene=[FLOOR, LAMP, "cluster", {"instance": "cluster", "transform": {"rotate": {"axis": [0, 1, 0], "angle_deg": 70},
                                                                             "translate": [0.9, 0, 0]}},
               {"instance": "cluster", "transform": {"matrix": [[0.8, 0.3, 0, -0.9], [0, 1.1, 0.2, 0], [0.1, 0, 0.7, 0.3]]}}])


def cameras_and_motion():
    things = [FLOOR, LAMP] + [{"material": {"color": [0.2 + 0.2 * i, 0.6, 0.8 - 0.2 * i]},
                               "sphere": {"center": [0.8 * i - 1.2, 0.4, 0.8 - 0.9 * i], "radius": 0.4}} for i in range(4)]
    write("camera-orthographic", scene=things, camera={"kind": "orthographic", "position": [1, 2, 4], "look_at": [0, 0.5, 0],
                                                       "up": [0.3, 1, 0], "height": 2.5})
    write("camera-lens", scene=things, camera={**CAMERA, "aperture": 0.3, "focus_distance": 3.2})
    write("camera-in-a-node", camera=None, scene=things + [{
        "transform": {"rotate": {"axis": [0, 1, 0], "angle_deg": 25}, "translate": [1.5, 1, 3]},
        "camera": {"look_at": [0, -0.1, -1], "up": [0.5, 1, 0], "fov_y_deg": 50, "aspect": 1.5}}])
    shutter = {**CAMERA, "shutter": [0.1, 0.9]}
    write("motion-nodes", camera=shutter, scene=[FLOOR, LAMP, {
        "motion": [{"time": 0, "transform": {"translate": [-0.8, 0.6, 0]}},
                   {"time": 0.5, "transform": {"rotate": {"axis": [0.2, 0.5, 1], "angle_deg": 100}, "translate": [0, 0.9, 0]}},
                   {"time": 1, "transform": {"scale": [1, 1.6, 1], "rotate": {"axis": [0, 0, 1], "angle_deg": 170}, "translate": [0.8, 0.6, 0.3]}}],
        "material": {"kind": "principled", "color": [0.8, 0.3, 0.1], "roughness": 0.4}, "box": {"min": [-0.3, -0.2, -0.3], "max": [0.3, 0.2, 0.3]},
        "children": [{"material": {"color": 0.9}, "sphere": {"center": [0, 0.5, 0], "radius": 0.15}}]}])
    write("motion-vertices", camera=shutter, scene=[FLOOR, LAMP, {"material": {"color": [0.2, 0.5, 0.8]}, "mesh": {
        "positions": [[-0.8, 0.1, 0], [0.8, 0.1, 0], [0, 1.2, 0], [0, 0.4, 0.8]], "indices": [[0, 1, 2], [0, 3, 2], [1, 2, 3]],
        "motion": [{"time": 0}, {"time": 0.4, "positions": [[-0.6, 0.2, 0], [0.8, 0.1, 0.3], [0.2, 1.4, 0], [0, 0.5, 0.9]]},
                   {"time": 1, "positions": [[-0.9, 0.4, 0], [0.6, 0.3, 0], [-0.2, 1.0, 0], [0.3, 0.4, 0.6]]}]}}])
    write("motion-sphere", camera=shutter, scene=[FLOOR, {"material": {"kind": "none", "emission": [4, 3, 2]},
                                                         "sphere": {"center": [-1, 1.5, 0], "radius": 0.2, "center_end": [1, 1.8, 0.5]}}])


def models():
    for name in ("gltf", "glb", "obj", "ply", "stl"):
        write(f"model-{name}", scene=[FLOOR, LAMP, {"model": f"model.{name}"}])
    write("model-replaced", scene=[FLOOR, LAMP, {"model": "model.obj", "materials": {"red": {"kind": "glass"}},
                                                 "transform": {"rotate": {"axis": [0, 1, 0], "angle_deg": 30}}},
                                   {"model": "model.ply", "material": {"kind": "metal", "color": [0.9, 0.8, 0.5], "roughness": 0.2},
                                    "transform": {"scale": 0.5, "translate": [1, 0, 0.8]}}])


def animation():
    """glTF with the extension .json, recognized by content: a skinned strip, a morphing sheet, a rotating sheet."""
    data, views, accessors = b"", [], []

    def numbers(fmt, values, kind, component=5126, **more):
        nonlocal data
        data += b"\0" * (-len(data) % 4)
        packed = struct.pack(f"<{len(values)}{fmt}", *values)
        views.append({"buffer": 0, "byteOffset": len(data), "byteLength": len(packed)})
        data += packed
        count = len(values) // {"SCALAR": 1, "VEC3": 3, "VEC4": 4, "MAT4": 16}[kind]
        accessors.append({"bufferView": len(views) - 1, "componentType": component, "count": count, "type": kind, **more})
        return len(accessors) - 1

    def grid(width, height, rows):
        points = [(x, height * r / rows, 0) for r in range(rows + 1) for x in (-width / 2, width / 2)]
        corners = [2 * r + i for r in range(rows) for i in (0, 1, 3, 0, 3, 2)]
        return points, numbers("f", [x for p in points for x in p], "VEC3"), numbers("H", corners, "SCALAR", 5123)

    strip, strip_position, strip_index = grid(0.4, 1.6, 8)
    weights = [w for p in strip for w in (round(255 * (1 - p[1] / 1.6)), 255 - round(255 * (1 - p[1] / 1.6)), 0, 0)]
    sheet, sheet_position, sheet_index = grid(0.6, 0.6, 3)
    offsets = [x for p in sheet for x in (0.3 * p[1], 0.2, 0.5 * p[1] * p[1])]
    times, cubic_times = numbers("f", [0, 0.5, 1], "SCALAR"), numbers("f", [0, 1], "SCALAR")
    turns = numbers("h", [0, 0, 0, 32767, 0, 0, 12539, 30273, 0, 0, -12539, 30273], "VEC4", 5122, normalized=True)
    ways = numbers("f", [0, 0, 0, 1, 0.2, 0, 0, 2, 0, 0, 1, 0, 1.4, 0.4, 0.2, 0, 0, 0], "VEC3")
    colors = numbers("f", [0.9, 0.2, 0.1, 1, 0.1, 0.8, 0.3, 1, 0.2, 0.3, 0.9, 1], "VEC4")
    shares = numbers("f", [0, 1, 0.3], "SCALAR")
    target = {"path": "pointer", "extensions": {"KHR_animation_pointer": {
        "pointer": "/materials/0/pbrMetallicRoughness/baseColorFactor"}}}
    channels = [(times, turns, "LINEAR", {"node": 2, "path": "rotation"}), (times, shares, "LINEAR", {"node": 3, "path": "weights"}),
                (cubic_times, ways, "CUBICSPLINE", {"node": 4, "path": "translation"}),
                (times, turns, "STEP", {"node": 4, "path": "rotation"}), (times, colors, "LINEAR", target)]
    two_sided = {"doubleSided": True, "pbrMetallicRoughness": {"metallicFactor": 0, "roughnessFactor": 0.6}}
    document = {
        "asset": {"version": "2.0"}, "scenes": [{"nodes": [0, 1, 3, 4, 5, 6]}],
        "extensionsUsed": ["KHR_animation_pointer", "KHR_lights_punctual"],
        "extensions": {"KHR_lights_punctual": {"lights": [{"type": "point", "intensity": 40}]}},
        "cameras": [{"type": "perspective", "perspective": {"yfov": 0.7, "znear": 0.1}}],
        "nodes": [{"mesh": 0, "skin": 0}, {"children": [2], "translation": [-0.8, 0, 0]}, {"translation": [0, 0.6, 0]},
                  {"mesh": 1, "translation": [0.1, 0.2, 0]}, {"mesh": 2}, {"camera": 0, "translation": [0.2, 0.8, 4.2]},
                  {"translation": [1, 3, 3], "extensions": {"KHR_lights_punctual": {"light": 0}}}],
        "skins": [{"joints": [1, 2], "inverseBindMatrices": numbers("f", [
            1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, -0.6, 0, 1], "MAT4")}],
        "materials": [two_sided, {**two_sided, "emissiveFactor": [0.1, 0.1, 0.3]}],
        "meshes": [{"primitives": [{"attributes": {
                        "POSITION": strip_position, "JOINTS_0": numbers("B", [0, 1, 0, 0] * len(strip), "VEC4", 5121),
                        "WEIGHTS_0": numbers("B", weights, "VEC4", 5121, normalized=True)}, "indices": strip_index, "material": 0}]},
                   {"primitives": [{"attributes": {"POSITION": sheet_position}, "indices": sheet_index, "material": 1,
                                    "targets": [{"POSITION": numbers("f", offsets, "VEC3")}]}]},
                   {"primitives": [{"attributes": {"POSITION": sheet_position}, "indices": sheet_index, "material": 0}]}],
        "animations": [{"samplers": [{"input": i, "output": o, "interpolation": n} for i, o, n, _ in channels],
                        "channels": [{"sampler": i, "target": c[3]} for i, c in enumerate(channels)]}],
        "accessors": accessors, "bufferViews": views,
        "buffers": [{"byteLength": len(data), "uri": "data:application/octet-stream;base64," + base64.b64encode(data).decode()}]}
    (FOLDER / "animation.json").write_text(json.dumps(document) + "\n")


if __name__ == "__main__":
    FOLDER.mkdir(exist_ok=True)
    assets(), materials(), textures(), lights(), shapes(), cameras_and_motion(), models(), animation()
