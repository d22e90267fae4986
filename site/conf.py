# SPDX-License-Identifier: Apache-2.0
"""Settings of the documentation's site for Sphinx; scripts/site.sh builds it.

The pages are the documents of the repository as they are. Three additions are made while they are read: tables of contents
(navigation.md), docstrings of the package `fathom` (docs/python-reference.md), and their lists of parameters.
"""
import pathlib
import re

ROOT = pathlib.Path(__file__).resolve().parents[1]

project = "Fathom"
author = copyright = "the authors of Fathom"
version = release = re.search(r"project\(fathom VERSION ([0-9.]+)", (ROOT / "CMakeLists.txt").read_text(encoding="utf-8"))[1]

extensions = ["myst_parser", "sphinx.ext.autodoc"]
root_doc = "README"
include_patterns = ["*.md", "docs/**.md", "bench/README.md", "bench/compare/README.md", "bench/scaling/README.md",
                    "examples/README.md", "scenes/README.md", "tests/README.md"]
exclude_patterns = ["build"]

myst_enable_extensions = ["html_image"]
myst_heading_anchors = 6
highlight_language = "none"

# Inherited members are shown, but not those of Python's own classes.
autodoc_default_options = {"members": True, "inherited-members": "BaseException,Exception,Mapping,object"}
autodoc_member_order = "bysource"

html_theme = "furo"
html_title = f"Fathom {version}"
html_copy_source = html_show_sourcelink = html_show_sphinx = False
html_static_path = ["site.css"]
html_css_files = ["site.css"]

FIRST_PAGE_OF_FOLDER = re.compile(r"(docs/\w+|bench)/README")
OTHER_PAGES = """
```{{toctree}}
:hidden:
:glob:

{pages}
```
"""
PARAMETER = re.compile(r"^(\w+(?:, \w+)*) : ")


def add_contents(app, name, source):
    """Appends the tables of contents to the first page, and the other pages of a folder to its README.md."""
    if name == root_doc:
        source[0] += "\n" + (ROOT / "site/navigation.md").read_text(encoding="utf-8")
    elif FIRST_PAGE_OF_FOLDER.fullmatch(name):
        source[0] += OTHER_PAGES.format(pages="compare/README\nscaling/README" if name.startswith("bench") else "*")


def list_parameters(app, what, name, thing, options, lines):
    """Turns the lines `name : description` of a docstring into a list of parameters."""
    lines[:] = [PARAMETER.sub(lambda match: f":param {match[1].replace(' ', '')}: ", line) for line in lines]


def setup(app):
    app.connect("source-read", add_contents)
    app.connect("autodoc-process-docstring", list_parameters)
