# SPDX-License-Identifier: Apache-2.0
"""What the tests of the command line share: a folder of their own, how the program is run, small files.

Each is run as  THEME_test.py DOUBLE [PROGRAM [FAKE_OIDN]]
    DOUBLE     the program with the library of double.cpp behind it
    FAKE_OIDN  a stand-in for Open Image Denoise
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
# The leak check of a sanitized build needs a thread of its own; where a test takes that away, it can't run.
WITHOUT_LEAK_CHECK = {**os.environ, "ASAN_OPTIONS": "detect_leaks=0"}


def has_symbol(name):
    with open(DOUBLE, "rb") as file:
        return name in file.read()


def is_thread_sanitized():
    """The thread sanitizer has a thread of its own."""
    return has_symbol(b"__tsan_init")


def is_sanitized():
    """A sanitizer needs /proc, and memory of its own."""
    return is_thread_sanitized() or has_symbol(b"__asan_init")


def run_tests():
    unittest.main(argv=sys.argv[:1], verbosity=1)


def png_size(path):
    with open(path, "rb") as file:
        head = file.read(26)
    assert head[:8] == b"\x89PNG\r\n\x1a\n", head
    return struct.unpack(">II", head[16:24]) + (head[24], head[25])


class Gate:
    """At which samples of a scene with the word `gate` wait, or loading with `load-gate` (double.cpp)."""

    def __init__(self, test):
        # A folder of its own: tests look at all files of theirs.
        folder = tempfile.TemporaryDirectory()
        test.addCleanup(folder.cleanup)
        self.path = os.path.join(folder.name, "gate")

    def allow(self, count=10**9):
        """So many samples from the first one on; for loading, 1 is enough."""
        with open(self.path + ".part", "w") as file:
            file.write(str(count))
        os.replace(self.path + ".part", self.path)

    def step(self):
        """The number of the sample that waits, or None."""
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
        """A render, of 1,000 samples by default, that waits in the pass after so many, and its gate."""
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
        """What a process prints to standard error up to the line with this word, which is to come."""
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
