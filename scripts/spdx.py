#!/usr/bin/env python3
"""License lines: every source file begins with `SPDX-License-Identifier: Apache-2.0` in a comment.

usage: scripts/spdx.py [--check] [--fix] [FOLDER]

--check  (default) lists the files that lack the line; exit status 1 if there are any
--fix    adds the line to them; running it again changes nothing
FOLDER   the root of the repository (default: the one that holds this script)

Only files that git tracks are read. A shebang and a coding line stay in front of the license line. A file that names
another license keeps it. Tables that a program of tools/ generates are left out, since the program would drop the
line; each names its generator. Exit status 77 if FOLDER is not a git repository, or git is not installed."""
import argparse
import re
import subprocess
import sys
from pathlib import Path

IDENTIFIER = "SPDX-License-Identifier: Apache-2.0"
COMMENTS = {".h": "//", ".c": "//", ".cpp": "//", ".py": "#", ".sh": "#", ".cmake": "#"}
# Folders of test data: their files are not source files, whatever their extensions.
DATA = ("tests/golden/scenes/", "tests/planted/rules/", "scenes/")
TAG = re.compile(r"SPDX-License-Identifier:\s*\S")
CODING = re.compile(r"#.*coding[:=]\s*[-\w.]+")
GENERATED = re.compile(r"^\s*///? (Made|Generated|Written) by tools/", re.MULTILINE)
HEAD_LINES = 20


def tracked_files(root):
    """Returns the relative names of all files that git tracks, or None outside a repository."""
    try:
        listed = subprocess.run(["git", "-C", str(root), "ls-files", "-z"], capture_output=True)
    except FileNotFoundError:
        return None
    if listed.returncode:
        print(listed.stderr.decode(errors="replace").strip(), file=sys.stderr)
        return None
    return [name for name in listed.stdout.decode().split("\0") if name]


def comment_of(name, lines):
    """Returns the prefix of comments in this file, or None if it is not a source file."""
    path = Path(name)
    if path.suffix != ".py" and name.startswith(DATA):
        return None
    if path.name == "CMakeLists.txt":
        return "#"
    if path.suffix in COMMENTS:
        return COMMENTS[path.suffix]
    # A script without an extension has a shebang.
    if not path.suffix and lines and re.match(r"#!.*\b(bash|sh|python3?)\b", lines[0]):
        return "#"
    return None


def needs_line(lines):
    head = "".join(lines[:HEAD_LINES])
    return not TAG.search(head) and not GENERATED.search(head)


def with_line(lines, comment):
    """Returns the lines of a file with the license line in front, behind a shebang and a coding line."""
    end = "\r\n" if lines and lines[0].endswith("\r\n") else "\n"
    at = 0
    if lines and lines[0].startswith("#!"):
        at = 1
    if comment == "#" and len(lines) > at and CODING.match(lines[at]):
        at += 1
    if at and not lines[at - 1].endswith("\n"):
        lines = [*lines[:at - 1], lines[at - 1] + end, *lines[at:]]
    return [*lines[:at], f"{comment} {IDENTIFIER}{end}", *lines[at:]]


def lines_of(path):
    # newline="" keeps line ends as they are.
    with open(path, encoding="utf-8", newline="") as file:
        return file.read().splitlines(keepends=True)


def without_line(root, names):
    """Returns (path, lines, comment prefix) of each source file that lacks the license line."""
    for name in names:
        path = root / name
        if path.is_symlink() or not path.is_file():
            continue
        if Path(name).suffix and Path(name).suffix not in COMMENTS and Path(name).name != "CMakeLists.txt":
            continue
        try:
            lines = lines_of(path)
        except UnicodeDecodeError:
            continue
        comment = comment_of(name, lines)
        if comment and needs_line(lines):
            yield path, lines, comment


def main(arguments=None):
    parser = argparse.ArgumentParser(description="Checks or adds license lines.")
    action = parser.add_mutually_exclusive_group()
    action.add_argument("--check", action="store_true", help="list the files that lack the line (default)")
    action.add_argument("--fix", action="store_true", help="add the line to them")
    parser.add_argument("root", nargs="?", type=Path, default=Path(__file__).resolve().parents[1], metavar="FOLDER")
    options = parser.parse_args(arguments)
    names = tracked_files(options.root)
    if names is None:
        print(f"skipped: {options.root} is not a git repository, or git is not installed")
        return 77
    missing = list(without_line(options.root, names))
    for path, lines, comment in missing:
        if options.fix:
            with open(path, "w", encoding="utf-8", newline="") as file:
                file.write("".join(with_line(lines, comment)))
        else:
            print(f"{path.relative_to(options.root)}: no line `{comment} {IDENTIFIER}`; scripts/spdx.py --fix adds it")
    if options.fix:
        print(f"license lines added: {len(missing)}")
        return 0
    print(f"files without a license line: {len(missing)}")
    return 1 if missing else 0


if __name__ == "__main__":
    sys.exit(main())
