#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Plants bugs in a copy of the sources, one at a time, and reports which of them the tests detect. See docs/testing.md.

A rule of tests/planted/rules/MODULE.json has the keys

    id       unique name
    bug      description of the fault
    files    glob below src/ of the files with the code
    find     the code; blanks match any run of blanks and line breaks, so formatting doesn't matter
    replace  the faulty code
    count    number of occurrences (default 1), all of which are replaced
    targets  targets to build, as few as possible
    tests    regular expression for ctest -R of the tests that should fail; by default all quick and full tests
    gtest    optional GTEST_FILTER for a test program that ctest runs as one test (kernel_tests)
    isa      optional instruction set other than base, if the bug depends on the number of lanes
"""
import argparse
import fnmatch
import hashlib
import json
import os
import pathlib
import random
import re
import resource
import shutil
import signal
import subprocess
import sys
import time

ROOT = pathlib.Path(__file__).resolve().parents[2]
BUILD_ROOT = ROOT / "build" / "planted"
# Limits of a test in seconds: CPU time of each process, which load does not change; patience and wall clock time of a test
# that hangs.
PROCESSOR_S, PATIENCE_S, LONGEST_S = 1800, 300, 7200
REQUIRED = {"id", "bug", "files", "find", "replace", "targets"}
OPTIONAL = {"count": 1, "tests": "", "gtest": "", "isa": "base"}


class RuleError(Exception):
    pass


def read_rules():
    rules = []
    for file in sorted((pathlib.Path(__file__).parent / "rules").glob("*.json")):
        for rule in json.loads(file.read_text()):
            unknown, missing = rule.keys() - REQUIRED - OPTIONAL.keys(), REQUIRED - rule.keys()
            if unknown or missing:
                sys.exit(f"{file}: rule {rule.get('id')}: unknown keys {sorted(unknown)}, missing keys {sorted(missing)}")
            rules.append({**OPTIONAL, **rule, "module": file.stem})
    ids = [rule["id"] for rule in rules]
    for name in {i for i in ids if ids.count(i) > 1}:
        sys.exit(f"tests/planted/rules: two rules are named {name}")
    return rules


def pattern_of(rule):
    return re.compile(r"\s+".join(re.escape(part) for part in rule["find"].split()))


def plant(rule, root):
    """Returns the modified files by path. Raises RuleError unless the code occurs exactly as often as the rule says."""
    planted, found = {}, 0
    pattern = pattern_of(rule)
    for path in sorted(root.glob("src/" + rule["files"])):
        if path.suffix not in (".h", ".cpp") or path.stem.endswith("_test"):
            continue
        text, n = pattern.subn(lambda _: rule["replace"], path.read_text())
        found += n
        if n:
            planted[path] = text
    if found != rule["count"]:
        raise RuleError(f"the code stands {found} times in src/{rule['files']}, not {rule['count']}")
    if rule["find"].split() == rule["replace"].split():
        raise RuleError("the bug is the code itself")
    return planted


def tests_in_sources():
    """Returns the names Suite.Test of all GoogleTest tests; those with parameters are Instance/Suite.Test."""
    texts = [path.read_text() for path in sorted((ROOT / "tests").rglob("*.[ch]*")) if path.suffix in (".h", ".cpp")]
    tests = [found for text in texts for found in re.findall(r"\bTEST(?:_[FP])?\(\s*(\w+),\s*(\w+)\)", text)]
    instances = [found for text in texts for found in re.findall(r"INSTANTIATE_TEST_SUITE_P\(\s*(\w+),\s*(\w+)", text)]
    names = {f"{suite}.{test}" for suite, test in tests}
    return names | {f"{instance}/{suite}.{test}" for instance, of in instances for suite, test in tests if suite == of}


def check_tests(rule, tests):
    """Raises RuleError if the rule names tests that do not exist: with them it could not be caught."""
    for pattern in filter(None, rule["gtest"].split(":")):
        # Tests with parameters have a number or name after a slash.
        if not any(fnmatch.fnmatchcase(name, pattern) or fnmatch.fnmatchcase(name + "/", pattern) for name in tests):
            raise RuleError(f"no test is named like '{pattern}'")
    # Other names than Suite.Test are those of ctest, which are known after a build only.
    suite = re.match(r"\^([A-Z]\w+)\\\.", rule["tests"])
    if suite and not any(name.startswith(suite[1] + ".") for name in tests):
        raise RuleError(f"no test suite is named {suite[1]}")


def check(rules):
    """Returns exit status 0 if every rule matches the sources and names tests that exist; builds nothing."""
    errors, tests = 0, tests_in_sources()
    for rule in rules:
        try:
            plant(rule, ROOT)
            check_tests(rule, tests)
        except RuleError as error:
            print(f"{rule['module']}: {rule['id']}: {error}")
            errors += 1
    print(f"{len(rules) - errors} of {len(rules)} rules fit the sources")
    return 1 if errors else 0


def write_if_changed(path, data):
    """Writes a file only if it changes. Unchanged files keep their modification time and are not built again."""
    if path.is_file() and path.read_bytes() == data:
        return
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_bytes(data)


def parts_of_the_project():
    """Returns the files and folders of the root that tests may read: all except builds and hidden ones."""
    return sorted(path.name for path in ROOT.iterdir() if path.name != "build" and not path.name.startswith("."))


def copy_tree(to):
    wanted, names = set(), parts_of_the_project()
    for name in names:
        source = ROOT / name
        for path in [source] if source.is_file() else source.rglob("*"):
            if path.is_file() and "__pycache__" not in path.parts:
                relative = path.relative_to(ROOT)
                wanted.add(to / relative)
                write_if_changed(to / relative, path.read_bytes())
                shutil.copymode(path, to / relative)
    for name in names:
        for path in [p for p in (to / name).rglob("*") if p.is_file() and p not in wanted]:
            path.unlink()


def failed_tests(text):
    """Returns the names of failed tests from ctest's final list."""
    return re.findall(r"^\s+\d+ - (\S+) \((?!Skipped)", text, re.M)


