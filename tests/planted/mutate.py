#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Mutation testing of a change: mutates the lines of src/ and apps/ that differ from a commit, one place at a time, and lists
the mutants that no test of the module detects. See docs/testing.md.

A surviving mutant means a missing test unless it changes nothing (an equivalent mutant), which a reader decides. Mutants are
built in the source copy of the planted bugs, and only the tests of their module run.
"""
import argparse
import pathlib
import random
import re
import resource
import signal
import subprocess
import sys
import time

from planted import BUILD_ROOT, ROOT, BuildCopy, copy_tree

# Modules by path prefix, of which the first match counts: targets to build, and the gtest programs or command line
# tests that should detect a change.
PARTS = [
    ("src/base/", ["base_tests", "formats_tests"]),
    ("src/scene/", ["scene_tests", "formats_tests"]),
    ("src/image/", ["image_tests", "film_file_tests"]),
    ("src/denoise/", ["denoise_tests"]),
    ("src/formats/fathom/scene_json", ["save_tests"]),
    ("src/formats/gltf/glb", ["save_tests"]),
    ("src/formats/", ["formats_tests", "save_tests"]),
    ("src/film/file/", ["film_file_tests"]),
    ("src/film/", ["film_tests", "film_file_tests"]),
    ("src/session/", ["session_tests", "learning_tests", "picture_tests"]),
    ("src/presentation/default_camera", ["default_camera_tests"]),
    ("src/presentation/", ["presentation_tests"]),
    ("src/geometry/bvh/", ["geometry_tests_base"]),
    ("src/geometry/flat/", ["shape_tests_base"]),
    ("src/geometry/shapes/", ["shape_tests_base", "geometry_tests_base"]),
    ("src/geometry/surface/", ["picture_tests"]),
    ("src/geometry/", ["compile_tests", "picture_tests"]),
    ("src/compile/", ["compile_tests", "picture_tests"]),
    ("src/textures/compile/", ["compile_tests", "picture_tests"]),
    ("src/materials/compile/", ["compile_tests", "picture_tests"]),
    ("src/media/compile/", ["compile_tests", "picture_tests"]),
    ("src/lights/compile/", ["compile_tests", "picture_tests"]),
    ("src/lights/sky/", ["compile_tests", "picture_tests"]),
    ("src/materials/read/", ["picture_tests"]),
    ("src/lights/sample/", ["picture_tests"]),
    ("src/kernel/", ["kernel_tests_base", "picture_tests"]),
    ("src/integrate/", ["picture_tests"]),
    ("src/guiding/", ["kernel_tests_base", "learning_tests"]),
    ("src/", ["kernel_tests_base", "picture_tests"]),
    ("apps/", ["fathom", "fathom_double", "fake_oidn", "command line"]),
]
# Mutations as (pattern, replacement). Numbers are mutated by a function.
OPERATORS = [
    (r" < ", " <= "), (r" <= ", " < "), (r" > ", " >= "), (r" >= ", " > "), (r" == ", " != "), (r" != ", " == "),
    (r" && ", " || "), (r" \|\| ", " && "), (r" \+ ", " - "), (r" - ", " + "), (r" \* ", " / "), (r" / ", " * "),
    (r" \+= ", " -= "), (r" -= ", " += "), (r"\bmin\(", "max("), (r"\bmax\(", "min("), (r"\btrue\b", "false"),
    (r"\bfalse\b", "true"), (r"\(!", "("), (r"::srgb\b", "::linear"), (r"::linear\b", "::srgb"),
    (r"\bcontinue;", ";"), (r"\.x\b", ".y"), (r"\bfirst\b", "second"),
]
NUMBER = re.compile(r"(?<![\w.\[])(\d+\.\d*|\.\d+|\d+)(?=f?\b)(?!\w*x)")
STATEMENT = re.compile(r"^\s+[\w.\[\]>*()-]+(?:\([^;]*\)| [+*|&-]?= [^;]*);$")
TEST_PROCESSOR_S = 900


class Mutant:
    def __init__(self, path, line, before, after):
        self.path, self.line, self.before, self.after = path, line, before, after

    def __str__(self):
        return f"{self.path}:{self.line}\n  - {self.before.strip()}\n  + {self.after.strip() or '(nothing)'}"


def changed_lines(base, paths):
    """Returns (path, number, text) of each line that differs from a commit."""
    diff = subprocess.run(["git", "-C", str(ROOT), "diff", "--unified=0", "--no-color", base, "--", *(paths or ["src", "apps"])],
                          capture_output=True, text=True, check=True).stdout
    path, number = None, 0
    for line in diff.splitlines():
        if line.startswith("+++ "):
            path = line[6:] if line.startswith("+++ b/") else None
        elif hunk := re.match(r"@@ -\S+ \+(\d+)", line):
            number = int(hunk[1])
        elif line.startswith("+") and path:
            yield path, number, line[1:]
            number += 1


def is_mutated(path):
    return path.endswith((".cpp", ".h")) and not path.endswith(("_test.cpp", "_table.h")) and \
        any(path.startswith(part) for part, _ in PARTS)


def code_of(text):
    """Returns the line up to its comment, with strings replaced by blanks of equal length to keep columns."""
    text = re.sub(r'"(?:\\.|[^"\\])*"', lambda m: '"' + " " * (len(m[0]) - 2) + '"', text)
    return re.split(r"//", text)[0]


def other_number(text):
    if "." in text:
        return repr(float(text) * 1.5 + (0.5 if float(text) == 0 else 0))
    return str(int(text) + 1)


def mutants_of(path, number, text):
    code = code_of(text)
    if not code.strip() or code.lstrip().startswith(("#", "using ", "namespace ", "static_assert", "template")):
        return
    for pattern, replacement in OPERATORS:
        for match in re.finditer(pattern, code):
            yield Mutant(path, number, text, text[:match.start()] + replacement + text[match.end():])
    for match in NUMBER.finditer(code):
        yield Mutant(path, number, text, text[:match.start()] + other_number(match[1]) + text[match.end():])
    if STATEMENT.match(code.rstrip()) and not code.lstrip().startswith(("return", "const ", "throw", "auto ")):
        yield Mutant(path, number, text, "")


def targets_of(path):
    return next(targets for part, targets in PARTS if path.startswith(part))


class Tests:
    """Runs the tests of a module until one fails."""

    def __init__(self, build_copy):
        self.build_copy = build_copy

    def limit(self):
        resource.setrlimit(resource.RLIMIT_CPU, (TEST_PROCESSOR_S, TEST_PROCESSOR_S + 10))

    def fails(self, command):
        code, _ = self.build_copy.run(command, "mutant.log", limit=self.limit)
        return code != 0

    def programs(self, target):
        build = self.build_copy.build / "bin"
        if target == "command line":
            double, program = (str(build / name) for name in ("fathom_double", "fathom"))
            oidn = str(self.build_copy.build / "lib" / "libfake_oidn.so")
            for test in sorted((self.build_copy.tree / "tests/apps/command_line").glob("*_test.py")):
                yield test.stem, [sys.executable, str(test), double, program, oidn]
        elif target.endswith("_tests") or "_tests_" in target:
            yield target, [str(build / target), "--gtest_brief=1", "--gtest_fail_fast"]

    def failing(self, targets):
        """Returns the name of a failing test program, or None."""
        for target in targets:
            for name, command in self.programs(target):
                if self.fails(command):
                    return name
        return None


def try_mutant(mutant, build_copy):
    file = build_copy.tree / mutant.path
    original = file.read_text()
    lines = original.splitlines(keepends=True)
    if lines[mutant.line - 1].rstrip("\n") != mutant.before:
        return "error", "the line is another one"
    lines[mutant.line - 1] = mutant.after + "\n"
    try:
        file.write_text("".join(lines))
        targets = targets_of(mutant.path)
        if not build_copy.compile([target for target in targets if " " not in target])[0]:
            return "invalid", "does not compile"
        name = Tests(build_copy).failing(targets)
        return ("caught", f"by {name}") if name else ("SURVIVED", "")
    finally:
        file.write_text(original)


def check():
    """Returns exit status 0 if every module has sources and its test programs exist; builds nothing."""
    lists = "\n".join(path.read_text() for path in (ROOT / "tests").rglob("CMakeLists.txt"))
    errors = [f"no source starts with {part}" for part, _ in PARTS if not list(ROOT.glob(part + "*"))]
    errors += [f"{part}: there is no test program {target}" for part, targets in PARTS for target in targets
               if "_tests" in target and not re.search(rf"\b{re.sub('_base$', '_[$]', target)}", lists)]
    alterations = list(mutants_of("src/base/example.cpp", 1, "    if (a < 2) b = c;"))
    if [mutant.after.strip() for mutant in alterations] != ["if (a <= 2) b = c;", "if (a < 3) b = c;"]:
        errors.append(f"alterations of the example: {', '.join(mutant.after.strip() for mutant in alterations)}")
    print("\n".join(errors) or f"{len(PARTS)} modules have sources and tests")
    return 1 if errors else 0


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("paths", nargs="*", help="only these files or folders (default: src and apps)")
    parser.add_argument("--base", default="HEAD~1", help="the commit to compare with (default: HEAD~1)")
    parser.add_argument("--max", type=int, default=20, metavar="N", help="so many alterations, chosen at random (default 20)")
    parser.add_argument("--seed", type=int, default=1, help="which are chosen (default 1)")
    parser.add_argument("--list", action="store_true", help="only show them; build nothing")
    parser.add_argument("--check", action="store_true", help="only see whether all modules and test programs exist")
    parser.add_argument("--jobs", type=int, default=2, help="compilers at once")
    options = parser.parse_args()

    if options.check:
        return check()
    mutants = [mutant for line in changed_lines(options.base, options.paths) if is_mutated(line[0]) for mutant in mutants_of(*line)]
    print(f"{len(mutants)} alterations are possible in the lines that differ from {options.base}")
    mutants = random.Random(options.seed).sample(mutants, min(options.max, len(mutants)))
    if options.list:
        print("\n".join(map(str, mutants)))
        return 0
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(1))
    copy_tree(BUILD_ROOT / "tree")
    build_copy = BuildCopy("base", options.jobs)
    wanted = sorted({target for mutant in mutants for target in targets_of(mutant.path)})
    if not build_copy.compile([target for target in wanted if " " not in target])[0]:
        sys.exit("the sources do not build as they are")
    if name := Tests(build_copy).failing(wanted):
        sys.exit(f"{name} fails without any alteration")
    results = []
    for mutant in mutants:
        start = time.monotonic()
        result, words = try_mutant(mutant, build_copy)
        results.append(result)
        print(f"{result} {words} ({time.monotonic() - start:.0f} s) {mutant}", flush=True)
    valid = len(results) - results.count("invalid")
    print(f"caught {results.count('caught')} of {valid}; {results.count('invalid')} did not compile")
    return 1 if "SURVIVED" in results or "error" in results else 0


if __name__ == "__main__":
    sys.exit(main())
