#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Tests damaged files of every kind, truncated or with changed bytes: each gives an image, or no image and one line
that names the file.

damaged_files_test.py PROGRAM SCENES [TIMES [SEED]]    TIMES: number of truncations, and of changes, of each file
(default 50)
"""
import json
import os
import random
import shutil
import struct
import subprocess
import sys
import tempfile

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "support"))
import waiting  # noqa: E402

PROGRAM, SCENES = os.path.abspath(sys.argv[1]), os.path.abspath(sys.argv[2])
TIMES = int(sys.argv[3]) if len(sys.argv) > 3 else 50
SEED = int(sys.argv[4]) if len(sys.argv) > 4 else 1
POSITIONS = [(-1, -1, 0), (1, -1, 0.5), (1, 1, 0), (-1, 1, 0.5), (0, 0, 1.5)]
TRIANGLES = [(0, 1, 4), (1, 2, 4), (2, 3, 4), (3, 0, 4)]


def write(name, content):
    with open(name, "wb") as file:
        file.write(content if isinstance(content, bytes) else content.encode())


def glb(image):
    """A GLB file of a textured pyramid with a camera, a light, a skin of one joint and sparse values."""
    parts, views = [], []

    def view(data):
        offset = sum(map(len, parts))
        views.append({"buffer": 0, "byteOffset": offset, "byteLength": len(data)})
        parts.append(data + b"\0" * (-len(data) % 4))
        return len(views) - 1

    def floats(rows):
        return b"".join(struct.pack(f"<{len(row)}f", *row) for row in rows)

    accessors = [
        {"bufferView": view(floats(POSITIONS)), "componentType": 5126, "count": 5, "type": "VEC3", "min": [-1, -1, 0],
         "max": [1, 1, 1.5],
         "sparse": {"count": 1, "indices": {"bufferView": view(struct.pack("<HH", 2, 0)), "componentType": 5123},
                    "values": {"bufferView": view(floats([(1, 1, 0.25)]))}}},
        {"bufferView": view(struct.pack("<12H", *sum(TRIANGLES, ()))), "componentType": 5123, "count": 12, "type": "SCALAR"},
        {"bufferView": view(floats([(x, y) for x, y, _ in POSITIONS])), "componentType": 5126, "count": 5, "type": "VEC2"},
        {"bufferView": view(struct.pack("<20H", *[0] * 20)), "componentType": 5123, "count": 5, "type": "VEC4"},
        {"bufferView": view(floats([(1, 0, 0, 0)] * 5)), "componentType": 5126, "count": 5, "type": "VEC4"},
    ]
    picture = view(image)
    document = {
        "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0, 1, 2, 3]}],
        "extensionsUsed": ["KHR_lights_punctual", "KHR_texture_transform"],
        "extensions": {"KHR_lights_punctual": {"lights": [{"type": "spot", "intensity": 100, "spot": {}}]}},
        "nodes": [{"mesh": 0, "skin": 0}, {"camera": 0, "translation": [0, 0, 5]},
                  {"extensions": {"KHR_lights_punctual": {"light": 0}}, "translation": [0, 2, 5]}, {"rotation": [0, 0, 0, 1]}],
        "skins": [{"joints": [3]}],
        "cameras": [{"type": "perspective", "perspective": {"yfov": 0.8, "znear": 0.1}}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0, "TEXCOORD_0": 2, "JOINTS_0": 3, "WEIGHTS_0": 4},
                                    "indices": 1, "material": 0}]}],
        "materials": [{"alphaMode": "MASK", "pbrMetallicRoughness": {"baseColorTexture": {
            "index": 0, "extensions": {"KHR_texture_transform": {"offset": [0.1, 0]}}}}}],
        "textures": [{"source": 0, "sampler": 0}], "samplers": [{"wrapS": 33071}],
        "images": [{"bufferView": picture, "mimeType": "image/png"}],
        "buffers": [{"byteLength": sum(map(len, parts))}], "bufferViews": views, "accessors": accessors,
    }
    text = json.dumps(document).encode()
    text += b" " * (-len(text) % 4)
    binary = b"".join(parts)
    return (b"glTF" + struct.pack("<II", 2, 28 + len(text) + len(binary)) + struct.pack("<I", len(text)) + b"JSON" + text +
            struct.pack("<I", len(binary)) + b"BIN\0" + binary)


def ply(form):
    head = (f"ply\nformat {form} 1.0\nelement vertex 5\nproperty float x\nproperty float y\nproperty float z\n"
            "element face 4\nproperty list uchar int vertex_indices\nend_header\n")
    if form == "ascii":
        return head + "".join("%g %g %g\n" % p for p in POSITIONS) + "".join("3 %d %d %d\n" % t for t in TRIANGLES)
    order = "<" if "little" in form else ">"
    return (head.encode() + b"".join(struct.pack(order + "3f", *p) for p in POSITIONS) +
            b"".join(struct.pack(order + "B3i", 3, *t) for t in TRIANGLES))


def stl_binary():
    facets = b"".join(struct.pack("<12fH", 0, 0, 1, *POSITIONS[a], *POSITIONS[b], *POSITIONS[c], 0) for a, b, c in TRIANGLES)
    return b"\0" * 80 + struct.pack("<I", len(TRIANGLES)) + facets


def stl_ascii():
    facets = "".join("facet normal 0 0 1\nouter loop\n" + "".join("vertex %g %g %g\n" % POSITIONS[i] for i in t) +
                     "endloop\nendfacet\n" for t in TRIANGLES)
    return "solid pyramid\n" + facets + "endsolid pyramid\n"


def dae():
    positions = " ".join("%g %g %g" % p for p in POSITIONS)
    indices = " ".join("%d %d %d" % t for t in TRIANGLES)
    return f"""<?xml version="1.0"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1"><asset><up_axis>Y_UP</up_axis></asset>
