#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Tests that images rendered by ranks of a real Open MPI have the bits of one process, whichever ranks are killed.

    mpi_test.py PROGRAM PICTURE_HASH SCENE

Exits with 77, printing the reason, if there is no mpirun or the program was built without MPI.
"""
import glob
import json
import math
import os
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import unittest

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "support"))
import waiting  # noqa: E402

PROGRAM, HASH, SCENE = (os.path.abspath(path) for path in sys.argv[1:4])
# The tests may run as root, with more ranks than cores.
MPI = {**os.environ, "OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1",
       "OMPI_MCA_rmaps_base_oversubscribe": "1",
       # Open MPI never frees some memory, which would make a sanitized build fail.
       "ASAN_OPTIONS": "detect_leaks=0"}
SIZE = ("--size", "200x150")
MODULE = "libfathom_mpi.so"


def trouble():
    """Returns the reason why nothing can be tested, or None."""
    if not shutil.which("mpirun"):
        return "there is no mpirun (scripts/test-cluster.sh installs Open MPI)"
    if not os.path.exists(os.path.join(os.path.dirname(PROGRAM), "..", "lib", MODULE)):
        return f"the program was built without MPI ({MODULE} is missing)"
    if "Open MPI" not in subprocess.run(["mpirun", "--version"], capture_output=True, text=True).stdout:
        return "mpirun is not that of Open MPI"
    result = subprocess.run(["mpirun", "-n", "2", "true"], env=MPI, capture_output=True, text=True)
    return None if result.returncode == 0 else "mpirun starts nothing here: " + " ".join(result.stderr.split())


def rank_of(process):
    """Returns the rank of a process if it runs the program, else None."""
    try:
        with open(f"/proc/{process}/environ", "rb") as file:
            words = dict(word.split(b"=", 1) for word in file.read().split(b"\0") if b"=" in word)
        if os.path.realpath(f"/proc/{process}/exe") == os.path.realpath(PROGRAM):
            return int(words[b"OMPI_COMM_WORLD_RANK"])
    except (OSError, KeyError, ValueError):
        pass
    return None


class Ranks(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        """Renders an image that takes sixteen seconds of processor time in one process."""
        cls.common = tempfile.mkdtemp(prefix="fathom-mpi-")
        cls.addClassCleanup(shutil.rmtree, cls.common, ignore_errors=True)
        film = os.path.join(cls.common, "second.exr")
        render = [PROGRAM, "render", SCENE, "-q", *SIZE]
        before = waiting.processor_seconds_of_children()
        waiting.run([*render, "--spp", "128", "--mergeable", "-o", film], check=True)
        cls.spp = str(int(16 * 128 / (waiting.processor_seconds_of_children() - before)))
        cls.whole = os.path.join(cls.common, "whole.exr")
        waiting.run([*render, "--spp", cls.spp, "-o", cls.whole], check=True)

    def setUp(self):
        self.folder = tempfile.mkdtemp(prefix="fathom-mpi-")
        self.addCleanup(shutil.rmtree, self.folder, ignore_errors=True)

    def path(self, name):
        return os.path.join(self.folder, name)

    def run_words(self, *words, code=0):
        result = waiting.run(words, env=MPI, cwd=self.folder)
        if code == 0:
            self.assertEqual(result.returncode, 0, f"{words}: {result.stdout}{result.stderr}")
        else:
            self.assertNotEqual(result.returncode, 0, f"{words}: {result.stdout}{result.stderr}")
        return result.stderr

    def alone(self, *words, **options):
        return self.run_words(PROGRAM, "render", SCENE, *words, **options)

    def ranks(self, count, *words, **options):
        return self.run_words("mpirun", "-n", str(count), PROGRAM, "render", SCENE, *words, **options)

    def time_to_keep(self):
        """Returns the setting of the time that mpirun waits before it ends ranks, and then before it kills them. It
        always waits for all of it, so the time is not simply long, but several times what a short run of as many ranks
        takes under the current load."""
        begin = time.monotonic()
        self.ranks(3, *SIZE, "--spp", "6", "--mergeable", "-q", "-o", os.path.join(self.common, "few.exr"))
        return {"OMPI_MCA_odls_base_sigkill_timeout": str(math.ceil(1 + 4 * (time.monotonic() - begin)))}

    def start(self, count, *words):
        """Starts ranks and waits until all of them have rendered. Returns mpirun and the processes by rank."""
        log = open(self.path("log"), "w")
        self.addCleanup(log.close)
        mpirun = subprocess.Popen(["mpirun", "-n", str(count), PROGRAM, "render", SCENE, *words],
                                  env={**MPI, **self.time_to_keep()}, cwd=self.folder, stderr=log, stdout=log)
        self.addCleanup(mpirun.wait)
        self.addCleanup(lambda: mpirun.poll() is None and mpirun.kill())

        def started():
            found = waiting.run(["ps", "-o", "pid=", "--ppid", str(mpirun.pid)]).stdout
            processes = {rank_of(pid): int(pid) for pid in found.split() if rank_of(pid) is not None}
            # The first line is printed when all ranks have met.
            return processes if len(processes) == count and "ranks on" in self.log() else None
        processes = waiting.wait_for("the ranks to meet", started, seen=self.log, stop=waiting.ended(mpirun, "mpirun"), pause_s=0.1)
        # All ranks have rendered once each has used another second of processor time.
        used = {process: waiting.processor_seconds(process) for process in processes.values()}
        waiting.wait_for("samples of all ranks", lambda: all(waiting.processor_seconds(process) > seconds + 1
                                                             for process, seconds in used.items()),
                         seen=self.log, stop=waiting.ended(mpirun, "mpirun"))
        return mpirun, processes

    def log(self):
        with open(self.path("log"), errors="replace") as file:
            return file.read()

    def wait(self, mpirun):
        waiting.wait_for("mpirun to end", lambda: mpirun.poll() is not None, seen=self.log)
        return self.log()

    def hash_of(self, picture):
        return waiting.run([HASH, self.path(picture)], check=True).stdout.split()[0]

    def info(self, film):
        return json.loads(waiting.run([PROGRAM, "info", self.path(film), "--json"], check=True).stdout)

    def own_lines(self, text):
        return [line for line in text.splitlines() if line.startswith("fathom: ")]

    def test_bits_of_one_process(self):
        options = ("--size", "120x90", "--spp", "150", "--aov", "albedo,instance,variance,samples", "--mergeable")
        self.alone(*options, "-o", "whole.exr")
        for count in (1, 2, 4, 8):
            said = self.ranks(count, *options, "-o", "out.exr")
            if count > 1:
                self.assertIn(f"{count} ranks on 1 machine, by Open MPI", said)
            self.assertEqual(said.count("wrote out.exr"), 1, "one rank writes")
            self.assertEqual(self.hash_of("out.exr"), self.hash_of("whole.exr"), f"{count} ranks")
            for what in ("samples", "noise", "dropped_samples", "settings"):
                self.assertEqual(self.info("out.exr")[what], self.info("whole.exr")[what])

    def test_samples_add_up(self):
        """Parts, crops, series and time limits give the image of one process."""
        self.alone("--size", "90x70", "--samples", "7:40", "--crop", "20,10,60,50", "-o", "whole.exr")
        self.ranks(3, "--size", "90x70", "--samples", "7:40", "--crop", "20,10,60,50", "-o", "part.exr")
        self.assertEqual(self.hash_of("part.exr"), self.hash_of("whole.exr"))
        self.alone("--size", "60x40", "--spp", "20", "--turntable", "2", "-o", "a#.exr")
        self.ranks(3, "--size", "60x40", "--spp", "20", "--turntable", "2", "-o", "b#.exr")
        for number in (0, 1):
            self.assertEqual(self.hash_of(f"a{number}.exr"), self.hash_of(f"b{number}.exr"))
        # A short time may be over on a slow machine before the ranks have met, which leaves one sample; a longer time
        # then gives more.
        for seconds in "2", "20", "200":
            self.ranks(2, "--size", "90x70", "--time", seconds, "--mergeable", "-o", "time.exr")
            (first, last), = self.info("time.exr")["samples"]
            self.assertEqual(first, 0)
            self.assertGreater(last, 0)
            if last > 1:
                break
        self.assertGreater(last, 1)
        self.alone("--size", "90x70", "--spp", str(last), "--mergeable", "-o", "same.exr")
        self.assertEqual(self.hash_of("time.exr"), self.hash_of("same.exr"))

    def test_guided_by_the_same(self):
        """Each rank learns guiding by itself, with the same result."""
        scene = os.path.join(os.path.dirname(SCENE), "model.json")
        options = ("--size", "64x48", "--spp", "6", "--guiding", "on")
        self.run_words(PROGRAM, "render", scene, *options, "-o", "whole.exr")
        self.run_words("mpirun", "-n", "2", PROGRAM, "render", scene, *options, "-o", "out.exr")
        self.assertEqual(self.hash_of("out.exr"), self.hash_of("whole.exr"))

    def killed(self, rank, *words):
        """Kills a rank and returns the output of the run."""
        mpirun, processes = self.start(3, *SIZE, "--spp", self.spp, *words)
        os.kill(processes[rank], signal.SIGKILL)
        said = self.wait(mpirun)
        self.assertNotEqual(mpirun.returncode, 0)
        self.assertIn("the samples so far are in", said)
        return said

    def test_a_rank_that_dies_leaves_the_others_samples(self):
        self.killed(2, "--checkpoint", "film.exr", "--every", "1h", "-o", "out.exr")
        self.assertEqual([os.path.basename(f) for f in sorted(glob.glob(self.path("film.rank*")))], ["film.rank1.exr"])
        self.assertGreater(sum(b - a for a, b in self.info("film.exr")["samples"]), 0)
        said = self.alone(*SIZE, "--spp", self.spp, "--checkpoint", "film.exr", "-o", "out.exr")
        self.assertRegex(said, rf"continuing from \d+ of {self.spp} samples in film.exr and in files of 1 ranks? beside it")
        self.assertEqual(self.hash_of("out.exr"), self.hash_of(self.whole))
        self.assertEqual(glob.glob(self.path("film.rank*")), [])
        self.assertEqual(self.info("film.exr")["samples"], [[0, int(self.spp)]])

    def test_without_a_checkpoint_too(self):
        """After rank 0 was killed, the printed command continues the run with other ranks."""
        said = self.killed(0, "-o", "out.exr")
        told = re.search(r"--checkpoint (\S+) --guiding (on|off)", said)
        self.assertTrue(told, said)
        self.assertEqual(len(glob.glob(self.path("out.checkpoint.rank*.exr"))), 2)
        said = self.ranks(2, *SIZE, "--spp", self.spp, "--guiding", told[2], "--checkpoint", told[1], "-o", "out.exr")
        self.assertRegex(said, rf"continuing from \d+ of {self.spp} samples")
        self.assertEqual(self.hash_of("out.exr"), self.hash_of(self.whole))
        self.assertEqual(glob.glob(self.path("out.checkpoint.rank*.exr")), [])

    def test_signals(self):
        options = (*SIZE, "--spp", "1000000", "--checkpoint", "film.exr", "--every", "1h")
        mpirun, _ = self.start(3, *options, "-o", "out.exr", "-o", "out.png")
        mpirun.send_signal(signal.SIGUSR1)
        waiting.wait_for("the picture so far", lambda: os.path.exists(self.path("out.png")), seen=self.log,
                         stop=waiting.ended(mpirun, "mpirun"))
        self.assertIsNone(mpirun.poll(), self.log())
        os.remove(self.path("out.png"))
        mpirun.send_signal(signal.SIGTERM)
        said = self.wait(mpirun)
        self.assertTrue(os.path.exists(self.path("out.png")), said)
        samples = int(re.search(r"interrupted: the image has (\d+) samples per pixel", said)[1])
        self.assertEqual(sum(b - a for a, b in self.info("film.exr")["samples"]), samples)
        self.assertEqual(glob.glob(self.path("film.rank*")), [])

    def test_told_once(self):
        missing = self.run_words("mpirun", "-n", "3", PROGRAM, "render", "missing.json", code=1)
        self.assertEqual(self.own_lines(missing), ["fathom: missing.json: no such file"])
        other = os.path.join(os.path.dirname(SCENE), "model.json")
        words = ("--size", "60x40", "--spp", "2", "-o", "out.exr")
        one = self.run_words("mpirun", "-n", "1", PROGRAM, "render", SCENE, *words, ":", "-n", "2", PROGRAM, "render", other,
                             *words, code=1)
        self.assertRegex("\n".join(self.own_lines(one)),
                         r"^fathom: rank 1 on \S+ would render another image than rank 0: .*another scene[^\n]*$")
        one = self.run_words("mpirun", "-n", "2", PROGRAM, "render", SCENE, *words, ":", "-n", "1", PROGRAM, "render",
                             "missing.json", *words, code=1)
        self.assertRegex("\n".join(self.own_lines(one)), r"^fathom: rank 2 on \S+: missing.json: no such file$")
        self.assertEqual(len(self.own_lines(self.ranks(3, "--spp", "none", code=1))), 1)
        self.assertEqual(len(self.own_lines(self.ranks(3, "--only-sample", "1,1,0", code=1))), 1)
        merge = self.run_words("mpirun", "-n", "3", PROGRAM, "merge", "a.exr", "-o", "b.exr", code=1)
        self.assertRegex("\n".join(self.own_lines(merge)), r"^fathom: 'fathom merge' runs as one process[^\n]*$")
        self.assertEqual(os.listdir(self.folder), [])

    def test_each_for_itself(self):
        script = f"'{PROGRAM}' render '{SCENE}' --mpi off --size 60x40 --spp 2 -q -o $OMPI_COMM_WORLD_RANK.png"
        self.run_words("mpirun", "-n", "2", "sh", "-c", script)
        self.assertEqual(sorted(os.listdir(self.folder)), ["0.png", "1.png"])

    def test_without_the_module(self):
        """Without the module, ranks fail with one line and no image, but a single process does not need it."""
        os.makedirs(self.path("tree/bin"))
        os.makedirs(self.path("tree/lib"))
        program = shutil.copy(PROGRAM, self.path("tree/bin/fathom"))
        libraries = os.path.join(os.path.dirname(PROGRAM), "..", "lib")
        for name in os.listdir(libraries):
            if name != MODULE:
                os.symlink(os.path.realpath(os.path.join(libraries, name)), self.path("tree/lib/" + name))
        words = (program, "render", SCENE, "--size", "60x40", "--spp", "2", "-o", "out.png")
        said = self.run_words("mpirun", "-n", "3", *words, code=1)
        self.assertRegex("\n".join(self.own_lines(said)), r"^fathom: started as one of 3 ranks[^\n]*libfathom_mpi.so[^\n]*$")
        self.assertFalse(os.path.exists(self.path("out.png")))
        self.run_words(*words)
        self.assertTrue(os.path.exists(self.path("out.png")))


if __name__ == "__main__":
    if why := trouble():
        print(f"skipped: {why}")
        sys.exit(77)
    unittest.main(argv=sys.argv[:1], verbosity=2)
