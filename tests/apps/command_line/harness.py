# SPDX-License-Identifier: Apache-2.0
"""Shared by the tests of the command line: a folder for each test, functions that run the program, and small files.

usage: THEME_test.py DOUBLE [PROGRAM [FAKE_OIDN]]
    DOUBLE     the program with double.cpp in place of the library
    PROGRAM    the program with its library
    FAKE_OIDN  a fake of Open Image Denoise
"""
import os
import struct
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "support"))
import waiting  # noqa: E402

DOUBLE, PROGRAM, FAKE_OIDN = ([os.path.abspath(path) for path in sys.argv[1:4]] + [None] * 3)[:3]
# The leak check of a sanitized build needs a thread, so it can't run in tests that limit the number of threads.
WITHOUT_LEAK_CHECK = {**os.environ, "ASAN_OPTIONS": "detect_leaks=0"}


def has_symbol(name):
    with open(DOUBLE, "rb") as file:
        return name in file.read()


def is_thread_sanitized():
    """Whether the program is built with the thread sanitizer, which has a thread of its own."""
    return has_symbol(b"__tsan_init")


def is_sanitized():
    """Whether the program is built with a sanitizer, which needs /proc and additional memory."""
    return is_thread_sanitized() or has_symbol(b"__asan_init")


def run_tests():
    unittest.main(argv=sys.argv[:1], verbosity=1)


def png_size(path):
    with open(path, "rb") as file:
        head = file.read(26)
    assert head[:8] == b"\x89PNG\r\n\x1a\n", head
    return struct.unpack(">II", head[16:24]) + (head[24], head[25])


class Gate:
    """A gate at which samples of a scene with the word `gate` wait, or loading of one with `load-gate` (double.cpp)."""

    def __init__(self, test):
        # The gate has a folder of its own, because tests list all files of theirs.
        folder = tempfile.TemporaryDirectory()
        test.addCleanup(folder.cleanup)
        self.path = os.path.join(folder.name, "gate")

    def allow(self, count=10**9):
        """Lets the first `count` samples pass; for loading, 1 is enough."""
        with open(self.path + ".part", "w") as file:
            file.write(str(count))
        os.replace(self.path + ".part", self.path)

    def step(self):
        """Returns the number of the waiting sample, or None."""
        try:
            with open(self.path + ".waits") as file:
                return int(file.read())
        except FileNotFoundError:
            return None

    def wait(self, process, step):
        waiting.wait_for(f"the gate of sample {step}", lambda: self.step() == step, seen=self.step, stop=waiting.ended(process))


class CommandLine(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = folder.name
        self.scene("box.json", "camera main camera side")

    def scene(self, name, text):
        with open(os.path.join(self.folder, name), "w") as file:
            file.write(text)

    def path(self, name):
        return os.path.join(self.folder, name)

    def read(self, name):
        with open(self.path(name), "rb") as file:
            return file.read()

    def run_program(self, *arguments, program=None, **options):
        return waiting.run([program or DOUBLE, *arguments], cwd=self.folder, **options)

    def start_at_gate(self, samples, *arguments, words="", **options):
        """Starts a render, of 1,000 samples by default, and waits until it stops after `samples` samples; returns the
        process and its gate."""
        gate = Gate(self)
        gate.allow(samples)
        self.scene("gated.json", f"camera a gate {gate.path} {words}")
        options = {"cwd": self.folder, "stderr": subprocess.PIPE, "text": True, **options}
        spp = [] if "--spp" in arguments else ["--spp", "1000"]
        process = subprocess.Popen([DOUBLE, "render", self.path("gated.json"), *spp, *arguments], **options)
        self.end_at_the_end(process)
        gate.wait(process, samples)
        return process, gate

    def end_at_the_end(self, process):
        def end():
            if process.poll() is None:
                process.kill()
            process.wait()
            if process.stderr:
                process.stderr.close()
        self.addCleanup(end)

    def read_until(self, process, word):
        """Returns the standard error of a process up to the first line with this word; fails if there is none."""
        text = ""
        for line in process.stderr:
            text += line
            if word in line:
                return text
        self.fail(f"no '{word}': {text}")

    def ok(self, *arguments, **options):
        result = self.run_program(*arguments, **options)
        self.assertEqual(result.returncode, 0, result.stderr)
        return result

    def refused(self, code, *arguments, words=(), **options):
        before = sorted(os.listdir(self.folder))
        result = self.run_program(*arguments, **options)
        self.assertEqual(result.returncode, code, f"{arguments}: {result.stderr}")
        lines = [line for line in result.stderr.splitlines() if not line.startswith("fathom: warning: ")]
        self.assertEqual(len(lines), 1, f"{arguments}: {result.stderr}")
        self.assertTrue(lines[0].startswith("fathom: "), lines[0])
        for word in words:
            self.assertIn(word, lines[0])
        self.assertEqual(sorted(os.listdir(self.folder)), before, "a file was left")
        return result
