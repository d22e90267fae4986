#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Tests scripts/gallery.sh: a page of all models of a folder, even if one of them is broken.

gallery_test.py ROOT PROGRAM
"""
import os
import re
import sys
import tempfile
import unittest
import urllib.parse
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
import waiting  # noqa: E402

ROOT, PROGRAM = (os.path.abspath(path) for path in sys.argv[1:3])


class Gallery(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)

    def run_gallery(self, *arguments):
        return waiting.run([ROOT + "/scripts/gallery.sh", *arguments], cwd=self.folder,
                           env={**os.environ, "FATHOM": PROGRAM, "FATHOM_OIDN": "/nowhere"})

    def test_a_page_of_all_models(self):
        models = self.folder / "my models"
        (models / "deeper").mkdir(parents=True)
        square = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n"
        (models / "a & b%.obj").write_text(square)
        (models / "deeper/tent.OBJ").write_text(square + "v 0 0 1\nf 1 2 5\n")
        (models / "wrong.gltf").write_text('{"asset": {"version": "2.0"}, "scenes": [')
        (models / "notes.txt").write_text("no model")
        result = self.run_gallery("my models", "-o", "page", "--spp", "2", "--size", "40x30")
        self.assertEqual(result.returncode, 1, result.stderr)  # the broken model makes it fail
        page = (self.folder / "page/index.html").read_text()
        figures = re.findall(r"<figure>.*?</figure>", page, re.DOTALL)
        self.assertEqual([re.search(r"<b>(.*?)</b>", figure)[1] for figure in figures],
                         ["a &amp; b%.obj", "deeper/tent.OBJ", "wrong.gltf"])
        for figure, triangles in zip(figures, (2, 3)):
            picture = urllib.parse.unquote(re.search(r'src="(.*?)"', figure)[1])
            self.assertTrue((self.folder / "page" / picture).read_bytes().startswith(b"\xff\xd8"), picture)
            self.assertIn(f"{triangles} triangles", figure)
            self.assertRegex(figure, r"load [\d.]+ s, render [\d.]+ s")
            self.assertIn("added a studio", figure)
        self.assertNotIn("src=", figures[2])
        self.assertRegex(figures[2], r'class="error">wrong.gltf: line 1')
        self.assertIn("3 models at 2 samples a pixel; 1 could not be rendered", page)

    def test_a_folder_without_models(self):
        result = self.run_gallery(".")
        self.assertEqual(result.returncode, 1)
        self.assertEqual(result.stderr, "gallery: there are no models in .\n")
        self.assertFalse((self.folder / "gallery").exists())


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=1)
