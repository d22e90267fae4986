#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Runs the steps of action.yml as GitHub does, with a package that contains the given program.

usage: action_test.py ROOT PROGRAM

Skipped (77) without Python's yaml, git, or pip and venv.
"""
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import unittest
import zipfile

ROOT, PROGRAM = pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2]).resolve()
SKIPPED = 77

try:
    import ensurepip  # noqa: F401
    import venv  # noqa: F401

    import yaml
except ImportError as error:
    print(f"skipped: {error}")
    sys.exit(SKIPPED)
if not shutil.which("git"):
    print("skipped: git is not installed")
    sys.exit(SKIPPED)

SCENE = {"fathom": 1, "camera": {"position": [0, 0, 4], "look_at": [0, 0, 0]}, "environment": {"kind": "constant"},
         "materials": {"m": {"kind": "diffuse", "color": [0.5, 0.5, 0.5]}},
         "scene": [{"sphere": {"center": [0, 0, 0], "radius": 1.2}, "material": "m"}]}


def make_package(folder):
    """A wheel whose command `fathom` is the program."""
    file = folder / "fathom_render-9.9-py3-none-any.whl"
    info = "fathom_render-9.9.dist-info"
    with zipfile.ZipFile(file, "w") as wheel:
        script = zipfile.ZipInfo("fathom_render-9.9.data/scripts/fathom")
        script.external_attr = 0o100755 << 16
        wheel.writestr(script, f'#!/bin/sh\nexec "{PROGRAM}" "$@"\n')
        wheel.writestr(f"{info}/METADATA", "Metadata-Version: 2.1\nName: fathom-render\nVersion: 9.9\n")
        wheel.writestr(f"{info}/WHEEL", "Wheel-Version: 1.0\nRoot-Is-Purelib: true\nTag: py3-none-any\n")
        wheel.writestr(f"{info}/RECORD", "")
    return file


class Runner:
    """Runs a composite action in a clone, as far as this one needs it. The first step, which installs, runs once for all
    tests that share a folder `temp`."""

    def __init__(self, folder, temp):
        self.folder, self.temp = folder, temp
        self.path = temp / "GITHUB_PATH"
        self.work = folder / "clone"
        self.files = {name: folder / name for name in ("GITHUB_OUTPUT", "GITHUB_STEP_SUMMARY")}
        self.files["GITHUB_PATH"] = self.path
        self.uses, self.text = [], ""
        subprocess.run(["git", "init", "-q", "--bare", folder / "origin"], check=True)
        subprocess.run(["git", "clone", "-q", folder / "origin", self.work], check=True, capture_output=True)
        (self.work / "README").write_text("a project\n")
        self.git("add", "README")
        self.git("-c", "user.name=a", "-c", "user.email=a@b", "commit", "-qm", "Start")
        self.git("push", "-q", "origin", "HEAD:main")

    def git(self, *words):
        return subprocess.run(["git", "-C", self.work, *words], check=True, capture_output=True, text=True).stdout

    def evaluate(self, text, inputs, steps):
        """Replaces the expressions of a text."""
        def value(match):
            words = match[1].split(".")
            return str(inputs[words[1]] if words[0] == "inputs" else steps.get(words[1], {}).get(words[3], ""))
        return re.sub(r"\$\{\{ ([\w.-]+) \}\}", value, text)

    def condition(self, text, inputs):
        match = re.fullmatch(r"\$\{\{ inputs\.([\w-]+) != '' \}\}", text)
        assert match, f"this test can't evaluate {text}"
        return inputs[match[1]] != ""

    def run_step(self, step, inputs, steps, path):
        for file in self.files.values():
            file.touch()
        self.files["GITHUB_OUTPUT"].write_text("")
        environment = {**os.environ, "RUNNER_TEMP": str(self.temp), "GITHUB_ACTION_PATH": str(ROOT), "GITHUB_RUN_ID": "77",
                       "GITHUB_WORKSPACE": str(self.work), "GITHUB_SERVER_URL": "https://example.org",
                       "GITHUB_REPOSITORY": "a/b", **{name: str(file) for name, file in self.files.items()},
                       "PATH": ":".join(path + [os.environ["PATH"]])}
        environment.update({key: self.evaluate(text, inputs, steps) for key, text in step.get("env", {}).items()})
        result = subprocess.run(["bash", "--noprofile", "--norc", "-eo", "pipefail", "-c", step["run"]], cwd=self.work,
                                env=environment, capture_output=True, text=True)
        self.text += result.stdout + result.stderr
        lines = self.files["GITHUB_OUTPUT"].read_text().splitlines()
        steps[step.get("id", "")] = dict(line.split("=", 1) for line in lines)
        return result.returncode

    def run(self, **given):
        """Returns the exit code of the first step that fails, or 0, and the outputs of the action."""
        action = yaml.safe_load((ROOT / "action.yml").read_text())
        given = {name.replace("_", "-"): value for name, value in given.items()}
        assert set(given) <= set(action["inputs"]), given
        inputs = {name: given.get(name, about.get("default")) for name, about in action["inputs"].items()}
        steps, code, self.text = {}, 0, ""
        for step in action["runs"]["steps"]:
            if "if" in step and not self.condition(step["if"], inputs):
                continue
            if "uses" in step:
                self.uses.append(self.evaluate(step["with"]["path"], inputs, steps))
                continue
            assert step["shell"] == "bash"
            path = self.path.read_text().split() if self.path.exists() else []
            if path and step["name"] == "Install Fathom":
                continue
            code = self.run_step(step, inputs, steps, path)
            if code:
                break
        return code, {name: self.evaluate(about["value"], inputs, steps) for name, about in action["outputs"].items()}


class Action(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        temp = tempfile.TemporaryDirectory()
        cls.addClassCleanup(temp.cleanup)
        cls.temp = pathlib.Path(temp.name)
        cls.package = str(make_package(cls.temp))

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        self.runner = Runner(self.folder, self.temp)
        self.write("box.json", json.dumps(SCENE))

    def write(self, name, text):
        (self.runner.work / name).write_text(text)

    def run_action(self, renders, **inputs):
        self.write("renders.txt", renders)
        code, outputs = self.runner.run(renders="renders.txt", package=self.package, options="--size 32x24 --spp 2", **inputs)
        page = self.runner.files["GITHUB_STEP_SUMMARY"]
        summary = page.read_text() if page.exists() else ""
        page.unlink(missing_ok=True)
        return code, outputs, summary

    def make_reference(self, name, *options):
        subprocess.run([PROGRAM, "render", "box.json", "--size", "32x24", *(options or ("--spp", "2")), "-q", "-o", name],
                       cwd=self.runner.work, check=True)

    def test_renders_like_their_references(self):
        self.make_reference("a.png")
        (self.runner.work / "ref").mkdir()
        self.make_reference("ref/b c.exr", "--spp", "1")
        code, outputs, summary = self.run_action("# a comment\na.png box.json\n\n'ref/b c.exr' box.json --spp 1  # with options\n")
        self.assertEqual((code, outputs), (0, {"different": "0"}), self.runner.text)
        self.assertIn("2 of 2 renders are like their references", summary)
        self.assertIn("| ✅ same | ref/b c.exr |", summary)
        self.assertNotIn("<img", summary)
        self.assertEqual(self.runner.uses, ["fathom-images"])
        self.assertTrue((self.runner.work / "fathom-images/ref-b c.exr").exists())

    def test_differences_fail_and_are_shown(self):
        self.make_reference("a.png", "--spp", "2", "--seed", "5")
        self.make_reference("same.png")
        code, outputs, summary = self.run_action(
            "a.png box.json\nnew.png box.json\nsame.png box.json\nx.png missing.json\n", images_branch="images")
        self.assertEqual((code, outputs), (1, {"different": "3"}), self.runner.text)
        for line in ("1 of 4 renders are like their references", "| ❌ different | a.png |", "| 🆕 new | new.png |",
                     "| 💥 failed | x.png |", "missing.json: no such file"):
            self.assertIn(line, summary)
        commit = self.runner.git("ls-remote", "origin", "refs/heads/images").split()[0]
        shown = re.findall(r'<img src="([^"]*)"', summary)
        base = f"https://example.org/a/b/raw/{commit}/77-1/"
        self.assertEqual(shown, [base + name for name in ("a.png", "reference-a.png", "a.png.diff.png", "new.png")])
        self.runner.git("fetch", "-q", "origin", "images")
        published = self.runner.git("ls-tree", "-r", "--name-only", "FETCH_HEAD").split()
        self.assertIn("77-1/a.png.diff.png", published)
        self.assertNotIn("README", published, "the branch has images only")
        self.assertEqual(self.runner.git("worktree", "list").count("\n"), 1, "the temporary tree is removed")

    def test_a_branch_keeps_the_images_of_earlier_runs(self):
        self.runner.git("checkout", "-q", "--orphan", "images")
        self.runner.git("rm", "-rfq", ".")
        self.write("earlier.png", "an image")
        self.runner.git("add", "earlier.png")
        self.runner.git("-c", "user.name=a", "-c", "user.email=a@b", "commit", "-qm", "Images")
        self.runner.git("push", "-q", "origin", "images")
        self.make_reference("a.png")
        self.assertEqual(self.run_action("a.png box.json\n", images_branch="images")[0], 0, self.runner.text)
        self.runner.git("fetch", "-q", "origin", "images")
        names = self.runner.git("ls-tree", "-r", "--name-only", "FETCH_HEAD").split()
        self.assertIn("earlier.png", names)
        self.assertIn("77-1/a.png", names)

    def test_a_branch_that_cannot_be_pushed(self):
        hook = self.folder / "origin/hooks/update"
        hook.write_text("#!/bin/sh\nexit 1\n")
        hook.chmod(0o755)
        self.make_reference("a.png")
        code, _, _ = self.run_action("a.png box.json\n", images_branch="images")
        self.assertEqual(code, 1, self.runner.text)
        self.assertIn("does the job have the permission contents: write?", self.runner.text)
        self.assertEqual(self.runner.git("worktree", "list").count("\n"), 1)

    def test_tolerance_and_noise(self):
        self.make_reference("a.png", "--spp", "2", "--seed", "5")
        self.assertEqual(self.run_action("a.png box.json\n", tolerance="1")[0], 0)
        self.make_reference("a.exr", "--spp", "2", "--seed", "5", "--mergeable")
        code, _, summary = self.run_action("a.exr box.json --mergeable\n")
        self.assertEqual(code, 1, self.runner.text)
        self.assertIn("explains the differences", summary)
        self.assertIn("The images are in the artifact `fathom-images`.", summary)
        self.assertEqual(self.run_action("a.exr box.json --mergeable\n", allow_noise="true")[0], 0, self.runner.text)

    def test_wrong_lists(self):
        for renders, message in (("", "the list has no renders"), ("a.png\n", "line 1: expected REFERENCE SCENE")):
            code, _, _ = self.run_action(renders)
            self.assertEqual(code, 1, self.runner.text)
            self.assertIn(message, self.runner.text)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