class BuildCopy:
    """A copy of the sources with a build for one instruction set."""

    def __init__(self, isa, jobs):
        self.jobs = jobs
        # The locale C and the choice about warnings are those of scripts/setup.sh, so ccache can reuse its results.
        self.tree, self.build = BUILD_ROOT / "tree", BUILD_ROOT / "tree" / "build" / isa
        self.environment = {**os.environ, "LC_ALL": "C"}
        isas = "base" if isa == "base" else f"base;{isa}"
        self.run(["cmake", "-S", str(self.tree), "-B", str(self.build), "-G", "Ninja", "-DCMAKE_BUILD_TYPE=Release",
                  "-DFATHOM_TESTS=ON", f"-DFATHOM_WERROR={'ON' if 'CI' in os.environ else 'OFF'}", "-DFATHOM_VIEW=OFF",
                  f"-DFATHOM_ISAS={isas}",
                  f"-DFATHOM_SHARED_SCENES={ROOT.parent / 'shared' / 'scenes'}"], "configure.log", must=True)

    def run(self, command, log, must=False, limit=None, **more):
        # The process has a group of its own, so that ending the group also ends the compilers that it started.
        with open(BUILD_ROOT / f"{self.build.name}.{log}", "w") as out, \
                subprocess.Popen(command, stdout=out, stderr=subprocess.STDOUT, env={**self.environment, **more},
                                 start_new_session=True, preexec_fn=limit) as process:
            try:
                code = process.wait()
            except BaseException:
                os.killpg(process.pid, signal.SIGTERM)
                raise
        if must and code:
            sys.exit(f"failed: {' '.join(command)}\nsee {out.name}")
        return code, out.name

    def compile(self, targets):
        code, log = self.run(["cmake", "--build", str(self.build), f"-j{self.jobs}", "--target", *targets], "build.log")
        return code == 0, log

    def ctest(self, arguments, log, gtest=""):
        """Returns the output of ctest. CPU time is limited instead of ctest's wall clock time, which depends on other
        programs."""
        more = {"FATHOM_TEST_PATIENCE": str(PATIENCE_S), **({"GTEST_FILTER": gtest} if gtest else {})}
        _, log = self.run(["ctest", "--test-dir", str(self.build), *arguments, f"-j{self.jobs}", "--timeout", str(LONGEST_S)], log,
                          limit=lambda: resource.setrlimit(resource.RLIMIT_CPU, (PROCESSOR_S, PROCESSOR_S + 10)), **more)
        return pathlib.Path(log).read_text(), log

    def chosen(self, rule):
        names = ["-R", rule["tests"]] if rule["tests"] else ["-L", "quick|full"]
        # These two tests read the sources, so they would fail with any change.
        return names + ["-E", "^(planted_rules|format)$"]

    def tests_of(self, rule):
        """Returns the numbers of the tests of a rule."""
        text, _ = self.ctest(["-N", *self.chosen(rule)], "list.log")
        return {int(number): name for number, name in re.findall(r"^\s*Test\s+#(\d+): (\S+)", text, re.M)}

    def test(self, rule):
        """Returns the names of the failed tests. Raises RuleError if none ran."""
        text, log = self.ctest(self.chosen(rule), "test.log", rule["gtest"])
        count = re.search(r"tests failed out of (\d+)|tests passed.*out of (\d+)", text)
        if not count or "No tests were found" in text:
            raise RuleError(f"no test is named like '{rule['tests']}'; see {log}")
        if "Not Run" in text:
            raise RuleError(f"a test was not built; see {log}")
        return failed_tests(text)

    def test_numbers(self, numbers, gtest):
        """Returns the names of the tests, given by number, that failed or were not built."""
        place = BUILD_ROOT / f"{self.build.name}.numbers"
        place.write_text("0,0,0," + ",".join(map(str, sorted(numbers))) + "\n")  # ctest drops the last character of the file
        text, log = self.ctest(["-I", str(place)], "clean.log", gtest)
        if "No tests were found" in text or "tests" not in text:
            sys.exit(f"no test ran; see {log}")
        return failed_tests(text)


