#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Builds the documentation's site by scripts/site.sh and checks its pages.

usage: site_test.py ROOT PACKAGE [SITE]      PACKAGE: folder with the Python package; SITE: a finished site to check instead

Exit status 77, which ctest shows as skipped, if the Python package is not built or the site's packages can't be installed.
"""
import html.parser
import inspect
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest
from urllib.parse import unquote, urlsplit

ROOT, PACKAGE = (pathlib.Path(argument).resolve() for argument in sys.argv[1:3])
SITE = pathlib.Path(sys.argv[3]).resolve() if len(sys.argv) > 3 else None
SKIPPED = 77
# Attributes that name something that the browser loads by itself.
LOADED = {("script", "src"), ("img", "src"), ("iframe", "src"), ("source", "src"), ("link", "href")}
# Pages that Sphinx makes; they have no place in the navigation.
GENERATED = {"genindex.html", "search.html", "index.html"}


class Page(html.parser.HTMLParser):
    """Links, anchors and text of a page."""

    def __init__(self, text):
        super().__init__()
        self.links, self.loaded, self.anchors, self.navigation, self.words = [], [], set(), [], []
        self.has_viewport, self._in_navigation = False, False
        self.feed(text)

    def handle_starttag(self, tag, attributes):
        attributes = dict(attributes)
        self.anchors |= {attributes[key] for key in ("id", "name") if attributes.get(key)}
        self.has_viewport |= attributes.get("name") == "viewport" and "width=device-width" in attributes.get("content", "")
        if attributes.get("class", "") == "sidebar-tree":
            self._in_navigation = True
        for key in "href", "src":
            if key in attributes and (tag, key) in LOADED:
                self.loaded.append(attributes[key])
            elif key in attributes:
                self.links.append(attributes[key])
                if self._in_navigation:
                    self.navigation.append(attributes[key])

    def handle_endtag(self, tag):
        if tag == "aside":
            self._in_navigation = False

    def handle_data(self, data):
        self.words.append(data)


def pages():
    return {file: Page(file.read_text(encoding="utf-8")) for file in sorted(SITE.rglob("*.html"))}


def is_elsewhere(link):
    parts = urlsplit(link)
    return bool(parts.netloc) or parts.scheme in ("http", "https", "mailto")


def plain(text):
    """The letters and digits of a text."""
    return re.sub(r"\W+", "", text)


def summary(docstring):
    """The first sentence of a docstring, without markup."""
    first = re.split(r"\.(?:\s|$)|\n\s*\n|:\s", inspect.cleandoc(docstring), maxsplit=1)[0]
    return plain(re.sub(r":\w+:`~?([^`]*)`", r"\1", first))


def public_members(thing):
    """(name, docstring) of the documented public members of a class, with those that it inherits in the package."""
    for name in dir(thing):
        owner = next((kind for kind in thing.__mro__ if name in vars(kind)), None)
        is_own = owner and owner.__module__.startswith("fathom")
        if not name.startswith("_") and is_own and inspect.getdoc(getattr(thing, name)):
            yield name, inspect.getdoc(inspect.getattr_static(thing, name))


class Site(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.pages = pages()

    def test_each_link_leads_somewhere(self):
        broken = []
        for file, page in self.pages.items():
            for link in page.links + page.loaded:
                if is_elsewhere(link):
                    continue
                parts = urlsplit(link)
                target = (file.parent / unquote(parts.path)).resolve() if parts.path else file
                if not target.is_file():
                    broken.append(f"{file.relative_to(SITE)}: {link}: no such file")
                elif parts.fragment and target in self.pages and unquote(parts.fragment) not in self.pages[target].anchors:
                    broken.append(f"{file.relative_to(SITE)}: {link}: no such anchor")
        self.assertEqual([], broken, "\n" + "\n".join(broken))

    def test_nothing_is_loaded_from_elsewhere(self):
        for file, page in self.pages.items():
            self.assertEqual([], [link for link in page.loaded if is_elsewhere(link)], file)
        for file in SITE.rglob("*.css"):
            elsewhere = re.findall(r"(?:@import\s+|url\()[\"']?(?:https?:)?//[^)\"']*", file.read_text(encoding="utf-8"))
            self.assertEqual([], elsewhere, file)

    def test_pages_are_made_for_phones_too(self):
        for file, page in self.pages.items():
            self.assertTrue(page.has_viewport, file)

    def test_each_document_has_a_page_in_the_navigation(self):
        first = SITE / "index.html"
        reached = {(SITE / urlsplit(link).path).resolve() for link in self.pages[first].navigation}
        documents = {file.relative_to(ROOT).with_suffix(".html") for file in (ROOT / "docs").rglob("*.md")}
        missing = sorted(str(name) for name in documents if SITE / name not in reached)
        self.assertEqual([], missing, "no entry in site/navigation.md for these")
        others = sorted(str(file.relative_to(SITE)) for file in self.pages if file not in reached)
        self.assertEqual(sorted([*GENERATED, "README.html"]), others)

    def test_the_search_knows_each_page(self):
        index = (SITE / "searchindex.js").read_text(encoding="utf-8")
        names = set(re.search(r'"?docnames"?:\s*\[([^\]]*)\]', index)[1].replace('"', "").replace(" ", "").split(","))
        made = {str(file.relative_to(SITE).with_suffix("")) for file in self.pages if file.name not in GENERATED}
        self.assertEqual(made, names)
        self.assertIn("firefli", index)

    def test_the_reference_of_python_has_each_docstring(self):
        sys.path.insert(0, str(PACKAGE))
        import fathom
        page = self.pages[SITE / "docs" / "python-reference.html"]
        text = plain("".join(page.words))
        for name in fathom.__all__:
            thing = getattr(fathom, name)
            if inspect.ismodule(thing):
                continue
            anchor = f"{thing.__module__}.{name}" if f"fathom.{name}" not in page.anchors else f"fathom.{name}"
            documented = [(anchor, inspect.getdoc(thing) or "")]
            if inspect.isclass(thing):
                documented += [(f"{anchor}.{member}", docstring) for member, docstring in public_members(thing)]
            for entry, docstring in documented:
                with self.subTest(entry):
                    self.assertIn(entry, page.anchors)
                    self.assertIn(summary(docstring), text)


def build_and_check():
    """Builds the site and runs these tests in its virtual environment, where the package can be imported."""
    if not list(PACKAGE.glob("fathom/_fathom*.so")):
        print("skipped: the Python package is not built")
        return SKIPPED
    with tempfile.TemporaryDirectory() as folder:
        site = pathlib.Path(folder) / "site"
        command = [ROOT / "scripts" / "site.sh", "--output", site, "--package", PACKAGE]
        status = subprocess.run(command, env={**os.environ, "PYTHON": sys.executable}).returncode
        if status:
            return status
        return subprocess.run([ROOT / "build" / "site-tools" / "bin" / "python", __file__, ROOT, PACKAGE, site]).returncode


if __name__ == "__main__":
    if SITE is None:
        sys.exit(build_and_check())
    unittest.main(argv=sys.argv[:1])
