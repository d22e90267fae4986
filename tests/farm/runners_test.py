# SPDX-License-Identifier: Apache-2.0
"""Tests with runners that work on this machine: OpenJD's own runner, GNU parallel, Dask with a local cluster."""
import re
import shutil
import subprocess
import sys

from harness import FARM, ROOT, SAMPLES, Films, needs, needs_command, waiting

TEMPLATE = FARM / "openjd" / "fathom.yaml"


class OpenJobDescription(Films):
    def openjd(self, *words):
        return self.run_it(sys.executable, "-m", "openjd", *words)

    @needs("openjd", "openjd-cli")
    def test_the_template_is_valid(self):
        self.assertIn("passes validation", self.openjd("check", TEMPLATE).stdout)
        broken = self.films / "broken.yaml"
        broken.write_text(TEMPLATE.read_text().replace("dependsOn: Render", "dependsOn: Paint"))
        result = subprocess.run([sys.executable, "-m", "openjd", "check", broken], capture_output=True, text=True)
        self.assertNotEqual(result.returncode, 0)

    @needs("openjd", "openjd-cli")
    def test_a_run_renders_the_picture(self):
        self.openjd("run", TEMPLATE, "--step", "Merge", "--run-dependencies", "-p", f"Scene={self.films / 'scene.json'}", "-p", f"Films={self.films}",
                    "-p", f"Samples={SAMPLES}", "-p", "Parts=3", "-p", "PartNumbers=1-3", "-p", "Program=fathom")
        self.check_picture()


class Parallel(Films):
    def commands(self):
        """Returns both commands of the page, including their continuation lines."""
        page = (ROOT / "docs" / "farm" / "ssh.md").read_text()
        return re.findall(r"^    ((?:parallel|fathom merge) (?:[^\n\\]|\\\n)*)", page, flags=re.M)[:2]

    @needs_command("parallel")
    def test_the_pages_commands_render_the_picture(self):
        """The commands work as on the page, with this machine as the only one in the list."""
        render, merge = self.commands()
        (self.films / "machines").write_text(":\n")
        self.run_shell(render.replace("--spp 4096", f"--spp {SAMPLES}").replace("{1..16}", "1 2 3").replace("/16", "/3"), PARALLEL_HOME=str(self.folder))
        self.run_shell(merge)
        self.check_picture()

    @needs_command("parallel")
    def test_a_part_that_is_cut_off_is_taken_up_again(self):
        render, _ = self.commands()
        # The first attempt of each part ends like a render that received a signal.
        program = self.folder / "bin" / "fathom"
        shutil.move(program, self.folder / "bin" / "real")
        program.write_text('#!/bin/sh\nfor word in "$@"; do case $word in part-*.exr) tried=$word.tried;; esac; done\n'
                           '[ -e "$tried" ] || { touch "$tried"; exit 130; }\nexec real "$@"\n')
        program.chmod(0o755)
        (self.films / "machines").write_text(":\n")
        self.run_shell(render.replace("--spp 4096", f"--spp {SAMPLES}").replace("{1..16}", "1 2").replace("/16", "/2"), PARALLEL_HOME=str(self.folder))
        self.assertTrue((self.films / "part-2.exr").exists())


class Dask(Films):
    # Workers start and answer slowly on a busy machine.
    PATIENT = {f"DASK_DISTRIBUTED__{name}": "3600s" for name in ("COMM__TIMEOUTS__CONNECT", "COMM__TIMEOUTS__TCP", "SCHEDULER__WORKER_TTL")}

    @needs("distributed", "dask[distributed]")
    def test_workers_render_the_picture(self):
        self.run_it(sys.executable, FARM / "dask" / "render.py", "scene.json", ".", "--parts", "3", "--spp", str(SAMPLES), **self.PATIENT)
        self.check_picture()

    @needs("distributed", "dask[distributed]")
    def test_a_part_that_fails_is_told(self):
        result = waiting.run([sys.executable, FARM / "dask" / "render.py", "none.json", ".", "--parts", "1"], cwd=self.films,
                             env=self.environment(**self.PATIENT))
        self.assertEqual(result.returncode, 1)
        self.assertIn("part 1: fathom: ", result.stderr)
