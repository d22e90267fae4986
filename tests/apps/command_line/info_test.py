#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Tests of the command line: fathom info for scenes of each format."""
import base64
import json
import math
import struct
import unittest

from harness import PROGRAM, CommandLine, run_tests

TRIANGLE = "v 0 0 0\nv 2 0 0\nv 0 3 0\n"
PLY = """ply
format ascii 1.0
element vertex 3
property float x
property float y
property float z
element face 1
property list uchar int vertex_indices
end_header
0 0 0
2 0 0
0 3 0
3 0 1 2
"""
STL = """solid a
facet normal 0 0 1
outer loop
vertex 0 0 0
vertex 2 0 0
vertex 0 0 3
endloop
endfacet
endsolid
"""
MITSUBA = """<scene version="3.0.0">
<sensor type="perspective"><float name="fov" value="40"/><film type="hdrfilm"><integer name="width" value="32"/>
<integer name="height" value="16"/></film><sampler type="independent"><integer name="sample_count" value="9"/></sampler></sensor>
<emitter type="point"><rgb name="intensity" value="1,2,3"/></emitter>
<shape type="ply"><string name="filename" value="a.ply"/><bsdf type="polarizer" id="fur"/></shape></scene>
"""
FATHOM = {
    "fathom": 1,
    "textures": {"t": {"image": "none.png"}, "u": {"image": "dot.png"}},
    "materials": {"lamp": {"kind": "diffuse", "emission": [3, 2, 1]},
                  "shell": {"kind": "principled", "color": {"texture": "t"}, "coat": 0.5, "sheen_color": [0.1, 0.1, 0.1]},
                  "spare": {"kind": "glass", "color": {"texture": "u"}}},
    "scene": [{"sphere": {"radius": 0.5}, "material": "lamp"}, {"model": "a.obj", "material": "shell"}],
}
DOT = base64.b64decode("iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAYAAAAfFcSJAAAADUlEQVR42mNk+M9QDwADhgGAWjR9awAAAABJRU5ErkJggg==")


def glb():
    numbers = struct.pack("<9f", 0, 0, 0, 2, 0, 0, 0, 3, 0)
    text = json.dumps({
        "asset": {"version": "2.0"}, "extensionsUsed": ["EXT_nobody_knows"], "scene": 0, "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0}], "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "material": 0}]}],
        "materials": [{"name": "thin paint", "alphaMode": "BLEND", "pbrMetallicRoughness": {"metallicFactor": 0}}],
        "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"}],
        "bufferViews": [{"buffer": 0, "byteLength": 36}], "buffers": [{"byteLength": 36}]}).encode()
    text += b" " * (-len(text) % 4)
    return (struct.pack("<4sII", b"glTF", 2, 28 + len(text) + 36) + struct.pack("<I4s", len(text), b"JSON") + text +
            struct.pack("<I4s", 36, b"BIN\0") + numbers)


