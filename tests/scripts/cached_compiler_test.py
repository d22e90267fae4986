#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Tests cmake/cached_compiler.sh: ccache finds results of another clone, although precompiled headers differ by clone.

cached_compiler_test.py ROOT

Exit status 77 (skipped) without ccache or Clang."""
import os
import shutil
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

ROOT = Path(sys.argv[1]).resolve()
CLANG = next(filter(None, map(shutil.which, ("clang++", "clang++-19"))), None)
# It gets its header only from the precompiled one, so that only the header's checksum shows a change.
SOURCE = "int twice() { return 2 * number; }\n"


class Clone:
    """A folder with a header, a source file and the launcher, built as CMake's generator for Ninja does."""

    def __init__(self, folder, cache):
        self.folder, self.build = folder, folder / "build"
        self.environment = {**os.environ, "CCACHE_DIR": str(cache)}
        for name in [name for name in self.environment if name.startswith("CCACHE_") and name != "CCACHE_DIR"]:
            del self.environment[name]
        (folder / "cmake").mkdir(parents=True)
        (folder / "src").mkdir()
        self.build.mkdir()
        self.launcher = shutil.copy(ROOT / "cmake/cached_compiler.sh", folder / "cmake")
        self.write_header(21)
        (folder / "src/twice.cpp").write_text(SOURCE)
        (self.build / "pch.hxx").write_text('#include "numbers.h"\n')
        (self.build / "pch.hxx.cxx").write_text("")

    def write_header(self, number):
        (self.folder / "src/numbers.h").write_text(f"#pragma once\ninline int number = {number};\n")

    def compile(self, output, *arguments):
        command = [self.launcher, CLANG, f"-I{self.folder}/src", "-O1", "-Xclang", "-fno-pch-timestamp", "-Winvalid-pch",
                   *arguments, "-MD", "-MT", output, "-MF", output + ".d", "-o", output]
        subprocess.run(command, cwd=self.build, env=self.environment, check=True)

    def statistics(self):
        lines = subprocess.run(["ccache", "--print-stats"], env=self.environment, check=True, capture_output=True,
                               text=True).stdout.splitlines()
        counts = dict(line.split("\t") for line in lines)
        return {name: int(counts[name]) for name in ("direct_cache_hit", "preprocessed_cache_hit", "cache_miss")}

    def compile_all(self):
        """Compiles header and source. Returns whether the source was a "direct" hit, a "preprocessed" one or a "miss"."""
        header = f"{self.build}/pch.hxx"
        self.compile("pch.hxx.gch", "-fpch-instantiate-templates", "-Xclang", "-emit-pch", "-Xclang", "-include", "-Xclang",
                     header, "-x", "c++-header", "-c", header + ".cxx")
        before = self.statistics()
        self.compile("twice.o", "-Xclang", "-include-pch", "-Xclang", header + ".gch", "-Xclang", "-include", "-Xclang", header,
                     "-c", f"{self.folder}/src/twice.cpp")
        changed = [name for name, count in self.statistics().items() if count != before[name]]
        return " ".join(changed)

    def object(self):
        return (self.build / "twice.o").read_bytes()

    def number(self):
        """Returns the factor that the source is compiled with, by running a program that prints the result."""
        (self.build / "main.cpp").write_text("int twice(); int main() { return twice(); }\n")
        subprocess.run([CLANG, "main.cpp", "twice.o", "-o", "main"], cwd=self.build, check=True)
        return subprocess.run([self.build / "main"]).returncode // 2


class CachedCompiler(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        # Folders of different lengths, as clones have.
        self.first, self.second = (Clone(Path(folder.name).resolve() / name, Path(folder.name) / "cache")
                                   for name in ("first", "the second clone"))

    def expect(self, clone, found, number):
        self.assertEqual(clone.compile_all(), found)
        self.assertEqual(clone.number(), number)

    def test_a_second_clone_finds_the_result(self):
        self.expect(self.first, "cache_miss", 21)
        self.expect(self.second, "direct_cache_hit", 21)
        self.assertEqual(self.second.object(), self.first.object())

    def test_a_changed_header_is_compiled_again(self):
        self.expect(self.first, "cache_miss", 21)
        self.second.write_header(34)
        self.expect(self.second, "cache_miss", 34)
        self.expect(self.first, "direct_cache_hit", 21)

    def test_a_header_that_changes_back_is_found(self):
        for found, number in (("cache_miss", 21), ("cache_miss", 34), ("direct_cache_hit", 21)):
            self.first.write_header(number)
            self.expect(self.first, found, number)

    def test_compiler_errors_are_errors(self):
        (self.first.folder / "src/numbers.h").write_text("#error no numbers\n")
        with self.assertRaises(subprocess.CalledProcessError):
            self.first.compile_all()


if __name__ == "__main__":
    if not shutil.which("ccache") or not CLANG:
        print("skipped: ccache or clang++ was not found")
        sys.exit(77)
    unittest.main(argv=sys.argv[:1])
