#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Checks that docs/images/graphs contains the graphs that scripts/graphs.py draws from docs/measurements.

usage: graphs_test.py ROOT
"""
import json
import pathlib
import sys
import xml.etree.ElementTree

root = pathlib.Path(sys.argv[1])
sys.path.insert(0, str(root / "scripts"))
sys.dont_write_bytecode = True
import graphs  # noqa: E402


def findings():
    made = graphs.graphs(root)
    folder = root / "docs" / "images" / "graphs"
    for name, text in made.items():
        file = folder / name
        if not file.exists():
            yield f"{name} is missing: run scripts/graphs.py"
        elif file.read_text(encoding="utf-8") != text:
            yield f"{name} differs from what scripts/graphs.py makes: run it again"
        xml.etree.ElementTree.fromstring(text)
    for file in sorted(folder.glob("*.svg")):
        if file.name not in made:
            yield f"{file.name} is not made by scripts/graphs.py"
    for file in sorted((root / "docs" / "measurements").glob("*.json")):
        results = json.loads(file.read_text(encoding="utf-8"))
        if not (file.parent / results["page"]).exists():
            yield f"{file.name} names a page that does not exist: {results['page']}"
        for run in results["runs"]:
            for key in ("id", "date", "rows"):
                if not run.get(key):
                    yield f"{file.name}: a run without {key}"


found = list(findings())
for line in found:
    print(line)
sys.exit(1 if found else 0)
