#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Tests of the command line: scenes, variants and cameras of a file, info, convert."""
import json
import os

from harness import CommandLine, run_tests


class Choices(CommandLine):
    def test_info(self):
        text = self.ok("info", "box.json").stdout
        for word in ("main (perspective)", "side", "bounds", "environment", "memory"):
            self.assertIn(word, text)
        info = json.loads(self.ok("info", "box.json", "--json").stdout)
        self.assertEqual(info["counts"]["cameras"], 2)
        self.assertEqual(info["cameras"][0]["name"], "main")
        self.assertEqual((info["scenes"], info["variants"]), ([], []))

    def test_choices(self):
        """Scenes, variants and cameras of a file are listed by info, and selected by name or number."""
        self.scene("box.json", "camera main camera side camera side scene one scene two variant dawn variant dusk")
        text = self.ok("info", "box.json").stdout
        self.assertIn("0: main (perspective), 1: side (perspective), 2: side (perspective)", text)
        self.assertRegex(text, r"scenes +one, two\n")
        self.assertRegex(text, r"variants +dawn, dusk\n")
        info = json.loads(self.ok("info", "box.json", "--json").stdout)
        self.assertEqual((info["scenes"], info["variants"]), (["one", "two"], ["dawn", "dusk"]))
        for chosen, name in (("0", "main"), ("1", "side"), ("main", "main"), ("side", "side")):
            words = self.ok("render", "box.json", "--spp", "1", "--camera", chosen).stderr
            self.assertIn(f"camera '{name}", words)
        # A number also selects the second camera of the same name.
        self.scene("same.json", "camera main camera side aspect 2 camera side aspect 4")
        words = self.ok("render", "same.json", "--spp", "1", "--camera", "2").stderr
        self.assertIn("aspect 4", words)
        self.scene("nameless.json", "camera 2 aspect 2 camera 1 aspect 4")
        words = self.ok("render", "nameless.json", "--spp", "1", "--camera", "1").stderr
        self.assertIn("camera '1'", words)
        self.refused(1, "render", "same.json", "--camera", "3", words=["there is no camera '3'", "'main'"])
        self.refused(1, "render", "same.json", "--camera", "99999999999999999999", words=["there is no camera"])
        words = self.ok("render", "box.json", "--spp", "1", "--variant", "dusk", "--scene", "two").stderr
        self.assertIn("variant dusk", words)
        self.assertIn("scene two", words)

    def test_a_scene_of_several(self):
        for command in ("render", "info"):
            result = self.ok(command, "box.json", "--scene", "two", *(["--spp", "1"] if command == "render" else []))
            self.assertIn("scene two", result.stderr + result.stdout)

    def test_convert(self):
        self.scene("box.json", "camera main warn odd")
        result = self.ok("convert", "box.json", "new.json")
        self.assertIn("fathom: warning: odd", result.stderr)
        self.assertIn("wrote new.json", result.stderr)
        with open(self.path("new.json")) as file:
            written = json.load(file)
        self.assertEqual(list(written["cameras"]), ["main"])
        self.assertEqual(written["scene"], [{"transform": {"translate": [1, 2, 3]}, "camera": "main"}])
        self.assertNotIn("wrote", self.ok("convert", "box.json", "new.json", "-q").stderr)
        self.refused(2, "convert", "box.json", "new.obj", words=["new.obj", ".json or .glb"])
        self.assertIn("wrote new.glb", self.ok("convert", "box.json", "new.glb").stderr)
        self.refused(2, "convert", "box.json")
        self.refused(1, "convert", "box.json", "nowhere/new.json", words=["nowhere"])
        self.refused(1, "convert", "box.json", "box.json", words=["box.json", "read from this file"])
        os.symlink("box.json", self.path("link.json"))
        self.refused(1, "convert", "box.json", "link.json", words=["link.json", "read from this file"])
        with open(self.path("box.json")) as file:
            self.assertEqual(file.read(), "camera main warn odd")


if __name__ == "__main__":
    run_tests()
