#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Tests of the command line: limits on memory and threads, --memory and --nice."""
import json
import os
import re
import shutil
import subprocess
import unittest

from harness import DOUBLE, PROGRAM, CommandLine, is_sanitized, is_thread_sanitized, run_tests

BALL = json.dumps({"fathom": 1, "camera": {"position": [0, 0, 4], "look_at": [0, 0, 0]}, "environment": {"kind": "gradient"},
                   "scene": [{"sphere": {"radius": 1}}]})


class Limits(CommandLine):
    def started(self, *words):
        """Starts a program and returns it when it renders; it is ended after the test."""
        process = subprocess.Popen(words, cwd=self.folder, stderr=subprocess.PIPE, text=True)
        self.addCleanup(process.stderr.close)
        self.addCleanup(process.wait)
        self.addCleanup(process.kill)
        for line in process.stderr:
            if '"event":"progress"' in line:
                break
        return process

    def test_what_is_too_large_is_refused_by_name(self):
        self.refused(1, "render", "box.json", "--size", "8192x8192", "--memory", "8G", "-o", "a.exr",
                     words=["box.json: needs about ", "film of 8192x8192 6.4", "--memory allows 8 GB"])
        self.scene("rich.json", "camera main texture a texture b")
        self.refused(1, "render", "rich.json", "--size", "64x64", "--memory", "512M", "-o", "a.png",
                     words=["(textures 600", "--memory allows 512 MB"])
        self.ok("render", "rich.json", "--size", "64x64", "--spp", "1", "--memory", "1.5GiB", "-o", "a.png")

    def test_each_use_of_a_film_counts(self):
        def needed(*options):
            message = self.refused(1, "render", "box.json", "--size", "4096x4096", "--memory", "1M", *options).stderr
            return float(re.search(r"needs about ([\d.]+) GB", message)[1])
        plain = needed("-o", "a.exr")
        for more, options in ((1.4, ["--mergeable"]), (1.4, ["--checkpoint", "c.exr"]), (2.8, ["--mergeable", "--checkpoint", "c.exr"]),
                              (0.5, ["--aov", "albedo"]), (0.2, ["--aov", "variance"]), (0.4, ["-o", "a.webp"])):
            self.assertGreaterEqual(round(needed("-o", "a.exr", *options) - plain, 3), more, options)

    def test_other_commands_keep_it_too(self):
        self.ok("render", "box.json", "--size", "64x48", "--spp", "4", "--mergeable", "-o", "a.exr")
        self.refused(1, "merge", "a.exr", "-o", "b.exr", "--memory", "1M", words=["a.exr: needs about", "--memory allows 1 MB"])
        self.ok("merge", "a.exr", "-o", "b.exr", "--memory", "1G")
        self.refused(1, "info", "a.exr", "--memory", "1K", words=["its film needs", "allowed by --memory"])
        self.ok("info", "box.json", "--memory", "1G")

    def test_sizes(self):
        for text in "8", "G", "8Q", "-1G", "8 G", "0G", "1.5.5G", "1e99G", "GB":
            self.refused(2, "render", "box.json", "--memory=" + text, words=["--memory: expected a"])
        for text, allowed in ("2GB", "2 GB"), ("2GiB", "2.1 GB"), ("2Gi", "2.1 GB"), ("1500M", "1.5 GB"), ("2000000K", "2 GB"):
            self.refused(1, "render", "box.json", "--size", "8192x8192", "--memory", text, words=[f"allows {allowed}\n"[:-1]])

    @unittest.skipUnless(PROGRAM and os.path.exists(PROGRAM), "no program given")
    def test_the_limit_is_kept(self):
        """A film of 1,000 x 1,000 pixels, written as image, film and checkpoint, is refused with less memory than it
        needs, and stays within the limit otherwise."""
        if is_sanitized():
            self.skipTest("a sanitizer takes memory of its own")
        self.scene("ball.json", BALL)
        words = ["render", "ball.json", "--size", "1000x1000", "--spp", "2", "-o", "a.exr", "-o", "a.png", "--checkpoint", "c.exr"]
        message = self.run_program(*words, "--memory", "20M", program=PROGRAM).stderr
        needed = int(re.search(r"needs about (\d+) MB", message)[1]) + 3  # libraries take a varying number of MB
        self.refused(1, *words, "--memory", f"{needed - 20}M", program=PROGRAM)
        result = self.run_program(*words, "--memory", f"{needed}M", "--progress", "json", program=PROGRAM)
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertLess(json.loads(result.stderr.splitlines()[-1])["peak_memory_bytes"], needed * 1e6)

    def test_nice(self):
        self.refused(2, "render", "box.json", "--nice", "20", words=["--nice", "0 to 19"])
        self.refused(2, "render", "box.json", "--nice", "-1", words=["--nice"])
        nice = os.getpriority(os.PRIO_PROCESS, 0)
        process, _ = self.start_at_gate(1, "--size", "4x4", "--nice", "3")
        self.assertEqual(os.getpriority(os.PRIO_PROCESS, process.pid), min(nice + 3, 19))

    @unittest.skipUnless(PROGRAM and os.path.exists(PROGRAM) and shutil.which("taskset"), "no program, or no taskset")
    def test_affinity(self):
        """The program uses a single thread if it may use only one core."""
        self.scene("ball.json", BALL)
        core = str(min(os.sched_getaffinity(0)))
        process = self.started("taskset", "-c", core, PROGRAM, "render", "ball.json", "--size", "400x300", "--spp", "1000000",
                               "--progress", "json")
        self.assertEqual(len(os.listdir(f"/proc/{process.pid}/task")), 1 + is_thread_sanitized())


if __name__ == "__main__":
    run_tests()