@unittest.skipUnless(PROGRAM, "the program itself is not given")
class Info(CommandLine):
    def put(self, name, content):
        with open(self.path(name), "wb") as file:
            file.write(content if isinstance(content, bytes) else content.encode())

    def setUp(self):
        super().setUp()
        self.put("a.obj", "mtllib a.mtl\n" + TRIANGLE + "usemtl red\nf 1 2 3\nl 1 2\nl 2 3\n")
        self.put("a.mtl", "newmtl red\nKd 1 0 0\nnewmtl never\nKd 0 0 0\n")
        self.put("a.ply", PLY)
        self.put("a.stl", STL)
        self.put("a.xml", MITSUBA)
        self.put("a.json", json.dumps(FATHOM))
        self.put("a.glb", glb())
        self.put("dot.png", DOT)

    def info(self, name):
        return json.loads(self.ok("info", name, "--json", program=PROGRAM).stdout)

    def test_formats(self):
        for name, format, files in (("a.obj", "OBJ", ["a.obj", "a.mtl"]), ("a.ply", "PLY", ["a.ply"]),
                                    ("a.stl", "STL", ["a.stl"]), ("a.xml", "Mitsuba 3", ["a.xml", "a.ply"]),
                                    ("a.json", "scene of Fathom", ["a.json", "a.obj", "a.mtl"]),
                                    ("a.glb", "glTF 2.0", ["a.glb"])):
            info = self.info(name)
            self.assertEqual(info["format"], format, name)
            self.assertEqual([f["file"] for f in info["files"]], files, name)
            self.assertGreater(info["files"][0]["bytes"], 50, name)
            self.assertEqual(info["counts"]["triangles"], 1, name)
            self.assertIn("memory_bytes", info["compiled"], name)
            text = self.ok("info", name, program=PROGRAM).stdout
            self.assertRegex(text, rf"format +{format}\n")
            for file in files:
                self.assertRegex(text, rf" kB  {file}\n")

    def test_noise_of_a_crop(self):
        """Mean and error are those of the rendered pixels; pixels outside a crop are black and have none."""
        self.put("even.json", json.dumps({
            "fathom": 1, "camera": {"position": [0, 0, 3], "look_at": [0, 0, 0]}, "environment": {"kind": "constant", "color": [0.5, 0.5, 0.5]},
            "materials": {"m": {"kind": "diffuse", "color": [0.5, 0.5, 0.5]}}, "scene": [{"sphere": {"center": [0, 0, 0], "radius": 0.5}, "material": "m"}]}))
        def noise(*words):
            self.ok("render", "even.json", "--size", "20x20", "--spp", "16", "--mergeable", "-q", "-o", "film.exr", *words, program=PROGRAM)
            return self.info("film.exr")["noise"]
        for crop in ("0,0,3,3", "16,2,20,9"):
            self.assertAlmostEqual(noise("--crop", crop)["mean"], 0.5, places=6)
        whole, middle, all_of_it = noise(), noise("--crop", "5,5,15,15"), noise("--crop", "0,0,20,20")
        self.assertEqual(all_of_it, whole)
        # The ball is noisier than the uniform background.
        self.assertGreater(middle["standard_error"], whole["standard_error"])

    def test_sizes(self):
        self.assertEqual(self.info("a.ply")["bounds"], {"min": [0, 0, 0], "max": [2, 3, 0], "size": [2, 3, 0]})
        self.assertRegex(self.ok("info", "a.ply", program=PROGRAM).stdout, r"bounds +\(0, 0, 0\) to \(2, 3, 0\): 2 x 3 x 0 m\n")

    def test_materials(self):
        materials = {m["name"]: m for m in self.info("a.json")["materials"]}
        self.assertEqual(materials["lamp"], {"name": "lamp", "kind": "diffuse", "shapes": 1, "uses": ["emission"], "emission": [3, 2, 1]})
        self.assertEqual((materials["shell"]["kind"], materials["shell"]["shapes"]), ("principled", 1))
        self.assertEqual(materials["shell"]["uses"], ["color texture", "coat", "sheen"])
        self.assertEqual((materials["spare"]["kind"], materials["spare"]["shapes"]), ("glass", 0))
        self.assertEqual(self.info("a.glb")["materials"][0]["uses"], ["alpha", "single-sided"])
        text = self.ok("info", "a.json", program=PROGRAM).stdout
        self.assertRegex(text, r"lamp +diffuse +1  emission\n")
        self.assertRegex(text, r"materials +\d+: .*1 glass.* unused\n")
        self.assertNotIn("spare", text)

    def test_lights(self):
        kinds = ["point", "spot", "directional", "projector", "goniometric", "beam"]
        lights = {kind: {"kind": kind, **({"image": "dot.png"} if kind == "goniometric" else {})} for kind in kinds}
        self.put("lights.json", json.dumps({"fathom": 1, "lights": lights, "scene": []}))
        self.assertEqual([light["kind"] for light in self.info("lights.json")["lights"]], kinds)

    def test_images(self):
        missing, dot = self.info("a.json")["images"]
        self.assertEqual((missing["problem"], "size" in missing), ("is missing", False))
        self.assertEqual((dot["size"], dot["bytes"], dot["inside"], "problem" in dot), ([1, 1], len(DOT), False, False))
        text = self.ok("info", "a.json", program=PROGRAM).stdout
        self.assertRegex(text, r"none\.png: is missing\n")
        self.assertRegex(text, r" 1x1 +0\.1 kB  dot\.png\n")

    def test_lights_cameras_and_settings(self):
        info = self.info("a.xml")
        self.assertEqual(info["lights"][0]["kind"], "point")
        self.assertEqual(info["lights"][0]["intensity"], [1, 2, 3])
        self.assertEqual(info["cameras"][0]["kind"], "perspective")
        # Mitsuba's angle of view is the horizontal one.
        self.assertAlmostEqual(info["cameras"][0]["fov_y_deg"], math.degrees(2 * math.atan(math.tan(math.radians(20)) / 2)))
        self.assertEqual((info["settings"]["width"], info["settings"]["height"], info["settings"]["spp"]), (32, 16, 9))
        self.assertRegex(self.ok("info", "a.xml", program=PROGRAM).stdout, r"settings +width 32, height 16, spp 9")

    def test_what_is_left_out(self):
        """Each ignored feature is reported once with its count, in the words of `fathom render`."""
        def told(name):
            return {w["message"]: w["count"] for w in self.info(name)["warnings"]}
        self.assertEqual(told("a.obj"), {"a.obj: line elements are ignored": 2})
        self.assertEqual(len([w for w in told("a.xml") if "polarizer" in w]), 1)
        self.assertEqual(len([w for w in told("a.glb") if "EXT_nobody_knows" in w]), 1)
        self.assertRegex(self.ok("info", "a.obj", program=PROGRAM).stdout, r"warning +a.obj: line elements are ignored \(2 times\)\n")
        self.assertEqual(told("a.ply"), {})
        self.assertRegex(self.ok("info", "a.ply", program=PROGRAM).stdout, r"ignored +nothing\n")

    def test_what_is_no_scene(self):
        self.put("b.obj", "f 1 2 3\n")
        self.refused(1, "info", "b.obj", program=PROGRAM, words=["b.obj: line 1: vertex 1 is out of range"])


if __name__ == "__main__":
    run_tests()