<library_geometries><geometry id="g"><mesh><source id="p"><float_array id="a" count="15">{positions}</float_array>
<technique_common><accessor source="#a" count="5" stride="3"><param name="X" type="float"/><param name="Y" type="float"/>
<param name="Z" type="float"/></accessor></technique_common></source>
<vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
<triangles count="4"><input semantic="VERTEX" source="#v" offset="0"/><p>{indices}</p></triangles></mesh></geometry>
</library_geometries><library_visual_scenes><visual_scene id="s"><node id="n"><instance_geometry url="#g"/></node>
</visual_scene></library_visual_scenes><scene><instance_visual_scene url="#s"/></scene></COLLADA>
"""


def good_files():
    """Writes valid files. Returns for each file to damage the scene that is rendered."""
    shutil.copy(os.path.join(SCENES, "images", "tiles.png"), "picture.png")
    with open("picture.png", "rb") as file:
        write("scene.glb", glb(file.read()))
    shutil.copy(os.path.join(SCENES, "textures.json"), "scene.json")
    shutil.copytree(os.path.join(SCENES, "images"), "images")
    obj = "mtllib m.mtl\nusemtl red\n" + "".join("v %g %g %g\nvt %g %g\n" % (*p, p[0], p[1]) for p in POSITIONS)
    write("scene.obj", obj + "".join("f " + " ".join(f"{i + 1}/{i + 1}" for i in t) + "\n" for t in TRIANGLES))
    write("m.mtl", "newmtl red\nKd 0.8 0.1 0.1\nKs 0.2 0.2 0.2\nNs 40\nmap_Kd picture.png\n")
    write("little.ply", ply("binary_little_endian"))
    write("big.ply", ply("binary_big_endian"))
    write("text.ply", ply("ascii"))
    write("binary.stl", stl_binary())
    write("text.stl", stl_ascii())
    files = {name: name for name in ("scene.glb", "scene.json", "scene.obj", "little.ply", "big.ply", "text.ply", "binary.stl",
                                     "text.stl")}
    files["m.mtl"] = "scene.obj"
    write("model.dae", dae())
    if subprocess.run([PROGRAM, "info", "model.dae"], capture_output=True).returncode == 0:
        files["model.dae"] = "model.dae"
    # Images are damaged as textures of a scene.
    for name in ("t.png", "t.jpg", "t.exr", "t.hdr"):
        subprocess.run([PROGRAM, "render", "scene.glb", "--size", "24x16", "--spp", "1", "-q", "-o", name], check=True)
        node = {"rectangle": {"corner": [-1, -1, 0], "edge_u": [2, 0, 0], "edge_v": [0, 2, 0]},
                "material": {"color": {"texture": {"image": name}}}}
        write(name + ".json", json.dumps({"fathom": 1, "scene": [node]}))
        files[name] = name + ".json"
    return files


def check(file, scene, what):
    """Renders a scene and returns the exit code; ends the test with a message if something is wrong."""
    try:
        result = waiting.run([PROGRAM, "render", scene, "--size", "16x12", "--spp", "1", "-q", "-o", "out.png"], processor_s=60,
                             text=False)
    except AssertionError as error:
        raise SystemExit(f"{file}, {what}: {error}")
    said = result.stderr.decode(errors="replace")
    lines = [line for line in said.splitlines() if not line.startswith("fathom: warning: ")]
    picture = os.path.exists("out.png")
    if result.returncode not in (0, 1):
        raise SystemExit(f"{file}, {what}: exit code {result.returncode}: {said}")
    if picture != (result.returncode == 0) or len(lines) != result.returncode:
        raise SystemExit(f"{file}, {what}: exit code {result.returncode}, a picture: {picture}, said: {said}")
    if lines and not (lines[0].startswith("fathom: ") and file in lines[0]):
        raise SystemExit(f"{file}, {what}: this doesn't name the file: {lines[0]}")
    if any(ord(c) < 32 and c != "\n" for c in said):
        raise SystemExit(f"{file}, {what}: control characters: {said!r}")
    if picture:
        os.remove("out.png")
    if any(name.startswith(("out", ".out")) for name in os.listdir(".")):
        raise SystemExit(f"{file}, {what}: left {os.listdir('.')}")
    return result.returncode


def main():
    rng = random.Random(SEED)
    for file, scene in good_files().items():
        with open(file, "rb") as good:
            content = good.read()
        if check(file, scene, "as it is") != 0:
            raise SystemExit(f"{file} can't be rendered as it is")
        refused = [0, 0]
        for _ in range(TIMES):
            size = rng.randrange(len(content))
            write(file, content[:size])
            refused[0] += check(file, scene, f"cut after {size} bytes")
            changed = bytearray(content)
            # Most changes are near the beginning, where sizes and offsets are.
            places = [int(len(content) * rng.random() ** 2) for _ in range(rng.randint(1, 4))]
            for place in places:
                changed[place] = rng.choice([0, 0x7f, 0x80, 0xff, rng.randrange(256), changed[place] ^ 1 << rng.randrange(8)])
            write(file, bytes(changed))
            refused[1] += check(file, scene, f"bytes {sorted(places)} changed, seed {SEED}")
        write(file, content)
        print(f"{file}: refused {refused[0]} cuts and {refused[1]} changes of {TIMES}")


if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        main()
        os.chdir("/")
