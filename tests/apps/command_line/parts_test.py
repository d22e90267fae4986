#!/usr/bin/env python3
"""The command line: parts of a picture, and merging them."""
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
        self.assertIn("16 samples a pixel: 0:16", result.stderr)
        with open(self.path("whole.png"), "rb") as one, open(self.path("all.png"), "rb") as other:
            self.assertEqual(one.read(), other.read())
        # What is merged can be merged again.
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

    def test_merge_overwrites_no_part(self):
        for name, range_ in ("a.exr", "0:2"), ("b.exr", "2:4"):
            self.ok("render", "box.json", "--size", "8x4", "--samples", range_, "-o", name)
        os.link(self.path("b.exr"), self.path("hard.exr"))
        os.symlink("a.exr", self.path("soft.exr"))
        os.mkdir(self.path("sub"))
        before = [Path(self.path(name)).read_bytes() for name in ("a.exr", "b.exr")]
        for output in "a.exr", "b.exr", "hard.exr", "soft.exr", "sub/../b.exr":
            self.refused(1, "merge", "a.exr", "b.exr", "-o", "all.png", "-o", output,
                         words=[f"{output} is a part of this picture: name another with -o"])
        self.assertEqual(before, [Path(self.path(name)).read_bytes() for name in ("a.exr", "b.exr")])
        self.ok("merge", "a.exr", "b.exr", "-o", "all.exr")

    def test_samples_that_can_t_be_merged(self):
        self.assertIn("add -o FILE.exr", self.ok("render", "box.json", "--samples", "0:2", "-o", "a.png").stderr)
        self.assertNotIn("merged", self.ok("render", "box.json", "--samples", "0:2", "-o", "a.exr").stderr)


if __name__ == "__main__":
    run_tests()
