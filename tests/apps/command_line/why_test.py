#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Tests of the command line: fathom why."""
import base64
import html.parser
import json
import os
import signal
import struct
import subprocess
import unittest

from harness import DOUBLE, PROGRAM, CommandLine, Gate, run_tests

# A floor that is lit through a glass ball around a small lamp, and by a weak lamp beside it.
SHADE = {
    "fathom": 1,
    "camera": {"position": [0, 3, 3], "look_at": [0, 0, 0], "fov_y_deg": 40},
    "materials": {"floor": {"color": [0.5, 0.5, 0.5]}, "shade": {"kind": "glass"}, "bulb": {"emission": [400, 400, 400]},
                  "<b>&\"\n": {"color": [0.8, 0.1, 0.1]}},
    "scene": [
        {"name": "ground", "rectangle": {"corner": [-3, 0, 3], "edge_u": [6, 0, 0], "edge_v": [0, 0, -6]}, "material": "floor"},
        {"name": "lampshade", "sphere": {"center": [0, 0.7, 0], "radius": 0.3}, "material": "shade"},
        {"name": "filament", "sphere": {"center": [0, 0.7, 0], "radius": 0.05}, "material": "bulb"},
        {"name": "<i>&", "sphere": {"center": [1, 0.2, 0], "radius": 0.2}, "material": "<b>&\"\n"},
    ],
}


class Page(html.parser.HTMLParser):
    """Tags and texts of a page; fails at tags that are not closed."""

    def __init__(self, text):
        super().__init__()
        self.images, self.links, self.texts, self.open = [], [], [], []
        self.feed(text)
        self.close()

    def handle_starttag(self, tag, attributes):
        attributes = dict(attributes)
        self.images += [attributes["src"]] if tag == "img" else []
        self.links += [value for name, value in attributes.items() if name in ("href", "src") and not value.startswith("data:")]
        if tag not in ("img", "meta", "br"):
            self.open.append(tag)

    def handle_endtag(self, tag):
        assert self.open.pop() == tag, tag

    def handle_data(self, data):
        self.texts.append(data)


