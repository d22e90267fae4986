#!/usr/bin/env python3
"""No floor of src/ includes one above it: reads every include and compares it with the table of docs/architecture.md.

usage: layers_test.py ROOT
"""
import pathlib
import re
import sys

root = pathlib.Path(sys.argv[1])

# What each folder of src/ may include beside itself and the public headers. The public headers include nothing below.
allowed = {
    "math": set(),
    "sampling": {"math"},
    "geometry": {"math"},
    "shading": {"math", "sampling"},
    "media": {"math", "sampling", "shading"},
    "guiding": {"math", "sampling"},
    "light": {"math", "sampling", "geometry", "shading"},
    "integrate": {"math", "sampling", "geometry", "shading", "media", "light", "guiding", "film"},
    "scene": set(),
    "image": {"scene"},
    "denoise": {"scene"},
    "film": {"scene", "math"},
    "film_file": {"film", "image", "scene", "math"},
    "import": {"scene"},
    "export": {"scene", "image", "import"},
    "compile": {"scene", "image", "math", "geometry", "shading", "media", "light", "integrate"},
    "session": {"compile", "film", "guiding", "integrate", "scene"},
}
# The one header of film that the kernel knows, and the ones of the kernel that its hosts know.
only = {
    ("integrate", "film"): {"film/tile_sums.h", "film/exact_sum.h"},
    ("compile", "integrate"): {"integrate/kernel.h", "integrate/tables.h", "integrate/camera_record.h"},
    ("film", "math"): {"math/memory.h"},
    ("film_file", "math"): {"math/memory.h"},
    ("film_file", "image"): {"image/exr_parts.h", "image/output_file.h"},
    ("export", "image"): {"image/output_file.h"},
    ("export", "import"): {"import/common/json.h", "import/common/read_file.h", "import/common/units.h"},
    ("session", "guiding"): {"guiding/records.h"},
    ("session", "integrate"): {"integrate/kernel.h"},
}


def findings():
    for path in sorted(root.glob("src/**/*.[hc]*")):
        if path.suffix not in (".h", ".cpp") or path.name.endswith("_test.cpp"):
            continue
        name = path.relative_to(root / "src").as_posix()
        floor = name.split("/")[0]
        for number, line in enumerate(path.read_text().splitlines(), 1):
            match = re.match(r'\s*#include "([^"]+)"', line)
            if not match:
                continue
            target = match[1]
            other = target.split("/")[0]
            where = f"src/{name}:{number}"
            if other in ("fathom", floor):
                continue
            if floor not in allowed:
                yield f"{where}: the folder src/{floor} is not in the table of this test"
            elif other not in allowed[floor]:
                yield f"{where}: src/{floor} must not know {target}"
            elif target not in only.get((floor, other), {target}):
                yield f"{where}: of src/{other}, src/{floor} may know only {', '.join(sorted(only[floor, other]))}"
    for path in sorted(root.glob("include/**/*.h")) + sorted(root.glob("apps/**/*.[hc]*")):
        for number, line in enumerate(path.read_text().splitlines(), 1):
            match = re.match(r'\s*#include "([^"]+)"', line)
            if match and match[1].split("/")[0] in allowed and not (path.parent / match[1]).exists():
                yield f"{path.relative_to(root)}:{number}: only public headers may be included here, not {match[1]}"


found = list(findings())
for line in found:
    print(line)
print(f"{len(found)} includes against the arrows")
sys.exit(1 if found else 0)
