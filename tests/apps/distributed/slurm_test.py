#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Tests that images rendered in parts by a real Slurm have the bits of one run, whatever is killed, requeued, drained
or cancelled.

    slurm_test.py PROGRAM PICTURE_HASH SCENE [long]

Exits with 77, printing the reason, if Slurm is not installed.
"""
import json
import os
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import unittest

import slurm
from slurm import waiting

PROGRAM, HASH, SCENE = (os.path.abspath(path) for path in sys.argv[1:4])
LONG = "long" in sys.argv[4:]


def can_hide_folders():
    return subprocess.run(["unshare", "--mount", "sh", "-c", "mount -t tmpfs none /mnt"], capture_output=True).returncode == 0


class Parts(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.root = tempfile.mkdtemp(prefix="fathom-slurm-")
        cls.addClassCleanup(shutil.rmtree, cls.root, ignore_errors=True)
        hidden = os.path.join(cls.root, "hidden")
        os.mkdir(hidden)
        cls.hidden = hidden if can_hide_folders() else None
        cls.cluster = slurm.Slurm(os.path.join(cls.root, "slurm"), hidden=cls.hidden)
        cls.addClassCleanup(cls.cluster.stop)
        cls.cluster.start()

    def setUp(self):
        self.folder = tempfile.mkdtemp(dir=self.root)
        self.picture = os.path.join(self.folder, "out.exr")

    def fathom(self, *words, code=0):
        result = waiting.run([PROGRAM, *words], env=self.cluster.environment, cwd=self.folder)
        self.assertEqual(result.returncode, code, f"{words}: {result.stdout}{result.stderr}")
        return result.stdout + result.stderr

    def submit(self, *words, scene=SCENE, **options):
        return self.fathom("submit", scene, "--slurm", "-o", self.picture, *words, **options)

    def status(self):
        return json.loads(self.fathom("status", self.picture, "--json"))

    def hash_of(self, picture):
        return waiting.run([HASH, picture], check=True).stdout.split()[0]

    def assert_same_as_one_run(self, samples, *options):
        whole = os.path.join(self.folder, "whole.exr")
        self.fathom("render", SCENE, *options, "--samples", f"0:{samples}", "-q", "-o", whole)
        self.assertEqual(self.hash_of(self.picture), self.hash_of(whole))

    def samples_in(self, seconds, *options):
        """Returns the number of samples that one thread renders in about this much processor time."""
        before = waiting.processor_seconds_of_children()
        self.fathom("render", SCENE, *options, "--spp", "64", "--threads", "1", "-q", "-o", os.path.join(self.folder, "few.png"))
        return int(64 * seconds / (waiting.processor_seconds_of_children() - before))

    def submission(self):
        with open(os.path.join(self.picture + ".parts", "plan.json")) as file:
            return json.load(file)["submissions"][-1]

    def array(self):
        return self.submission()["array"]

    def film(self, part):
        return os.path.join(self.picture + ".parts", f"part-{part:04}.exr")

    def wait_until_ended(self):
        """Waits until no task and no merge waits or runs."""
        def ended():
            status = self.status()
            # Nodes are resumed, because nothing would ever run if all of them were drained.
            for node in (1, 3, 4):
                self.cluster.ask("scontrol", "update", f"NodeName=n{node}", "State=RESUME")
            # On a busy machine Slurm holds a task whose launch failed until it is released.
            for line in self.cluster.ask("squeue", "-h", "-o", "%i %r").splitlines():
                if "held" in line:
                    self.cluster.ask("scontrol", "release", line.split()[0])
            return status["scheduler_answers"] and not status["merge_waits"] and not any(
                part["state"] in ("running", "waiting") for part in status["parts"])
        self.cluster.wait_for("all tasks to end", ended, seen=self.status)

    def hold(self, count, known=()):
        """Waits until `count` parts that are not in `known` run at the same time, and returns their processes. They are
        stopped, so that none ends while others are waited for, and have not saved any samples yet."""
        held = {}

        def are_held():
            for part, process in self.running().items():
                if part in held or part in known:
                    continue
                if not waiting.stop(process):
                    continue
                if os.path.exists(self.film(part)):
                    self.go_on(process)
                else:
                    held[part] = process
            return len(held) >= count
        self.cluster.wait_for(f"{count} parts to run", are_held, seen=lambda: f"held: {held}")
        return held

    def wait_for_samples(self, part):
        """Returns the process of a part once its film has samples."""
        def handles_signals():
            process = self.running().get(part)
            return process if process and waiting.has_signal(process, "SigCgt", signal.SIGUSR1) else None
        process = self.cluster.wait_for(f"part {part} to run", handles_signals, seen=self.status)
        os.kill(process, signal.SIGUSR1)  # requests the film, which is written after this pass
        self.cluster.wait_for(f"samples of part {part}", lambda: os.path.exists(self.film(part)), seen=self.status, stop=self.gone(process))
        return process

    def running(self):
        """Returns the processes that render parts of this test's image, by part."""
        found = {}
        for name in filter(str.isdigit, os.listdir("/proc")):
            try:
                with open(f"/proc/{name}/cmdline", "rb") as file:
                    words = file.read().decode(errors="replace").split("\0")
            except OSError:
                continue
            if words[0] == PROGRAM and "--part" in words and any(self.folder in word for word in words):
                found[int(words[words.index("--part") + 1].split("/")[0])] = int(name)
        return found

    def gone(self, process):
        """Returns an argument `stop` for wait_for()."""
        return lambda: not waiting.is_running(process) and f"process {process} has ended"

    def go_on(self, process):
        """Continues a stopped process if it still exists."""
        try:
            os.kill(process, signal.SIGCONT)
        except ProcessLookupError:
            pass

    def logs(self):
        folder = self.picture + ".parts"
        text = ""
        for name in sorted(os.listdir(folder)):
            if name.endswith(".log"):
                with open(os.path.join(folder, name), errors="replace") as file:
                    text += f"{name}: {file.read()}\n"
        return text

    def test_bits_of_one_run(self):
        options = ("--size", "120x90", "--aov", "albedo,variance")
        png = os.path.join(self.folder, "out.png")
        said = self.submit(*options, "--spp", "22", "--parts", "5", "-o", png, "--exposure", "1")
        self.assertIn("5 parts", said)
        self.wait_until_ended()
        status = self.status()
        self.assertEqual([part["state"] for part in status["parts"]], ["done"] * 5, self.logs())
        self.assertEqual((status["samples_done"], status["merged"]), (22, True))
        self.assert_same_as_one_run(22, *options)
        self.assertTrue(os.path.exists(png))
        self.assertIn("all parts are complete", self.submit(*options, "--spp", "22", "--parts", "5", "-o", png, "--exposure", "1"))
        refused = self.submit(*options, "--spp", "44", "--parts", "5", code=1)
        self.assertIn("44 samples per pixel, not 22", refused)

    def test_faults(self):
        """Parts survive being killed, requeued and drained, and a controller that is down for a while."""
        parts, faults = (16, 4) if LONG else (8, 2)
        samples = parts * 48
        options = ("--size", "800x600")  # some seconds for each part
        self.submit(*options, "--spp", str(samples), "--parts", str(parts))
        held = self.hold(4)
        self.assertIn("under way", self.submit(*options, "--spp", str(samples), "--parts", str(parts)))
        self.cluster.run("scontrol", "update", "NodeName=n2", "State=DRAIN", "Reason=test")
        killed, requeued = set(), set()
        while len(killed) < faults or len(requeued) < faults:
            for part in sorted(held.keys() - killed - requeued):
                if len(killed) < faults and len(killed) <= len(requeued):
                    killed.add(part)
                    os.kill(held[part], signal.SIGKILL)
                elif len(requeued) < faults:
                    requeued.add(part)
                    self.cluster.run("scontrol", "requeue", f"{self.array()}_{part}")
                    self.go_on(held[part])
            if len(killed) < faults or len(requeued) < faults:
                held.update(self.hold(1, known=held.keys()))
        self.cluster.wait_for("Slurm to notice what was killed", lambda: killed <= {
            part["part"] for part in self.status()["parts"] if part["state"] not in ("running", "waiting")}, seen=self.status)
        self.cluster.wait_until_saved(self.submission()["merge"])
        self.cluster.kill_controller()
        self.assertIn("doesn't answer", self.fathom("status", self.picture))
        for process in held.values():
            self.go_on(process)
        self.cluster.start_controller()
        self.cluster.wait_for("the controller", lambda: self.cluster.ask("sinfo", "-h"))
        self.wait_until_ended()
        # A restarted controller drains nodes on which something ended meanwhile; an administrator would resume them.
        for node in range(1, 5):
            self.cluster.ask("scontrol", "update", f"NodeName=n{node}", "State=RESUME")
        status = self.status()
        self.assertLessEqual(killed, {part["part"] for part in status["parts"] if part["state"] != "done"}, self.logs())
        self.assertIn("submit --fix", self.fathom("status", self.picture))
        self.fathom("submit", "--fix", self.picture)
        self.wait_until_ended()
        self.assertEqual({part["state"] for part in self.status()["parts"]}, {"done"}, self.logs())
        self.assert_same_as_one_run(samples, *options)

    def test_warned_tasks_go_on_in_another_turn(self):
        options = ("--size", "400x300")
        samples = 2 * self.samples_in(12, *options)
        self.submit(*options, "--spp", str(samples), "--parts", "2")
        process = self.wait_for_samples(1)
        # The process is stopped, so it can't end by itself before the task's script ends it.
        self.assertTrue(waiting.stop(process))
        self.cluster.run("scancel", "--batch", "--signal=USR1", f"{self.array()}_1")
        self.cluster.wait_for("the script to end its render", lambda: waiting.has_signal(process, "ShdPnd", signal.SIGTERM),
                              seen=self.status, stop=self.gone(process))
        self.go_on(process)
        self.wait_until_ended()
        self.assertEqual([part["state"] for part in self.status()["parts"]], ["done"] * 2, self.logs())
        self.assertEqual(self.logs().count("continuing from"), 1, self.logs())
        self.assert_same_as_one_run(samples, *options)

    def test_cancelled_stays_cancelled(self):
        self.submit("--size", "400x300", "--spp", "20000", "--parts", "2")
        processes = [self.wait_for_samples(part) for part in (1, 2)]
        kept = self.status()["samples_done"]
        for process in processes:  # waits for some passes
            enough = waiting.processor_seconds(process) + 4
            self.cluster.wait_for("more samples", lambda: waiting.processor_seconds(process) >= enough, stop=self.gone(process))
        self.cluster.run("scancel", self.array())
        self.wait_until_ended()
        self.assertEqual(self.running(), {})
        self.assertEqual(len([p for p in self.status()["parts"] if p["state"] == "missing"]), 2)
        self.assertLess(self.status()["samples_done"], 20000)
        self.assertGreater(kept, 0)
        self.assertGreater(self.status()["samples_done"], kept, "what was rendered at the end is kept")
        self.assertTrue(self.status()["merged"], "what was there at the end is merged: " + self.logs())

    @unittest.skipUnless(LONG, "takes minutes: Slurm looks at limits every half minute")
    def test_turns(self):
        """Tasks whose time limit is too short are continued by later tasks."""
        size = ("--size", "800x600")
        samples = self.samples_in(150, *size)  # takes longer than the limit of one minute
        self.submit(*size, "--spp", str(samples), "--parts", "1", "--time", "1")
        self.wait_until_ended()
        self.assertEqual(self.status()["samples_done"], samples, self.logs())
        self.assertGreaterEqual(self.logs().count("continuing from"), 1, self.logs())
        self.assert_same_as_one_run(samples, *size)

    def test_held_tasks_wait_for_whoever_holds_them(self):
        self.submit("--size", "60x45", "--spp", "4", "--parts", "2", "--sbatch", "--hold")
        told = self.fathom("status", self.picture)
        for part in (1, 2):
            self.assertIn(f"scontrol release {self.array()}_{part}", told)
        self.assertEqual([(part["state"], part.get("held")) for part in self.status()["parts"]], [("waiting", True)] * 2)
        self.fathom("submit", "--fix", self.picture)
        self.assertEqual(self.running(), {}, "whoever holds a task has a reason")
        merge = re.search(r"merges the parts is held by a user: scontrol release (\d+)", told)[1]
        self.cluster.run("scontrol", "release", self.array())
        self.cluster.run("scontrol", "release", merge)
        self.wait_until_ended()
        self.assertEqual([(part["state"], part.get("held")) for part in self.status()["parts"]], [("done", None)] * 2, self.logs())

    def test_told_before(self):
        said = self.submit("--spp", "100", "--parts", "64", code=2)
        self.assertIn("up to 63 tasks", said)
        self.assertIn("can't be split", self.submit("--spp", "3", "--parts", "4", code=2))
        self.assertIn("is not there", self.submit("--spp", "4", "--parts", "4", scene="missing.json", code=1).replace(
            "no such file", "is not there").replace("No such file", "is not there").replace("there is no", "is not there"))
        self.assertIn("submit it first", self.fathom("status", self.picture, code=1))
        self.assertEqual(os.listdir(self.folder), [])

    def test_nodes_that_see_nothing(self):
        if not self.hidden:
            self.skipTest("folders can't be hidden from nodes here")
        scene = os.path.join(self.hidden, "scene.json")
        shutil.copy(SCENE, scene)
        said = self.submit("--spp", "4", "--parts", "2", scene=scene, code=1)
        self.assertIn(scene, said)
        self.assertIn("shared folder", said)
        self.assertEqual(os.listdir(self.folder), [])

    def test_dry_run(self):
        scripts = self.submit("--spp", "4", "--parts", "2", "--sbatch", "--qos=low --nice=5", "--account", "ray's", "--dry-run")
        self.assertEqual(os.listdir(self.folder), [])
        for word in ("--array=1-2", "--qos=low", "--nice=5", "afterany", "merge"):
            self.assertIn(word, scripts)
        for script in re.split(r"(?=^#!)", scripts, flags=re.M)[1:]:
            subprocess.run(["bash", "-n"], input=script, text=True, check=True)


if __name__ == "__main__":
    if missing := slurm.missing_program():
        print(f"skipped: '{missing}' is not installed (scripts/test-cluster.sh installs Slurm)")
        sys.exit(77)
    if trouble := slurm.why_none_comes_up():
        print(f"skipped: no Slurm comes up here: {trouble}")
        sys.exit(77)
    unittest.main(argv=sys.argv[:1], verbosity=2)