class Why(CommandLine):
    def setUp(self):
        super().setUp()
        self.scene("shade.json", json.dumps(SHADE))

    def why(self, *arguments, **options):
        return self.ok("why", self.path("shade.json"), "--size", "48x36", *arguments, program=PROGRAM, **options)

    def test_text_names_the_largest_cause_first(self):
        lines = self.why("--spp", "64").stdout.splitlines()
        self.assertIn("shade.json: 48x36 pixels, 64 samples per pixel: error ", lines[0])
        self.assertRegex(lines[1], r"^  \d+ % of the noise: light found at glass 'shade'$")
        for table in ("light", "material", "object", "kind of path", "depth"):
            self.assertIn(f"   noise          light    time  by {table}", lines)
        self.assertIn("  --caustics on", lines)
        self.assertRegex(lines[lines.index("  --caustics on") + 1], r"^      [\d.e+]+ times less time for the same noise \(")

    def test_json(self):
        result = json.loads(self.why("--json", "--spp", "64").stdout)
        self.assertEqual((result["width"], result["height"], result["samples_per_pixel"]), (48, 36, 64))
        for table in ("lights", "materials", "objects", "paths", "depths", "combinations"):
            rows = result[table]
            for column in ("noise", "light") + (() if table == "combinations" else ("time",)):
                self.assertAlmostEqual(sum(row[column] for row in rows), 1, 5, f"{table} {column}")
            self.assertEqual([row["noise"] for row in rows], sorted((row["noise"] for row in rows), reverse=True))
        first = result["combinations"][0]
        self.assertEqual(first["name"], "EDTL by rays: light of object 'filament' at glass 'shade'")
        self.assertEqual((first["path"], first["sampled"]), ("EDTL", False))
        remedy = result["remedies"][0]
        self.assertEqual(remedy["action"], "--caustics on")
        self.assertTrue(remedy["helps"])
        self.assertGreater(remedy["gain"], 2)
        self.assertTrue(remedy["gain_low"] <= remedy["gain"] <= remedy["gain_high"])
        self.assertIn("make glass 'shade' `thin`", [r["action"] for r in result["remedies"]])

    def test_only_times_differ_between_runs(self):
        def measured(*arguments):
            result = json.loads(self.why("--json", "--advice", "off", *arguments).stdout)
            self.assertEqual(result["remedies"], [])
            for table in result.values():
                for row in table if isinstance(table, list) else []:
                    if isinstance(row, dict):
                        row.pop("time", None)
            return {key: value for key, value in result.items() if key not in ("thread_s", "largest_causes")}
        self.assertEqual(measured("--threads", "1"), measured("--threads", "2"))

    def test_page_contains_all_that_it_shows(self):
        result = self.why("-o", "why.html", "--advice", "off")
        self.assertIn("wrote why.html", result.stderr)
        page = Page(self.read("why.html").decode())
        self.assertEqual(page.open, [])
        self.assertEqual(page.links, [])
        self.assertEqual(len(page.images), 3)
        for image in page.images:
            start = "data:image/png;base64,"
            self.assertTrue(image.startswith(start))
            png = base64.b64decode(image[len(start):], validate=True)
            self.assertEqual(struct.unpack(">II", png[16:24]), (48, 36))
        text = "".join(page.texts)
        self.assertIn("object '<i>&'", text)
        self.assertIn("diffuse '<b>&\"?'", text)
        self.assertRegex(text, r"\d+ % of the noise: light found at glass 'shade'")

    def test_files_of_both_kinds(self):
        result = self.why("-o", "a.html", "-o", "b.json", "--advice", "off")
        self.assertIn("by material", result.stdout)
        self.assertEqual(json.loads(self.read("b.json"))["width"], 48)
        self.assertTrue(self.read("a.html").startswith(b"<!DOCTYPE html>"))

    def test_page_to_standard_output(self):
        result = self.why("-o", "-", "--advice", "off", "-q")
        self.assertTrue(result.stdout.startswith("<!DOCTYPE html>"))
        self.assertTrue(result.stdout.endswith("</html>\n"))
        self.assertEqual(result.stderr, "")

    def test_small_image_has_the_shape_of_the_scene(self):
        self.scene("wide.json", json.dumps({**SHADE, "render": {"size": [1000, 500]}}))
        result = self.ok("why", self.path("wide.json"), "--json", "--spp", "8", "--advice", "off", program=PROGRAM)
        result = json.loads(result.stdout)
        self.assertEqual((result["width"], result["height"], result["samples_per_pixel"]), (256, 128, 8))

    def test_black_scene(self):
        dark = {**SHADE, "scene": SHADE["scene"][:2]}
        self.scene("dark.json", json.dumps(dark))
        result = self.ok("why", self.path("dark.json"), "--light", "file", "--size", "16x16", program=PROGRAM)
        self.assertIn("there is no noise", result.stdout)
        self.assertNotIn("nan", result.stdout)

    def test_refused(self):
        self.scene("broken.json", '{"fathom": 1, "scene": [')
        os.mkdir(self.path("folder.html"))
        for code, arguments, words in [
                (1, ["none.json"], ["none.json", "no such file"]),
                (1, ["broken.json"], ["broken.json"]),
                (1, ["shade.json", "-o", "missing/why.html"], ["missing/why.html", "there is no folder 'missing'"]),
                (1, ["shade.json", "-o", "shade.json"], ["shade.json"]),
                (1, ["shade.json", "-o", "folder.html"], ["folder.html", "is a folder"]),
                (2, ["shade.json", "-o", "why.png"], ["-o", "why.png", ".html or .json"]),
                (2, ["shade.json", "--json", "-o", "-"], ["-o -, --json", "leave out one of them"]),
                (2, ["shade.json", "--spp", "7"], ["--spp", "7"]),
                (2, ["shade.json", "--spp", "2000"], ["--spp", "2000"]),
                (2, ["shade.json", "--advice", "maybe"], ["--advice", "maybe"]),
                (2, [], ["SCENE"]),
                (2, ["shade.json", "box.json"], ["box.json"])]:
            self.refused(code, "why", *arguments, program=PROGRAM, words=words)

    def test_interrupt(self):
        gate = Gate(self)
        self.scene("gated.json", f"camera a gate {gate.path}")
        process = subprocess.Popen([DOUBLE, "why", "gated.json", "-o", "why.html"], cwd=self.folder, text=True,
                                   stdout=subprocess.PIPE, stderr=subprocess.PIPE)
        self.end_at_the_end(process)
        self.addCleanup(process.stdout.close)
        gate.wait(process, 1)
        process.send_signal(signal.SIGINT)
        self.read_until(process, "interrupted")
        gate.allow()
        self.assertEqual(process.stdout.read(), "")
        self.assertEqual(process.wait(), 130)
        self.assertNotIn("why.html", os.listdir(self.folder))


if __name__ == "__main__":
    run_tests()