def try_rule(rule, build_copy):
    """Returns (caught, SURVIVED or error, explanation)."""
    try:
        planted = plant(rule, build_copy.tree)
    except RuleError as error:
        return "error", str(error)
    before = {path: path.read_bytes() for path in planted}
    try:
        for path, text in planted.items():
            path.write_text(text)
        built, log = build_copy.compile(rule["targets"])
        if not built:
            return "error", f"the bug does not compile; see {log}"
        failed = build_copy.test(rule)
        return ("caught", f"by {failed[0]}" + (f" and {len(failed) - 1} more" if failed[1:] else "")) if failed else \
               ("SURVIVED", rule["bug"])
    except RuleError as error:
        return "error", str(error)
    finally:
        for path, data in before.items():
            path.write_bytes(data)


def failing_without_bug(rules, build_copy):
    """Returns ids of rules whose tests fail without a planted bug, so that their failure proves nothing."""
    built, log = build_copy.compile(sorted({target for rule in rules for target in rule["targets"]}))
    if not built:
        sys.exit(f"the sources do not build without a bug; see {log}")
    tests, known = {}, {}
    for rule in rules:
        if rule["tests"] not in known:
            known[rule["tests"]] = build_copy.tests_of(rule)
        tests[rule["id"]] = known[rule["tests"]]
    failed = set()
    for gtest, numbers in clean_runs(rules, tests).items():
        failed.update(build_copy.test_numbers(numbers, gtest))
    # If a test program runs many tests at once, those of this rule may all have passed.
    return {rule["id"] for rule in rules
            if failed & set(tests[rule["id"]].values()) and (not rule["gtest"] or build_copy.test(rule))}


def clean_runs(rules, tests):
    """Returns the numbers of the tests of all rules by GTEST_FILTER. Each test runs once, with the union of its rules'
    filters."""
    filters = {}
    for rule in rules:
        for number in tests[rule["id"]]:
            filters.setdefault(number, set()).add(rule["gtest"] or "*")
    runs = {}
    for number, wanted in filters.items():
        runs.setdefault("" if "*" in wanted else ":".join(sorted(wanted)), set()).add(number)
    return runs


def seed_of_commit():
    """Returns a seed derived from the commit, so that everyone draws equal rules."""
    head = subprocess.run(["git", "-C", str(ROOT), "rev-parse", "HEAD"], capture_output=True, text=True).stdout.strip()
    return int(hashlib.sha256(head.encode()).hexdigest(), 16)


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("--check", action="store_true", help="only see whether every rule fits the sources; build nothing")
    parser.add_argument("--list", action="store_true", help="show the rules")
    parser.add_argument("--only", nargs="+", metavar="ID", help="these rules, or all of a module")
    parser.add_argument("--sample", type=int, metavar="N", help="N rules at random")
    parser.add_argument("--seed", type=int, help="for --sample; default: by the commit that is checked out")
    parser.add_argument("--jobs", type=int, default=os.cpu_count(), help="processes at once")
    options = parser.parse_args()

    rules = read_rules()
    if options.only:
        unknown = set(options.only) - {rule["id"] for rule in rules} - {rule["module"] for rule in rules}
        if unknown:
            sys.exit(f"there is no rule or module {', '.join(sorted(unknown))}")
        rules = [rule for rule in rules if rule["id"] in options.only or rule["module"] in options.only]
    if options.sample is not None:
        seed = seed_of_commit() if options.seed is None else options.seed
        rules = random.Random(seed).sample(rules, min(options.sample, len(rules)))
    if options.list:
        for rule in rules:
            print(f"{rule['module']:10} {rule['id']:32} {rule['bug']}")
        return 0
    if options.check:
        return check(rules)
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(1))

    copy_tree(BUILD_ROOT / "tree")
    results = {}
    for isa in sorted({rule["isa"] for rule in rules}):
        build_copy = BuildCopy(isa, options.jobs)
        mine = [rule for rule in rules if rule["isa"] == isa]
        failing = failing_without_bug(mine, build_copy)
        for rule in mine:
            start = time.monotonic()
            result, words = ("error", "its tests fail without the bug, too") if rule["id"] in failing \
                else try_rule(rule, build_copy)
            results[rule["id"]] = result
            print(f"{result:9} {rule['module']:10} {rule['id']:32} {words} ({time.monotonic() - start:.0f} s)", flush=True)
    caught = sum(result == "caught" for result in results.values())
    for kind in ("SURVIVED", "error"):
        names = [name for name, result in results.items() if result == kind]
        if names:
            print(f"{kind}: {' '.join(names)}")
    print(f"caught {caught} of {len(results)}")
    return 0 if caught == len(results) else 1


if __name__ == "__main__":
    sys.exit(main())
