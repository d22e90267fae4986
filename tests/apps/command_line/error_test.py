#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Tests of the command line: the estimated error of images, and rendering until it is small."""
import json
import re
from pathlib import Path

from harness import CommandLine, PROGRAM, run_tests

SCENE = """{"fathom": 1, "camera": {"position": [0, 1, 4], "look_at": [0, 0.5, 0]}, "environment": {"kind": "gradient"},
"scene": [{"sphere": {"radius": 1}}, {"rectangle": {"corner": [-9, -1, 9], "edge_u": [18, 0, 0], "edge_v": [0, 0, -18]}}]}"""


class ErrorOfTheImage(CommandLine):
    def setUp(self):
        super().setUp()
        if not PROGRAM:
            self.skipTest("only the double was given")
        self.scene("balls.json", SCENE)

    def render(self, *options, code=0, size="96x80"):
        result = self.run_program("render", "balls.json", "--size", size, *options, program=PROGRAM)
        self.assertEqual(result.returncode, code, result.stderr)
        return result.stderr

    def estimate(self, *options, code=0):
        events = [json.loads(line) for line in self.render("--progress", "json", *options, code=code).splitlines()]
        return next(event for event in events if event["event"] == "error_estimate")

    def test_is_reported(self):
        # Mergeable films are guided by default, which changes the error.
        text = self.render("--spp", "64", "-o", "a.exr", "-o", "a.png", "--mergeable", "--guiding", "off")
        line = r"error ([\d.]+) % \(([\d.]+) to ([\d.]+) % with 95 % confidence\)"
        error, low, high = map(float, re.search(line, text).groups())
        self.assertTrue(0 < low <= error <= high)
        self.assertRegex(text, line + r"; twice the samples would give [\d.]+ %")
        merged = self.ok("merge", "a.exr", "-o", "b.exr", program=PROGRAM).stderr
        self.assertIn(re.search(line, text)[0], merged)
        self.assertIn(re.search(line, text)[0], self.ok("info", "b.exr", program=PROGRAM).stdout)
        event = self.estimate("--spp", "64", "--guiding", "off")
        self.assertAlmostEqual(100 * event["error"], error, delta=0.06 * error)
        self.assertEqual(event["samples_per_pixel"], 64)
        self.assertLess(event["after_twice_the_samples"], 0.8 * event["error"])

    def test_does_not_change_the_image(self):
        self.render("--spp", "8", "-o", "with.png")
        self.assertNotIn("error", self.render("--spp", "8", "--error", "off", "-o", "without.png"))
        self.assertEqual(*(Path(self.path(name)).read_bytes() for name in ("with.png", "without.png")))

    def test_stops_when_it_is_small(self):
        first = self.estimate("--error", "0.6%", "--threads", "1")
        self.assertTrue(first["reached"])
        self.assertLess(first["error"], 0.0066)
        half = self.estimate("--spp", str(first["samples_per_pixel"] // 2))
        self.assertGreater(half["high"], 0.8 * 0.006, "half of the samples would have been enough")
        self.assertEqual(first, self.estimate("--error", "0.006", "--threads", "2"))
        finer = self.estimate("--error", "0.3%")
        self.assertGreater(finer["samples_per_pixel"], 1.5 * first["samples_per_pixel"])
        # The number of samples in a scene file does not count, but that of an option does.
        self.scene("balls.json", SCENE.replace('"fathom": 1', '"fathom": 1, "render": {"samples": 2}'))
        self.assertEqual(self.estimate("--error", "0.6%")["samples_per_pixel"], first["samples_per_pixel"])

    def test_says_when_it_is_not_reached(self):
        text = self.render("--error", "0.5%", "--spp", "16", "-o", "a.png", code=3)
        self.assertRegex(text, r"--error 0.5 % was not reached: all samples are rendered, and some \d+ samples per pixel are needed")
        self.assertTrue(Path(self.path("a.png")).exists())
        self.assertIn("was not reached: the time is up", self.render("--error", "0.001%", "--time", "0.2s", code=3))
        self.assertFalse(self.estimate("--error", "0.5%", "--spp", "16", code=3)["reached"])

    def test_other_metrics(self):
        self.assertRegex(self.render("--spp", "16", "--error-metric", "absolute"), r"absolute error 0\.[\d]+ \(0\.[\d]+ to 0\.[\d]+ with")
        self.assertIn("error of the worst block", self.render("--spp", "16", "--error-metric", "worst-block"))
        worst, whole = (self.estimate("--spp", "64", "--error-metric", metric)["error"] for metric in ("worst-block", "relative"))
        self.assertGreater(worst, whole)

    def test_layer(self):
        self.render("--spp", "16", "--aov", "error", "-o", "a.exr", "--mergeable")
        channels = lambda name: set(re.findall(rb"error\.[RGB]", Path(self.path(name)).read_bytes()))
        self.assertEqual(len(channels("a.exr")), 3)
        self.ok("merge", "a.exr", "-o", "b.exr", "--no-sums", program=PROGRAM)
        self.assertEqual(len(channels("b.exr")), 3)

    def test_contradictions(self):
        refused = lambda *options, words: self.refused(2, "render", "balls.json", *options, words=words, program=PROGRAM)
        refused("--error", "2%", "--spp", "64", "--part", "1/4", words=["--error", "whole image"])
        refused("--error", "2%", "--samples", "0:4", words=["--error", "whole image"])
        refused("--error", "off", "--aov", "error", "-o", "a.exr", words=["--aov", "--error off"])


if __name__ == "__main__":
    run_tests()
