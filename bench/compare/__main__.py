# SPDX-License-Identifier: Apache-2.0
"""Compares Fathom with Mitsuba 3, Cycles, LuxCore and pbrt-v4: error over time, tables and images on one page.

usage: python3 bench/compare [--scenes NAME...] [--renderers NAME...] [--pbrt BINARY] [--seconds N] [-o FOLDER]

The first call makes virtual environments with pinned packages from PyPI (Python 3.11 for Cycles; Mitsuba needs a LLVM library,
16 or later). Each scene is rendered by all renderers in turns, with the same number of threads, a box filter, equal maximum
depths, without clamping, denoising or adaptive sampling. Errors are measured against a long reference by the same renderer;
references are compared with Fathom's first. Times are those of rendering without loading. Finished scenes are kept in the
folder, and are not measured again.
"""
import argparse
import json
import os
import sys
from pathlib import Path

import environments

ROOT = Path(__file__).resolve().parents[2]


def parse():
    # scenes and renderers need numpy, so that their names are checked after the environment was entered.
    parser = argparse.ArgumentParser(prog="bench/compare", description=__doc__.split("\n\nusage")[0])
    parser.add_argument("--scenes", nargs="+", metavar="NAME", help="scenes, by name or pattern such as 'caustic-*'; default: all")
    parser.add_argument("--renderers", nargs="+", metavar="NAME", help="default: all that can be used")
    parser.add_argument("--list", action="store_true", help="print the names of scenes and renderers")
    parser.add_argument("--fathom", type=Path, default=ROOT / "build/release/bin/fathom")
    parser.add_argument("--pbrt", type=Path, metavar="BINARY", help="a program of pbrt-v4; without it, pbrt is skipped")
    parser.add_argument("--seconds", type=float, default=10, help="of each image, if all threads are free (processor time / 2)")
    parser.add_argument("--rounds", type=int, default=3, help="images of the full time by each renderer")
    parser.add_argument("--reference-factor", type=int, default=16, help="samples of references over those of images")
    parser.add_argument("--scale", type=float, default=1, help="of the images' widths and heights")
    parser.add_argument("--threads", type=int, default=2)
    parser.add_argument("--rooms", type=Path, default=ROOT / "../shared/scenes", help="folder of the seven rooms")
    parser.add_argument("--environments", type=Path, default=environments.DEFAULT_FOLDER, help="folder of the virtual environments")
    parser.add_argument("--page-only", action="store_true", help="only write the page of the scenes that were measured")
    parser.add_argument("-o", dest="out", type=Path, default=Path("compare"), metavar="FOLDER")
    return parser.parse_args()


def enter(folder):
    """Continues in the environment of this program, unless the running Python has its packages."""
    try:
        import matplotlib  # noqa: F401
        import numpy  # noqa: F401
        import OpenEXR  # noqa: F401
    except ImportError:
        python = environments.python_of("tools", folder)
        os.execv(python, [str(python), str(Path(__file__).resolve().parent), *sys.argv[1:]])


def chosen(patterns, names, what):
    """The names that match patterns, in the order of names."""
    import fnmatch
    for pattern in patterns or []:
        if not fnmatch.filter(names, pattern):
            sys.exit(f"bench/compare: no {what} is named '{pattern}'; --list prints the names")
    return [name for name in names if not patterns or any(fnmatch.fnmatch(name, pattern) for pattern in patterns)]


def main():
    options = parse()
    try:
        enter(options.environments)
    except environments.Missing as error:
        sys.exit(f"bench/compare: {error}")
    import measure
    import page
    import renderers
    import scenes
    if options.list:
        print("scenes:", *scenes.NAMES, "\nrenderers:", *renderers.NAMES)
        return
    names = chosen(options.scenes, scenes.NAMES, "scene")
    options.renderers = chosen(options.renderers, renderers.NAMES, "renderer")
    if not options.page_only and not options.fathom.exists():
        sys.exit(f"bench/compare: {options.fathom} is missing: build Fathom, or name the program by --fathom")
    options.out = options.out.resolve()
    results = options.out / "results"
    results.mkdir(parents=True, exist_ok=True)
    for name in [] if options.page_only else names:
        file = results / f"{name}.json"
        if not file.exists():
            result = measure.measure(name, options)
            if result:
                file.write_text(json.dumps(result, indent=1) + "\n")
                page.write(options.out)
    page.write(options.out)
    print(options.out / "index.html")


if __name__ == "__main__":
    main()
