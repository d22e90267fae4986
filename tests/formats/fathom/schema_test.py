#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Checks scene files, and the program's saved versions of them, against docs/scene.schema.json.  schema_test.py ROOT PROGRAM  Exit code 77 (skipped) without Python's jsonschema."""
import json
import pathlib
import subprocess
import sys
import tempfile

try:
    import jsonschema
except ImportError:
    print("Python's jsonschema is not installed: skipped")
    sys.exit(77)

root = pathlib.Path(sys.argv[1])
schema = json.loads((root / "docs/scene.schema.json").read_text())
jsonschema.Draft202012Validator.check_schema(schema)
validator = jsonschema.Draft202012Validator(schema)
failures = 0


def expect(good, name, scene):
    global failures
    errors = [f"{'/'.join(map(str, e.path))}: {e.message[:200]}" for e in validator.iter_errors(scene)]
    if good != (not errors):
        failures += 1
        print(name, "must be refused, and isn't" if not good else errors)


scenes = sorted((root / "scenes").glob("*.json"))
assert len(scenes) >= 3
for path in scenes:
    expect(True, path.name, json.loads(path.read_text()))
converted = sorted([*scenes, *root.glob("tests/golden/scenes/*.json"), *root.glob("tests/golden/scenes/*.gl*")])
with tempfile.TemporaryDirectory() as folder:
    for path in converted:
        written = pathlib.Path(folder) / "scene.json"
        subprocess.run([sys.argv[2], "convert", path, written, "--quiet"], check=True)
        expect(True, f"what is written of {path.name}", json.loads(written.read_text()))
# The importer rejects these as well, see fathom_json_errors_test.cpp.
for bad in ({"sceen": []}, {"fathom": 2}, {"materials": {"red": {"colr": 1}}}, {"materials": {"m": {"kind": "mirror"}}},
            {"materials": {"m": {"kind": "glass", "fuzz": 1}}}, {"materials": {"m": {"color": [1, 0, 2]}}},
            {"camera": {"position": [1, 2]}}, {"camera": {"fov_y_deg": 180}}, {"camera": {}, "cameras": {}},
            {"render": {"size": [0, 600]}}, {"render": {"samples": 2.5}}, {"scene": [{"sphere": {"radius": 0}}]},
            {"scene": [{"rectangle": {"corner": [0, 0, 0]}}]}, {"scene": [{"sphere": {}, "model": "a.glb"}]},
            {"scene": [{"sphere": {}, "materials": {}}]}, {"scene": [{"material": "red"}]},
            {"lights": {"l": {"kind": "point", "unit": "lx"}}}, {"lights": {"l": {"kind": "goniometric"}}},
            {"lights": {"l": {"kind": "projector", "fov_deg": 180}}}, {"lights": {"l": {"kind": "point", "image": "a.png"}}}):
    expect(False, json.dumps(bad), bad)
sys.exit(1 if failures else 0)
