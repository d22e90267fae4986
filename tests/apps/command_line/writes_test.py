#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Tests that the program writes only the expected files. strace shows each name that is opened for writing."""
import os
import re
import shutil
import subprocess
import unittest

from harness import DOUBLE, CommandLine, run_tests, waiting

CALLS = "open,openat,openat2,creat,truncate,rename,renameat,renameat2,link,linkat,symlink,symlinkat,mkdir,mkdirat,unlink,unlinkat,rmdir"
# Exceptions: devices, names in /proc, and files of the thread sanitizer.
ALLOWED = re.compile(r"/dev/(null|tty)|/proc/self/(fd/\d+|task/\d+/comm)|/tmp/tsan\.rodata\.\d+")


def can_trace():
    return shutil.which("strace") and subprocess.run(["strace", "-o", "/dev/null", "true"], capture_output=True).returncode == 0


@unittest.skipUnless(can_trace(), "strace can't be used here")
class Writes(CommandLine):
    def written(self, *words):
        """Returns the real path of each file that was opened for writing, created, renamed or removed."""
        log = self.path("strace.log")
        environment = {**os.environ, "ASAN_OPTIONS": "detect_leaks=0"}
        waiting.run(["strace", "-f", "-qq", "-s", "4096", "-o", log, "-e", "trace=" + CALLS, DOUBLE, *words], cwd=self.folder, check=True,
                    env=environment)
        paths = set()
        with open(log) as lines:
            for line in lines:
                call = re.search(r"(\w+)\((.*)\) += ", line)
                if not call or "SIG" in line[:20]:
                    continue
                if call[1].startswith(("open", "creat")) and not re.search(r"O_WRONLY|O_RDWR|O_CREAT|O_TMPFILE", call[2]):
                    continue
                paths.update(re.findall(r'"([^"]*)"', call[2]))
        os.remove(log)
        return {os.path.normpath(os.path.join(self.folder, path)) for path in paths if not ALLOWED.fullmatch(path)}

    def check(self, allowed, *words):
        allowed = [os.path.realpath(self.path(name)) for name in allowed]
        folders = {os.path.dirname(path) for path in allowed}
        found = self.written(*words)
        self.assertTrue(found)
        for path in found:
            folder, name = os.path.split(path)
            of_these = any(re.fullmatch(rf"\.{re.escape(os.path.basename(a))}\.[0-9a-f]{{16}}\.part", name) for a in allowed)
            self.assertTrue(path in allowed or path in folders or (folder in folders and of_these), f"{words}: {path}")

    def test_render_writes_what_it_is_asked_for(self):
        os.mkdir(self.path("out"))
        words = ["render", "box.json", "--size", "9x7", "-o", "out/a.exr", "-o", "out/a.png", "--checkpoint", "out/film.exr"]
        names = ["out/a.exr", "out/a.png", "out/film.exr", "out/film.previous.exr"]
        self.check(names, *words, "--spp", "4")
        self.check(names, *words, "--spp", "8")

    def test_what_a_film_says_names_no_file(self):
        """Names of scenes and outputs that a film stores are printed, but never used as file names."""
        os.mkdir(self.path("out"))
        self.scene("..\u2215..\u2215x.json", "camera main")
        for i in "12":
            self.ok("render", "..\u2215..\u2215x.json", "--size", "9x7", "--spp", "4", "--part", f"{i}/2", "-o", f"{i}.exr")
        self.check(["out/all.exr", "out/all.png"], "merge", "1.exr", "2.exr", "-o", "out/all.exr", "-o", "out/all.png")
        self.assertEqual(self.written("info", "1.exr"), set())


if __name__ == "__main__":
    run_tests()
