#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Tests of the command line: parts of an image, and merging them."""
import json
import os
from pathlib import Path

from harness import CommandLine, run_tests


class Parts(CommandLine):
    def merge_key(self, *arguments):
        return ["render", "box.json", "--size", "9x7", "-q", *arguments]

    def test_merge_makes_the_picture_of_one_run(self):
        self.ok(*self.merge_key("--spp", "16", "-o", "whole.exr", "-o", "whole.png", "--exposure", "-1"))
        self.ok(*self.merge_key("--samples", "4:16", "-o", "b.exr"))
        self.ok(*self.merge_key("--samples", "0:4", "-o", "a.exr"))
        result = self.ok("merge", "b.exr", "a.exr", "-o", "all.exr", "-o", "all.png", "--exposure", "-1")
        self.assertIn("16 samples per pixel: 0:16", result.stderr)
        with open(self.path("whole.png"), "rb") as one, open(self.path("all.png"), "rb") as other:
            self.assertEqual(one.read(), other.read())
        # A merged film can be merged again.
        self.ok(*self.merge_key("--samples", "16:20", "-o", "c.exr"))
        self.assertIn(": 0:20", self.ok("merge", "all.exr", "c.exr", "-o", "more.exr", "--no-sums").stderr)
        self.refused(1, "merge", "more.exr", "-o", "x.png", words=["more.exr", "--mergeable"])
        self.refused(1, "merge", "all.exr", "a.exr", "-o", "x.png", words=["a.exr", "overlap"])
        self.refused(1, "merge", "whole.exr", "-o", "x.png", words=["whole.exr", "--mergeable"])
        self.ok(*self.merge_key("--samples", "30:31", "-o", "d.exr", "--seed", "1"))
        self.refused(1, "merge", "a.exr", "d.exr", "-o", "x.png", words=["d.exr: ", "seed is 1, not 0"])
        with open(self.path("a.exr"), "rb") as file:
            data = file.read()
        with open(self.path("cut.exr"), "wb") as file:
            file.write(data[:-10])
        self.refused(1, "merge", "cut.exr", "-o", "x.png", words=["cut.exr"])

    def test_parts_may_be_counted_from_0(self):
        """Schedulers count tasks from 0, so 3+1/4 is 4/4."""
        for index, samples in enumerate(("0:4", "4:8", "8:12", "12:16")):
            self.ok(*self.merge_key("--spp", "16", "--part", f"{index}+1/4", "-o", f"{index}.exr"))
            self.assertIn(f" {samples}", self.ok("info", f"{index}.exr").stdout)
        for text in "4+1/4", "-1+1/4", "1+2/4", "+1/4", "1+1+1/4":
            self.refused(2, *self.merge_key("--spp", "16", "--part=" + text, "-o", "x.exr"), words=["--part"])

    def test_merge_overwrites_no_part(self):
        for name, range_ in ("a.exr", "0:2"), ("b.exr", "2:4"):
            self.ok("render", "box.json", "--size", "8x4", "--samples", range_, "-o", name)
        os.link(self.path("b.exr"), self.path("hard.exr"))
        os.symlink("a.exr", self.path("soft.exr"))
        os.mkdir(self.path("sub"))
        before = [Path(self.path(name)).read_bytes() for name in ("a.exr", "b.exr")]
        for output in "a.exr", "b.exr", "hard.exr", "soft.exr", "sub/../b.exr":
            self.refused(1, "merge", "a.exr", "b.exr", "-o", "all.png", "-o", output,
                         words=[f"{output} is a part of this image: choose another file with -o"])
        self.assertEqual(before, [Path(self.path(name)).read_bytes() for name in ("a.exr", "b.exr")])
        self.ok("merge", "a.exr", "b.exr", "-o", "all.exr")

    def test_any_parts_in_any_order_and_what_is_missing(self):
        for name, samples in ("a", "0:4"), ("b", "4:6"), ("c", "8:10"), ("d", "5:8"):
            self.ok(*self.merge_key("--samples", samples, "-o", name + ".exr"))
        text = self.ok("merge", "c.exr", "a.exr", "-o", "some.exr").stderr
        self.assertIn("6 samples per pixel: 0:4,8:10", text)
        self.assertIn("missing: samples 4:8\n", text)
        self.refused(1, "merge", "a.exr", "b.exr", "d.exr", "-o", "x.exr", words=["d.exr: ", "overlap"])
        text = self.ok("merge", "a.exr", "b.exr", "d.exr", "c.exr", "-o", "most.exr", "--skip-overlaps").stderr
        self.assertIn("skipped d.exr: another part has its samples 5:6", text)
        self.assertIn(": 0:6,8:10", text)
        self.assertIn("missing: samples 6:8\n", text)

    def test_info_of_a_film(self):
        self.ok(*self.merge_key("--samples", "2:6", "-o", "a.exr", "--seed", "7"))
        info = json.loads(self.ok("info", "a.exr", "--json").stdout)
        self.assertEqual(info["size"], [9, 7])
        self.assertEqual(info["samples"], [[2, 6]])
        self.assertEqual((info["samples_per_pixel"], info["seed"], info["dropped_samples"]), (4, 7, 0))
        self.assertEqual(info["layers"], ["image"])
        self.assertIn("guiding=1", info["settings"])
        self.assertEqual(info["attributes"]["fathom.scene"], "box.json")
        # Samples have the values s * 7 % 16 / 16: 14, 5, 12 and 3 sixteenths.
        values = [x / 16 for x in (14, 5, 12, 3)]
        mean = sum(values) / 4
        error = (sum((x - mean) ** 2 for x in values) / 4 / 3) ** 0.5
        self.assertAlmostEqual(info["noise"]["mean"], mean, places=6)
        self.assertAlmostEqual(info["noise"]["standard_error"], error, places=6)
        text = self.ok("info", "a.exr").stdout
        self.assertRegex(text, r"samples +4 per pixel: 2:6\n")
        self.ok(*self.merge_key("--spp", "2", "-o", "plain.exr"))
        self.refused(1, "info", "plain.exr", words=["plain.exr: ", "--mergeable"])
        with open(self.path("a.exr"), "r+b") as file:
            file.seek(-3, os.SEEK_END)
            last = file.read(1)
            file.seek(-3, os.SEEK_END)
            file.write(bytes([last[0] ^ 1]))
        self.refused(1, "info", "a.exr", words=["a.exr: the file is damaged"])

    def test_samples_that_can_t_be_merged(self):
        self.assertIn("add -o FILE.exr", self.ok("render", "box.json", "--samples", "0:2", "-o", "a.png").stderr)
        self.assertNotIn("merged", self.ok("render", "box.json", "--samples", "0:2", "-o", "a.exr").stderr)


if __name__ == "__main__":
    run_tests()
