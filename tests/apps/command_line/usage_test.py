#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Tests of the command line: invalid options, and help. cli_docs_test.py compares help with docs/cli.md."""
import re

from harness import CommandLine, PROGRAM, run_tests


class Usage(CommandLine):
    def test_help_and_version(self):
        for command in ("render", "merge", "info", "view", "version"):
            text = self.ok(*command.split(), "--help").stdout
            self.assertIn("Example", text)
            self.assertIn("Exit codes", text)
        self.assertIn("130", self.ok("--help").stdout)
        self.assertEqual(self.ok("--version").stdout, self.ok("version").stdout.splitlines()[0] + "\n")
        text = self.ok("version").stdout
        for word in ("fathom", "SIMD", "OpenEXR", "libpng"):
            self.assertIn(word, text)

    def test_wrong_usage(self):
        self.refused(2)
        self.refused(2, "rendre")
        self.refused(2, "render")
        self.refused(2, "render", "box.json", "--bogus", words=["--bogus"])
        self.refused(2, "render", "box.json", "other.json")
        self.refused(2, "render", "box.json", "--spp", "4", "--spp=5", words=["--spp is given more than once"])
        self.refused(2, "merge", "a.exr", words=["-o"])

    def test_nonsense_values(self):
        wrong = {
            "--spp": ["0", "-1", "1.5", "nan", "x", "", "99999999999999999999"],
            "--time": ["0", "-5s", "nan", "inf", "h", "5d", ""],
            "--size": ["0x600", "800x0", "800", "-1x5", "axb", "800x600x3", "99999999x1", "nanxnan"],
            "--threads": ["0", "-1", "x"],
            "--seed": ["-1", "4294967296", "x"],
            "--crop": ["0,0,0,0", "1,2,3", "5,5,4,9", "0,0,801,600", "-1,0,5,5"],
            "--filter": ["sinc"],
            "--filter-radius": ["0", "-1", "65", "nan", "x"],
            "--max-depth": ["-1", "x"],
            "--roulette-depth": ["-1"],
            "--light-sampling": ["maybe"],
            "--guiding": ["maybe"], "--caustics": ["maybe"],
            "--samples": ["5:5", "9:3", "5", "a:b", "-1:4"],
            "--only-sample": ["1,2", "800,0,0", "0,600,0", "-1,0,0", "0,0,4294967296"],
            "--aov": ["colour", ""],
            "--exposure": ["nan", "inf", "1000", "x"],
            "--white-balance": ["nan", "999", "25001", "warm"],
            "--tonemap": ["reinhard"],
            "--quality": ["0", "101", "x"],
            "--background": ["blue", "#12345", "#gggggg", "1,2", "-1,0,0", "nan,0,0"],
            "--look-from": ["1,2", "nan,0,0", "1,2,3,4"],
            "--up": ["0,0,0"],
            "--fov": ["0", "180", "-5", "nan"],
            "--orbit": ["1", "0,91", "inf,0"],
            "--up-axis": ["x"],
            "--png-bits": ["12"],
            "--exr": ["double"],
            "--progress": ["xml"],
            "--error": ["0", "-1%", "2 %", "%", "nan", "x", ""],
            "--error-metric": ["variance"],
        }
        for option, values in wrong.items():
            for value in values:
                with self.subTest(option=option, value=value):
                    self.refused(2, "render", "box.json", f"{option}={value}", words=[option] if value else [])

    def test_options_that_disagree(self):
        self.refused(2, "render", "box.json", "--samples", "0:4", "--spp", "4", words=["--samples"])
        self.refused(2, "render", "box.json", "--samples", "0:4", "--time", "4", words=["--samples"])
        self.refused(2, "render", "box.json", "--aov", "depth", "-o", "a.png", words=["EXR"])
        self.refused(2, "render", "box.json", "--mergeable", words=["EXR"])
        self.refused(2, "render", "box.json", "--only-sample", "1,2,3", "-o", "a.png")
        self.refused(2, "render", "box.json", "--orbit", "1,2", "--look-from", "1,2,3")
        self.refused(2, "render", "box.json", "--look-from", "1,2,3", "--look-at", "1,2,3")

    def test_what_decides_the_picture_is_the_same_for_render_and_view(self):
        def options(command):
            return set(re.findall(r"^  (?:-\w,)?(--[a-z-]+)", self.ok(command, "--help").stdout, re.MULTILINE))
        of_files_only = {"--output", "--png-bits", "--exr", "--exr-primaries", "--aov", "--mergeable", "--samples", "--only-sample", "--time",
                         "--crop", "--quiet", "--progress", "--frames", "--turntable", "--fps", "--shutter", "--quality", "--stats",
                         "--part", "--checkpoint", "--every", "--mpi", "--error", "--error-metric", "--output-format", "--watch",
                         "--views", "--on", "--cameras", "--dataset", "--models", "--ground-truth", "--reference", "--tolerance"}
        self.assertEqual(options("render") - options("view"), of_files_only)
        self.assertEqual(options("view") - options("render"), {"--log-latency", "--script-moves"})
        self.assertIn("--scene", options("info"))
        self.refused(2, "view", "box.json", "--filter", "bix", words=["--filter", "box or gaussian"])

    def test_the_program_itself(self):
        if not PROGRAM:
            self.skipTest("only the double was given")
        self.ok("--help", program=PROGRAM)
        self.ok("version", program=PROGRAM)
        self.refused(1, "render", "none.json", words=["none.json"], program=PROGRAM)
        self.refused(2, "render", "box.json", "--spp", "0", words=["--spp"], program=PROGRAM)


if __name__ == "__main__":
    run_tests()
