#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Tests of the command line: frames of an animation and turntables."""
import base64
import json
import os
import re
import struct
from pathlib import Path

from harness import CommandLine, PROGRAM, run_tests


def pixels_of_hdr(path):
    """Returns the colors of a Radiance HDR image as a flat list. The rows must be run-length encoded."""
    data = Path(path).read_bytes()
    height, width = map(int, re.search(rb"\n-Y (\d+) \+X (\d+)\n", data).groups())
    at, values = data.index(b"\n", data.index(b"\n-Y ") + 1) + 1, []
    for _ in range(height):
        assert data[at:at + 2] == b"\2\2", "no run lengths"
        at, row = at + 4, b""
        while len(row) < 4 * width:
            count = data[at]
            row += data[at + 1:at + 2] * (count - 128) if count > 128 else data[at + 1:at + 1 + count]
            at += 2 if count > 128 else 1 + count
        for x in range(width):
            values += [row[c * width + x] * 2.0 ** (row[3 * width + x] - 136) for c in range(3)]
    return values


def walking_model():
    """Returns a glTF model with animations: a triangle that moves and rotates, one that is deformed by a morph target,
    a light that changes, and a camera that moves back."""
    def floats(*values):
        return struct.pack(f"<{len(values)}f", *values)
    pieces = [floats(0, 0, 0, 1, 0, 0, 0, 1, 0), floats(0, 0, 1, 0, 0, -1, 1, 1, 0), floats(0, .5, 1), floats(0, 1, .3),
              floats(0, 0, 0, 4, 1, 0, 4, 1, -40), floats(0, 0, 0, 1, 0, .6, 0, .8, 0, 1, 0, 0),
              floats(10, 20, 400), floats(.3, .4, 5, .6, .2, 6, 1, .5, 9)]
    kinds = ["VEC3", "VEC3", "SCALAR", "SCALAR", "VEC3", "VEC4", "SCALAR", "VEC3"]
    each = {"VEC3": 12, "VEC4": 16, "SCALAR": 4}
    views, accessors, data = [], [], b""
    for piece, kind in zip(pieces, kinds):
        views.append({"buffer": 0, "byteOffset": len(data), "byteLength": len(piece)})
        accessors.append({"bufferView": len(views) - 1, "componentType": 5126, "count": len(piece) // each[kind], "type": kind})
        data += piece
    intensity = {"path": "pointer", "extensions": {"KHR_animation_pointer": {
        "pointer": "/extensions/KHR_lights_punctual/lights/0/intensity"}}}
    samplers = [{"input": 2, "output": output} for output in (3, 4, 5, 6, 7)]
    return {"asset": {"version": "2.0"}, "scenes": [{"nodes": [0, 1, 2, 3]}],
            "nodes": [{"mesh": 0}, {"mesh": 1}, {"translation": [0, 0, 3], "extensions": {"KHR_lights_punctual": {"light": 0}}}, {"camera": 0}],
            "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]},
                       {"weights": [0], "primitives": [{"attributes": {"POSITION": 0}, "targets": [{"POSITION": 1}]}]}],
            "extensionsUsed": ["KHR_lights_punctual", "KHR_animation_pointer"],
            "extensions": {"KHR_lights_punctual": {"lights": [{"type": "point", "intensity": 20}]}},
            "animations": [{"samplers": samplers, "channels": [
                {"sampler": 0, "target": {"node": 1, "path": "weights"}},
                {"sampler": 1, "target": {"node": 0, "path": "translation"}},
                {"sampler": 2, "target": {"node": 0, "path": "rotation"}},
                {"sampler": 3, "target": intensity},
                {"sampler": 4, "target": {"node": 3, "path": "translation"}}]}],
            "cameras": [{"type": "perspective", "perspective": {"yfov": 0.8, "znear": 0.1}}],
            "accessors": accessors, "bufferViews": views,
            "buffers": [{"byteLength": len(data),
                         "uri": "data:application/octet-stream;base64," + base64.b64encode(data).decode()}]}


class Series(CommandLine):
    def test_poses_and_frames(self):
        self.scene("walk.json", "camera main moves stride")
        result = self.ok("render", "walk.json", "--spp", "1")
        self.assertIn("showing the pose at rest; the file has 1 animation (stride): --at", result.stderr)
        self.assertIn("camera 'main' at 1,2,3", result.stderr)
        self.assertRegex(self.ok("info", "walk.json").stdout, r"animations +0: stride \(2 s;")
        info = json.loads(self.ok("info", "walk.json", "--json").stdout)
        self.assertEqual(info["animations"], [{"name": "stride", "duration_s": 2.0, "channels": 1}])
        # The camera moves one meter per second and stops at the end.
        for time_s, x in (("0", "0"), ("1.5", "1.5"), ("1.5s", "1.5"), ("7", "2")):
            words = self.ok("render", "walk.json", "--spp", "1", "--at", time_s).stderr
            self.assertIn(f"camera 'main' at {x},0,0", words)
            self.assertNotIn("at rest", words)
        self.assertIn("at 0.5,0,0", self.ok("render", "walk.json", "--spp", "1", "--frames", "12").stderr)
        before = set(os.listdir(self.folder))
        words = self.ok("render", "walk.json", "--spp", "1", "--frames", "8:12:2", "--fps", "8", "-o", "a.###.png", "-o",
                        "b#.png").stderr
        self.assertEqual(set(os.listdir(self.folder)) - before,
                         {"a.008.png", "a.010.png", "a.012.png", "b8.png", "b10.png", "b12.png"})
        for x in ("1", "1.25", "1.5"):
            self.assertEqual(words.count(f"camera 'main' at {x},0,0"), 1, words)
        # --shutter is a fraction of a frame, not of a second.
        for words, seconds in ((["--frames", "3", "--fps", "8"], "0.0625"), (["--at", "1"], "0.0208333"), (["--at", "1", "--fps", "4"], "0.125")):
            self.assertIn(f"shutter from 0 to {seconds}", self.ok("render", "walk.json", "--spp", "1", "--shutter", "0.5", *words).stderr)
        self.assertNotIn("shutter", self.ok("render", "walk.json", "--spp", "1", "--at", "1").stderr)
        # Options that change a camera apply to each frame.
        words = self.ok("render", "walk.json", "--spp", "1", "--frames", "0:1", "--fps", "2", "--fov", "30", "-o",
                        "c.#.png").stderr
        for x in ("0", "0.5"):
            self.assertIn(f"camera 'command line' at {x},0,0", words)
        self.ok("render", "walk.json", "--spp", "1", "--frames", "0:1")
        self.assertTrue(os.path.exists(self.path("walk.0001.png")))

    def test_wrong_poses_and_frames(self):
        self.scene("walk.json", "camera main moves stride")
        def wrong(*arguments, words):
            self.refused(2, "render", "walk.json", "--spp", "1", *arguments, words=words)
        wrong("--frames", "0:3", "-o", "a.png", words=["a.png", "####"])
        wrong("--frames", "3:0", words=["--frames", "no frames"])
        wrong("--frames", "0:1:0", words=["--frames"])
        wrong("--frames", "0:1:1:1", words=["--frames", "A:B:STEP"])
        wrong("--frames", "0:99999999", words=["--frames", "1000000"])
        wrong("--frames", "0:1", "--at", "1", words=["--at", "--frames"])
        wrong("--frames", "0:1", "--time", "1s", words=["--frames", "--time"])
        wrong("--frames", "0:1", "--only-sample", "0,0,0", words=["--only-sample"])
        wrong("--frames", "0:1", "--fps", "0", words=["--fps"])
        wrong("--at", "-1", words=["--at"])
        wrong("--shutter", "0.5", words=["--shutter", "--at"])
        wrong("--animation", "stride", words=["--animation", "--at"])
        self.refused(1, "render", "walk.json", "--at", "1", "--animation", "strid", words=["there is no animation 'strid'"])
        self.refused(1, "render", "box.json", "--at", "1", words=["there is no animation"])

    def test_turntable(self):
        """A turntable renders images from all around a scene that is compiled once."""
        before = set(os.listdir(self.folder))
        words = self.ok("render", "box.json", "--spp", "1", "--turntable", "4", "-o", "t.###.png", "-o", "t#.exr").stderr
        self.assertEqual(set(os.listdir(self.folder)) - before, {f"t.00{i}.png" for i in range(4)} | {f"t{i}.exr" for i in range(4)})
        self.assertEqual(words.count("camera 'orbit' at 30,20,100"), 1, words)
        self.assertEqual(words.count("camera '"), 1, words)
        words = self.ok("render", "box.json", "--spp", "1", "--turntable", "2", "--view", "left").stderr
        self.assertIn("at -90,0,100", words)
        self.assertTrue(os.path.exists(self.path("box.0001.png")))
        self.ok("render", "box.json", "--spp", "1", "--turntable", "1", "-o", "one.png")
        self.scene("walk.json", "camera main moves stride")
        self.ok("render", "walk.json", "--spp", "1", "--turntable", "1", "--at", "1", "-o", "one.png")

    def test_wrong_turntables(self):
        def wrong(*arguments, words):
            self.refused(2, "render", "box.json", "--spp", "1", *arguments, words=["--turntable", *words])
        wrong("--turntable", "0", words=[])
        wrong("--turntable", "3", "--frames", "0:1", words=["--frames"])
        wrong("--turntable", "3", "--camera", "main", words=["--camera", "--orbit"])
        wrong("--turntable", "3", "--look-from", "1,2,3", words=["--look-from"])
        wrong("--turntable", "3", "--look-at", "1,2,3", words=["--look-at"])
        wrong("--turntable", "3", "--up", "1,2,3", words=["--up"])
        wrong("--turntable", "3", "--time", "1s", words=["--time"])
        wrong("--turntable", "3", "--only-sample", "0,0,0", words=["--only-sample"])
        self.refused(2, "render", "box.json", "--turntable", "3", "-o", "a.png", words=["a.png", "####"])

    def test_a_turntable_goes_around(self):
        """The first image has the bits of a separate run. The others have those of separate runs from these positions,
        except for the rounding of positions relative to the first camera; turned the other way they differ by far more."""
        if not PROGRAM:
            self.skipTest("no program given")
        with open(self.path("model.gltf"), "w") as file:
            json.dump(walking_model(), file)
        common = ["model.gltf", "-q", "--spp", "4", "--size", "48x36", "--tonemap", "srgb", "--light", "sky", "--exposure", "0"]
        def difference(a, b):
            return sum(abs(x - y) for x, y in zip(a, b)) / sum(a)
        for options in ([], ["--fov", "50"]):
            self.ok("render", *common, *options, "--turntable", "4", "--orbit", "30,20", "-o", "t.#.hdr", program=PROGRAM)
            turned = [pixels_of_hdr(self.path(f"t.{i}.hdr")) for i in range(4)]
            single = []
            for i in range(4):
                self.ok("render", *common, *options, "--turntable", "1", "--orbit", f"{30 + 90 * i},20", "-o", "a.hdr",
                        program=PROGRAM)
                single.append(pixels_of_hdr(self.path("a.hdr")))
            self.assertEqual(turned[0], single[0])
            for i in range(4):
                self.assertLess(difference(turned[i], single[i]), 1e-4, f"picture {i} with {options}")
            self.assertGreater(difference(turned[1], single[3]), 1e-2)

    def test_no_frame_is_written_over_an_input(self):
        self.scene("walk.json", "camera main moves stride texture t.0003.png")
        with open(self.path("t.0003.png"), "w") as file:
            file.write("a picture")
        self.refused(1, "render", "walk.json", "--spp", "1", "--frames", "0:5", "-o", "t.####.png",
                     words=["t.0003.png is a texture of this scene"])
        self.ok("render", "walk.json", "--spp", "1", "--frames", "0:2", "-o", "t.####.png")

    def test_all_animations_at_once(self):
        """A file whose animations each move one thing shows what a single animation of all things shows."""
        if not PROGRAM:
            self.skipTest("no program given")
        model = walking_model()
        with open(self.path("one.gltf"), "w") as file:
            json.dump(model, file)
        one = model["animations"][0]
        model["animations"] = [{"name": f"part {i}", "samplers": one["samplers"], "channels": [channel]}
                               for i, channel in enumerate(one["channels"])]
        with open(self.path("apart.gltf"), "w") as file:
            json.dump(model, file)
        # The time is early, when nothing has left the image yet.
        common = ["-q", "--spp", "2", "--size", "64x48", "--at", "0.2", "--light", "file", "-o", "a.hdr"]
        def pixels(name, *options):
            self.ok("render", name, *common, *options, program=PROGRAM)
            return pixels_of_hdr(self.path("a.hdr"))
        self.assertEqual(pixels("apart.gltf", "--animation", "all"), pixels("one.gltf"))
        # Leaving out any of the animations changes the image.
        for left_out in range(len(model["animations"])):
            rest = {**model, "animations": [a for i, a in enumerate(model["animations"]) if i != left_out]}
            with open(self.path("rest.gltf"), "w") as file:
                json.dump(rest, file)
            self.assertNotEqual(pixels("rest.gltf", "--animation", "all"), pixels("one.gltf"), f"without part {left_out}")
        # If an animation is named "all", the name selects it.
        model["animations"][1]["name"] = "all"
        with open(self.path("named.gltf"), "w") as file:
            json.dump(model, file)
        self.assertEqual(pixels("named.gltf", "--animation", "all"), pixels("named.gltf", "--animation", "1"))

    def test_frames_of_a_file_are_its_poses(self):
        """Each frame has the bits of a separate run, whatever moves."""
        if not PROGRAM:
            self.skipTest("no program given")
        with open(self.path("model.gltf"), "w") as file:
            json.dump(walking_model(), file)
        for options in ([], ["--orbit", "20,30"], ["--fov", "50"], ["--light", "file"], ["--shutter", "0.5"], ["--ground", "shadow"]):
            common = ["model.gltf", "-q", "--spp", "2", "--size", "64x48", "--exr", "float", *options]
            self.ok("render", *common, "--frames", "0:4", "--fps", "4", "-o", "f.#.exr", program=PROGRAM)
            pictures = set()
            for frame in range(5):
                self.ok("render", *common, "--fps", "4", "--at", str(frame / 4), "-o", "a.exr", program=PROGRAM)
                with open(self.path("a.exr"), "rb") as one, open(self.path(f"f.{frame}.exr"), "rb") as other:
                    a, b = (re.sub(rb"fathom\.(load|build|render)_s\0string\0.{4}[0-9.]+", b"", f.read(), flags=re.DOTALL)
                            for f in (one, other))
                self.assertTrue(a == b, f"frame {frame} with {options}")
                pictures.add(a)
            self.assertEqual(len(pictures), 5)


if __name__ == "__main__":
    run_tests()
