#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Checks every include of src/ against the table of docs/architecture.md, which says which folder may include which.

A folder of src/ holds one noun; some have stages in layers of their own, such as compile. The longest prefix of a path
in `allowed` is its layer.

usage: layers_test.py ROOT
"""
import pathlib
import re
import sys

root = pathlib.Path(sys.argv[1])

# Lane code is compiled once per instruction set.
primitives = {"base", "math"}
lanes = primitives | {"sampling", "geometry", "textures", "materials", "media", "lights", "guiding", "film", "kernel"}
# The compile stages of all nouns run on the host and share compile/compiler.h.
stations = {"compile", "textures/compile", "materials/compile", "media/compile", "geometry/compile", "geometry/displacement",
            "lights/compile", "lights/sky", "lights/ies", "lights/tree/build_tree", "lights/environment/compile_environment",
            "lights/environment/studio"}
host = {"base", "scene", "image"}

# Layers that each layer may include besides itself and the public headers. Public headers include none of them.
allowed = {
    "base": set(),
    "math": {"base"},
    "sampling": {"math"},
    "geometry": primitives,
    "textures": primitives | {"materials"},
    "materials": primitives | {"sampling", "textures"},
    "media": {"math", "sampling"},
    "lights": primitives | {"sampling", "geometry", "textures"},
    "guiding": primitives | {"sampling"},
    "kernel": lanes,
    "kernel/library": {"base", "kernel"},
    "geometry/surface": lanes,
    "materials/read": lanes | {"geometry/surface"},
    "lights/sample": lanes | {"materials/read"},
    "integrate": lanes | {"geometry/surface", "materials/read", "lights/sample"},
    "scene": {"base"},
    "image": {"base", "scene"},
    "denoise": {"base", "scene"},
    "difference": {"base", "image"},
    "film": {"base", "scene"},
    "film/file": {"base", "film", "image"},
    "formats": {"base", "scene", "image"},
    "presentation": {"scene", "compile", "math", "lights/compile", "lights/environment/studio"},
    "session": {"compile", "film", "guiding", "kernel", "lights"},
}
for station in stations:
    allowed[station] = stations | host | lanes
# Single headers that a layer may include from another one.
only = {
    ("kernel", "film"): {"film/tile_sums.h", "film/exact_sum.h"},
    ("integrate", "film"): {"film/tile_sums.h", "film/exact_sum.h"},
    ("textures", "materials"): {"materials/records.h"},
    ("session", "kernel"): {"kernel/kernel.h"},
    ("kernel/library", "kernel"): {"kernel/kernel.h"},
    ("session", "guiding"): {"guiding/records.h"},
    ("session", "lights"): {"lights/records.h", "lights/kinds/records.h", "lights/targets.h"},
    ("presentation", "math"): {"math/luminance.h"},
    ("difference", "image"): {"image/color/primaries.h", "image/color/tonemap.h"},
    ("film/file", "image"): {"image/codecs/exr_parts.h"},
    ("presentation", "lights/compile"): {"lights/compile/kind.h"},
}
# Host code may include records, tables and the kernel's interface, but no lane code.
for station in stations:
    only[station, "kernel"] = {"kernel/kernel.h", "kernel/tables.h", "kernel/camera_record.h"}
    only[station, "materials"] = {"materials/records.h", "materials/closures/measured_tables.h"}
    only[station, "geometry"] = {"geometry/records.h", "geometry/shapes/curve.h"}
    only[station, "lights"] = {"lights/records.h", "lights/kinds/records.h"}
    only[station, "media"] = {"media/records.h"}

# Headers of src/ that the program may include besides the public ones: no user of the library needs them. Their functions
# are exported, but the headers are not installed.
program = {"base/text_file.h", "film/film_words.h"}
# Folders of apps/ that the Python package may include.
python_uses = {"commands", "options", "render", "report"}


def layer(name):
    """Returns the layer of a file or include by the longest prefix, or None if no folder of the table contains it.

    The sources of closures and of light kinds compile their records on the host; their headers are lane code.
    """
    if re.fullmatch(r"materials/closures/\w+\.cpp", name):
        return "materials/compile"
    if re.fullmatch(r"lights/kinds/\w+\.cpp", name):
        return "lights/compile"
    parts = re.sub(r"\.\w+$", "", name).split("/")
    for n in range(len(parts), 0, -1):
        prefix = "/".join(parts[:n])
        if prefix in allowed:
            return prefix
    return None


def includes(path):
    for number, line in enumerate(path.read_text().splitlines(), 1):
        match = re.match(r'\s*#include "([^"]+)"', line)
        if match:
            yield number, match[1]


def findings():
    for path in sorted(root.glob("src/**/*.[hc]*")):
        if path.suffix not in (".h", ".cpp"):
            continue
        name = path.relative_to(root / "src").as_posix()
        mine = layer(name)
        if mine is None:
            yield f"src/{name}: its folder is not in the table of this test"
            continue
        for number, target in includes(path):
            other = layer(target)
            where = f"src/{name}:{number}"
            if target.startswith("fathom/") or other == mine:
                continue
            if other not in allowed[mine]:
                yield f"{where}: {mine} must not include {target}"
            elif target not in only.get((mine, other), {target}):
                yield f"{where}: of {other}, {mine} may include only {', '.join(sorted(only[mine, other]))}"
    bindings = root / "python" / "src"
    for path in [*sorted(root.glob("include/**/*.h")), *sorted(root.glob("apps/**/*.[hc]*")), *sorted(bindings.glob("*.[hc]*"))]:
        for number, target in includes(path):
            if path.parent == bindings and target.split("/")[0] in python_uses:
                continue
            if path.is_relative_to(root / "apps") and target in program:
                continue
            if layer(target) and not (path.parent / target).exists() and not (root / "apps" / target).exists():
                yield f"{path.relative_to(root)}:{number}: only public headers may be included here, not {target}"


found = list(findings())
for line in found:
    print(line)
print(f"{len(found)} includes against the arrows")
sys.exit(1 if found else 0)
