#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Tests scripts/link_stub.py: makes a library with symbols of two versions, a stub of it for the older one, and links with it.

usage: link_stub_test.py ROOT COMPILER
"""
import pathlib
import shutil
import subprocess
import sys
import tempfile
import unittest

ROOT, COMPILER = pathlib.Path(sys.argv[1]).resolve(), sys.argv[2]

# `both` exists in two versions, of which 1.10 is newer than 1.9; `late` came with 1.10, and `table` is data.
LIBRARY = """
    extern "C" int both_old() { return 1; }
    extern "C" int both_new() { return 2; }
    extern "C" int late() { return 3; }
    extern "C" int hidden_one() { return 4; }
    extern "C" int table[5] = {10, 20, 30, 40, 50};
    __asm__(".symver both_old, both@LIB_1.9");
    __asm__(".symver both_new, both@@LIB_1.10");
"""
VERSIONS = "LIB_1.9 { global: both; table; local: *; }; LIB_1.10 { global: both; late; } LIB_1.9; LIB_PRIVATE { global: hidden_one; } LIB_1.10;"


class LinkStub(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        (self.folder / "real").mkdir()
        (self.folder / "stub").mkdir()
        (self.folder / "versions").write_text(VERSIONS)
        self.compile(LIBRARY, "real/libx.so.1", "-shared", "-fPIC", "-Wl,-soname,libx.so.1", f"-Wl,--version-script={self.folder}/versions")

    def compile(self, source, output, *options, check=True):
        (self.folder / "source.cpp").write_text(source)
        result = subprocess.run([COMPILER, self.folder / "source.cpp", "-o", self.folder / output, *options], capture_output=True, text=True)
        if check:
            self.assertEqual(result.returncode, 0, result.stderr)
        return result.returncode == 0

    def make_stub(self, *versions):
        subprocess.run([sys.executable, ROOT / "scripts/link_stub.py", COMPILER, self.folder / "real/libx.so.1", self.folder / "stub/libx.so.1",
                        *versions], check=True)

    def result(self, source, check=True):
        """Links a program with the stub, and runs it with the real library. None if it can't be linked."""
        if not self.compile(source, "program", self.folder / "stub/libx.so.1", f"-Wl,-rpath,{self.folder}/real", check=check):
            return None
        return subprocess.run([self.folder / "program"]).returncode

    def test_the_older_version_is_linked(self):
        program = 'extern "C" int both(); int main() { return both(); }'
        self.make_stub("LIB=1.9")
        self.assertEqual(self.result(program), 1)
        self.make_stub("LIB=1.10")
        self.assertEqual(self.result(program), 2)

    def test_what_came_later_is_missing(self):
        self.make_stub("LIB=1.9")
        self.assertIsNone(self.result('extern "C" int late(); int main() { return late(); }', check=False))
        self.make_stub("LIB=1.10")
        self.assertEqual(self.result('extern "C" int late(); int main() { return late(); }'), 3)
        self.assertIsNone(self.result('extern "C" int hidden_one(); int main() { return hidden_one(); }', check=False))

    def test_data_has_its_size(self):
        self.make_stub("LIB=1.9")
        # A program that isn't position-independent copies the data, of the size that the stub has.
        self.assertTrue(self.compile('extern "C" int table[5]; int main() { return table[4]; }', "program", self.folder / "stub/libx.so.1",
                                     "-no-pie", "-fno-pie", f"-Wl,-rpath,{self.folder}/real"))
        self.assertEqual(subprocess.run([self.folder / "program"]).returncode, 50)


if __name__ == "__main__":
    if not shutil.which("readelf"):
        print("skipped: readelf is not there")
        sys.exit(77)
    unittest.main(argv=sys.argv[:1])
