#!/usr/bin/env python3
"""Tests scripts/spdx.py: it adds license lines in the right places, and no file of this project lacks one.

usage: spdx_test.py ROOT

Exit status 77 (skipped) if ROOT is not a git repository."""
import contextlib
import io
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

ROOT = Path(sys.argv[1]).resolve()
sys.path.insert(0, str(ROOT / "scripts"))
sys.dont_write_bytecode = True
import spdx as script  # noqa: E402

LINE = "SPDX-License-Identifier: Apache-2.0"


def spdx(*arguments):
    """Returns (exit status, output) of scripts/spdx.py with these arguments."""
    output = io.StringIO()
    with contextlib.redirect_stdout(output), contextlib.redirect_stderr(output):
        status = script.main([str(argument) for argument in arguments])
    return status, output.getvalue()


class ScratchRepository(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.root = Path(folder.name)
        self.git("init", "--quiet")

    def git(self, *words):
        subprocess.run(["git", "-C", str(self.root), *words], check=True, capture_output=True)

    def put(self, name, text):
        path = self.root / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(text.encode())
        self.git("add", "--force", name)

    def check_fixed(self, name, before, after):
        self.put(name, before)
        self.assertEqual(spdx("--check", self.root)[0], 1)
        for _ in range(2):  # the second time changes nothing
            self.assertEqual(spdx("--fix", self.root)[0], 0)
            self.assertEqual((self.root / name).read_bytes().decode(), after)
        self.assertEqual(spdx("--check", self.root)[0], 0)

    def check_unchanged(self, name, text):
        self.put(name, text)
        self.assertEqual(spdx("--check", self.root)[0], 0)
        spdx("--fix", self.root)
        self.assertEqual((self.root / name).read_bytes().decode(), text)

    def test_comments_of_each_language(self):
        for name in ["src/a.h", "src/a.cpp", "bench/a.c"]:
            self.check_fixed(name, "#pragma once\n", f"// {LINE}\n#pragma once\n")
        for name in ["a/CMakeLists.txt", "cmake/a.cmake"]:
            self.check_fixed(name, "set(x 1)\n", f"# {LINE}\nset(x 1)\n")

    def test_a_shebang_stays_first(self):
        self.check_fixed("a.sh", "#!/bin/sh\necho\n", f"#!/bin/sh\n# {LINE}\necho\n")
        self.check_fixed("run", "#!/usr/bin/env bash\necho\n", f"#!/usr/bin/env bash\n# {LINE}\necho\n")
        self.check_fixed("b.sh", "#!/bin/sh", f"#!/bin/sh\n# {LINE}\n")

    def test_a_coding_line_stays_in_front(self):
        self.check_fixed("a.py", "#!/usr/bin/env python3\n# -*- coding: utf-8 -*-\nx = 1\n",
                         f"#!/usr/bin/env python3\n# -*- coding: utf-8 -*-\n# {LINE}\nx = 1\n")

    def test_line_ends_are_kept(self):
        self.check_fixed("a.h", "int a;\r\nint b;\r\n", f"// {LINE}\r\nint a;\r\nint b;\r\n")

    def test_an_empty_file(self):
        self.check_fixed("__init__.py", "", f"# {LINE}\n")

    def test_another_license_is_kept(self):
        self.check_unchanged("other.h", "// SPDX-License-Identifier: BSD-3-Clause\nint a;\n")

    def test_generated_tables_are_left_out(self):
        self.check_unchanged("table.h", "#pragma once\n/// Made by tools/table.py: rows.\nint a;\n")

    def test_data_is_left_out(self):
        for name in ["tests/golden/scenes/a.json", "tests/golden/scenes/a.h", "tests/planted/rules/a.json", "scenes/a.json",
                     "README.md", "notes"]:
            self.check_unchanged(name, "int a;\n")

    def test_files_that_git_does_not_track_are_left_out(self):
        (self.root / "loose.h").write_text("int a;\n")
        self.assertEqual(spdx("--check", self.root)[0], 0)

    def test_a_missing_line_is_reported_with_its_file(self):
        self.put("src/a.h", "int a;\n")
        self.assertIn("src/a.h: no line", spdx(self.root)[1])


class NoRepository(unittest.TestCase):
    def test_skips(self):
        with tempfile.TemporaryDirectory() as folder:
            self.assertEqual(spdx("--check", folder)[0], 77)


class Project(unittest.TestCase):
    def test_every_source_file_has_a_license_line(self):
        status, output = spdx("--check", ROOT)
        self.assertEqual(status, 0, output)


if __name__ == "__main__":
    if spdx("--check", ROOT)[0] == 77:
        print(f"{ROOT} is not a git repository, or git is not installed: skipped")
        sys.exit(77)
    unittest.main(argv=sys.argv[:1])
