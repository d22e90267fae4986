# SPDX-License-Identifier: Apache-2.0
"""Tests the pages of docs/farm: their references exist, and each page has the two commands."""
import re
import unittest

from harness import FARM, ROOT

PAGES = ROOT / "docs" / "farm"


class Documents(unittest.TestCase):
    def test_each_page_has_both_commands(self):
        for name in "kubernetes", "openjd", "opencue", "aws-batch", "ssh", "dask":
            text = (PAGES / f"{name}.md").read_text()
            for words in ("fathom render", "--part", "--checkpoint", "fathom merge"):
                self.assertIn(words, text, name)
            self.assertIn(f"({name}.md)", (PAGES / "README.md").read_text())

    def test_files_that_pages_name_are_there(self):
        for page in PAGES.glob("*.md"):
            for name in re.findall(r"\bfarm/[\w./-]+\w", page.read_text()):
                self.assertTrue((ROOT / name).exists() or (ROOT / "docs" / name).exists(), f"{page.name}: {name}")
            for link in re.findall(r"\]\(([^)#:]+)[^):]*\)", page.read_text()):
                self.assertTrue((PAGES / link).exists(), f"{page.name}: {link}")

    def test_every_folder_has_a_page(self):
        for folder in FARM.iterdir():
            if folder.is_dir():
                self.assertTrue((PAGES / f"{folder.name}.md").exists(), folder.name)
