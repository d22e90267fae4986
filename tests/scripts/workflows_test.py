#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Checks the files of .github: workflows run ./test.sh on the supported systems and publish the site, and issue forms are
complete. Checks the workflow of docs/diff.md, which uses the action of this repository.

usage: workflows_test.py ROOT               checks the text and then the YAML; exit status 77 (skipped) without Python's yaml
       workflows_test.py ROOT --actionlint  runs actionlint (a Go program) from PATH, $ACTIONLINT or ~/go/bin; exit status 77
                                            without it
"""
import os
import re
import shutil
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

try:
    import yaml
except ImportError:
    yaml = None

GITHUB = Path(sys.argv[1]).resolve() / ".github"
WORKFLOW = GITHUB / "workflows/ci.yml"
SITE = GITHUB / "workflows/site.yml"
FORMS = GITHUB / "ISSUE_TEMPLATE"
# Input types of an issue form.
INPUTS = {"textarea", "input", "dropdown", "checkboxes"}
SKIPPED = 77


def actionlint():
    program = os.environ.get("ACTIONLINT") or shutil.which("actionlint") or shutil.which(Path.home() / "go/bin/actionlint")
    if not program:
        print("actionlint is not installed: skipped (go install github.com/rhysd/actionlint/cmd/actionlint@latest)")
        return SKIPPED
    files = sorted((GITHUB / "workflows").glob("*.y*ml"))
    own = subprocess.run([program, "-no-color", *map(str, files)]).returncode
    return own or lint_documented_workflow(program)


def lint_documented_workflow(program):
    """Runs actionlint on the workflow of docs/diff.md in a repository with the action, so that its inputs are checked."""
    block, = re.findall(r"^```yaml\n(.*?)^```$", (GITHUB.parent / "docs/diff.md").read_text(), re.S | re.M)
    assert "uses: OWNER/fathom@main" in block
    with tempfile.TemporaryDirectory() as name:
        workflows = Path(name) / ".github/workflows"
        workflows.mkdir(parents=True)
        (Path(name) / ".git").mkdir()
        shutil.copy(GITHUB.parent / "action.yml", name)
        (workflows / "renders.yml").write_text(block.replace("OWNER/fathom@main", "./"))
        return subprocess.run([program, "-no-color"], cwd=name).returncode


class Text(unittest.TestCase):
    def test_the_workflow_runs_the_tests_of_the_project(self):
        self.assertIn("run: ./test.sh\n", WORKFLOW.read_text())

    def test_no_tabs(self):
        for file in GITHUB.rglob("*.yml"):
            self.assertNotIn("\t", file.read_text(), file)


@unittest.skipUnless(yaml, "Python's yaml is not installed")
class Workflow(unittest.TestCase):
    def setUp(self):
        self.workflow = yaml.safe_load(WORKFLOW.read_text())
        self.job = self.workflow["jobs"]["test"]
        self.steps = self.job["steps"]

    def place(self, **wanted):
        (key, value), = wanted.items()
        found = [number for number, step in enumerate(self.steps) if step.get(key, "").startswith(value)]
        self.assertEqual(len(found), 1, f"steps with {key}: {value}")
        return found[0]

    def test_the_systems_of_the_readme(self):
        self.assertEqual(self.job["strategy"]["matrix"]["image"], ["debian:12", "ubuntu:24.04"])
        self.assertEqual(self.job["container"]["image"], "${{ matrix.image }}")

    def test_no_rights_but_to_read(self):
        self.assertEqual(self.workflow["permissions"], {"contents": "read"})
        self.assertNotIn("permissions", self.job)

    def test_it_runs_for_pull_requests_and_main(self):
        # YAML 1.1 parses the key `on` as true.
        events = self.workflow[True]
        self.assertIn("pull_request", events)
        self.assertEqual(events["push"], {"branches": ["main"]})

    def test_git_comes_before_the_checkout_and_the_tests_after(self):
        checkout, tests = self.place(uses="actions/checkout"), self.place(run="./test.sh")
        self.assertLess(self.place(name="Install git"), checkout)
        self.assertLess(checkout, tests)
        self.assertNotIn("if", self.steps[tests])
        self.assertNotIn("continue-on-error", self.steps[tests])

    def test_the_cache_is_saved_where_it_is_restored(self):
        restore, save = self.steps[self.place(uses="actions/cache/restore")], self.steps[self.place(uses="actions/cache/save")]
        self.assertEqual(restore["with"]["path"], save["with"]["path"])
        self.assertEqual(restore["with"]["key"], save["with"]["key"])
        self.assertEqual(restore["with"]["path"], self.job["env"]["CCACHE_DIR"])

    def test_the_log_is_kept_after_a_failure(self):
        upload = self.steps[self.place(uses="actions/upload-artifact")]
        self.assertEqual(upload["if"], "failure()")
        self.assertIn("build/release/ctest.log", upload["with"]["path"])


@unittest.skipUnless(yaml, "Python's yaml is not installed")
class Site(unittest.TestCase):
    def setUp(self):
        self.workflow = yaml.safe_load(SITE.read_text())
        self.build, self.publish = self.workflow["jobs"]["build"], self.workflow["jobs"]["publish"]

    def test_the_site_is_built_for_each_change_and_uploaded(self):
        self.assertIn("pull_request", self.workflow[True])
        runs = [step.get("run", "") for step in self.build["steps"]]
        site = runs.index("PYTHON=python scripts/site.sh --package installed")
        self.assertLess(runs.index("pip install ."), site)
        upload = self.build["steps"][site + 1]
        self.assertTrue(upload["uses"].startswith("actions/upload-pages-artifact"))
        self.assertEqual(upload["with"], {"path": "build/site"})

    def test_only_main_is_published(self):
        self.assertEqual(self.publish["needs"], "build")
        self.assertIn("github.ref == 'refs/heads/main'", self.publish["if"])
        self.assertIn("github.event_name != 'pull_request'", self.publish["if"])

    def test_only_publishing_may_write(self):
        self.assertEqual(self.workflow["permissions"], {"contents": "read"})
        self.assertNotIn("permissions", self.build)
        self.assertEqual(self.publish["permissions"], {"pages": "write", "id-token": "write"})


@unittest.skipUnless(yaml, "Python's yaml is not installed")
class IssueForms(unittest.TestCase):
    def forms(self):
        found = {file.stem: yaml.safe_load(file.read_text()) for file in sorted(FORMS.glob("*.yml")) if file.stem != "config"}
        self.assertEqual(set(found), {"bug", "feature", "wrong-image"})
        return found

    def test_the_configuration(self):
        self.assertIn("blank_issues_enabled", yaml.safe_load((FORMS / "config.yml").read_text()))

    def test_forms_are_complete(self):
        for name, form in self.forms().items():
            for key in ("name", "description", "body"):
                self.assertTrue(form.get(key), f"{name}: {key}")
            inputs = [item for item in form["body"] if item["type"] != "markdown"]
            self.assertTrue(inputs, name)
            for item in inputs:
                self.assertIn(item["type"], INPUTS, name)
                self.assertTrue(item["attributes"]["label"], name)
            ids = [item["id"] for item in inputs]
            self.assertEqual(len(ids), len(set(ids)), name)
            labels = [item["attributes"]["label"] for item in inputs]
            self.assertEqual(len(labels), len(set(labels)), name)

    def required(self, name):
        return {item["id"] for item in self.forms()[name]["body"] if item.get("validations", {}).get("required")}

    def test_what_a_report_needs(self):
        self.assertLessEqual({"version", "command", "scene"}, self.required("bug"))
        self.assertLessEqual({"version", "command", "scene", "images", "reference"}, self.required("wrong-image"))


if __name__ == "__main__":
    if sys.argv[2:] == ["--actionlint"]:
        sys.exit(actionlint())
    program = unittest.main(argv=sys.argv[:1], exit=False)
    if program.result.wasSuccessful() and not yaml:
        print("Python's yaml is not installed: all but the text is skipped")
        sys.exit(SKIPPED)
    sys.exit(not program.result.wasSuccessful())
