#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Tests of the command line: checkpoints, signals, parts."""
import json
import os
import resource
import signal
import subprocess
from pathlib import Path

from harness import CommandLine, DOUBLE, PROGRAM, Gate, run_tests, waiting


class Checkpoints(CommandLine):
    def render(self, *arguments):
        return ["render", "box.json", "--size", "9x7", *arguments]

    def sums(self, name):
        info = json.loads(self.ok("info", name, "--json").stdout)
        return info["samples"], info["noise"], info["dropped_samples"], info["settings"]

    def test_goes_on_by_itself_with_the_same_bits(self):
        self.ok(*self.render("--spp", "16", "-o", "whole.exr", "--mergeable"))
        self.ok(*self.render("--spp", "16", "-o", "whole.png"))
        self.assertNotIn("continuing from", self.ok(*self.render("--spp", "5", "--checkpoint", "c.exr", "-o", "a.png")).stderr)
        text = self.ok(*self.render("--spp", "16", "--checkpoint", "c.exr", "-o", "a.png")).stderr
        self.assertIn("continuing from 5 of 16 samples in c.exr\n", text)
        self.assertEqual(self.read("a.png"), self.read("whole.png"))
        self.assertEqual(self.sums("c.exr"), self.sums("whole.exr"))
        # In another run nothing is left to do, and nothing is written but the image.
        before = os.stat(self.path("c.exr"))
        os.remove(self.path("a.png"))
        self.assertIn("continuing from 16 of 16", self.ok(*self.render("--spp", "16", "--checkpoint", "c.exr", "-o", "a.png")).stderr)
        self.assertEqual(self.read("a.png"), self.read("whole.png"))
        self.assertEqual(os.stat(self.path("c.exr")).st_ino, before.st_ino)

    def test_two_generations_are_kept(self):
        for samples in "4", "8", "12":
            self.ok(*self.render("--spp", samples, "--checkpoint", "c.exr", "-o", "a.png"))
        self.assertEqual(self.sums("c.exr")[0], [[0, 12]])
        self.assertEqual(self.sums("c.previous.exr")[0], [[0, 8]])
        self.ok(*self.render("--spp", "16", "-o", "whole.png"))
        for damage in ("cut", "flip", "empty", "gone", "swapped"):
            for samples in "8", "12":
                self.ok(*self.render("--spp", samples, "--checkpoint", "d.exr", "-o", "a.png"))
            data = self.read("d.exr")
            path = Path(self.path("d.exr"))
            if damage == "gone":
                path.unlink()
            elif damage == "swapped":
                os.rename(path, self.path("e.exr"))
                os.rename(self.path("d.previous.exr"), path)
                os.rename(self.path("e.exr"), self.path("d.previous.exr"))
            else:
                path.write_bytes({"cut": data[:-5], "flip": data[:-5] + b"\x55" + data[-4:], "empty": b""}[damage])
            text = self.ok(*self.render("--spp", "16", "--checkpoint", "d.exr", "-o", "a.png")).stderr
            if damage in ("cut", "flip", "empty"):
                self.assertIn("d.exr: ", text)
                self.assertIn("the previous checkpoint is used", text)
            self.assertIn("continuing from 12 of 16 samples in d.previous.exr" if damage == "swapped" else
                          "continuing from 8 of 16 samples in d.previous.exr", text)
            self.assertEqual(self.read("a.png"), self.read("whole.png"), damage)
            os.remove(self.path("d.exr"))
            os.remove(self.path("d.previous.exr"))

    def leave_as_rank(self, number, samples, name="c"):
        """Leaves the file that a rank of an interrupted run leaves beside the checkpoint."""
        self.ok(*self.render("--samples", samples, "--checkpoint", f"{name}.rank{number}.exr", "-q"))

    def test_goes_on_from_what_ranks_have_left(self):
        self.ok(*self.render("--spp", "16", "-o", "whole.png"))
        self.ok(*self.render("--spp", "3", "--checkpoint", "c.exr", "-o", "a.png"))
        self.leave_as_rank(1, "5:7")
        self.leave_as_rank(12, "8:16")
        self.leave_as_rank(2, "1:9", name="other")
        # One file does not belong to a rank, and one has samples that are in the checkpoint already, as after a run
        # that ended before it removed the file.
        Path(self.path("c.rankless.exr")).write_bytes(b"mine")
        self.leave_as_rank(3, "0:2")
        text = self.ok(*self.render("--spp", "16", "--checkpoint", "c.exr", "-o", "a.png")).stderr
        self.assertIn("continuing from 13 of 16 samples in c.exr and in files of 3 ranks beside it\n", text)
        self.assertEqual(self.read("a.png"), self.read("whole.png"))
        self.assertEqual(self.sums("c.exr")[0], [[0, 16]])
        left = sorted(name for name in os.listdir(self.folder) if ".rank" in name)
        self.assertEqual(left, ["c.rankless.exr", "other.rank2.exr"])

    def test_ranks_alone_are_enough(self):
        """Rank 0, which writes the checkpoint itself, had no samples yet; the other ranks have all of them."""
        self.leave_as_rank(1, "0:10")
        self.leave_as_rank(2, "10:16")
        text = self.ok(*self.render("--spp", "16", "--checkpoint", "c.exr")).stderr
        self.assertIn("continuing from 16 of 16 samples", text)
        self.assertEqual(self.sums("c.exr")[0], [[0, 16]])
        self.assertEqual([name for name in os.listdir(self.folder) if ".rank" in name], [])

    def test_what_a_rank_has_damaged_is_rendered_anew(self):
        self.ok(*self.render("--spp", "16", "-o", "whole.png"))
        self.ok(*self.render("--spp", "3", "--checkpoint", "c.exr", "-o", "a.png"))
        self.leave_as_rank(1, "5:7")
        data = self.read("c.rank1.exr")
        Path(self.path("c.rank1.exr")).write_bytes(data[:-5] + b"\x55" + data[-4:])
        text = self.ok(*self.render("--spp", "16", "--checkpoint", "c.exr", "-o", "a.png")).stderr
        self.assertRegex(text, r"(?m)^fathom: c.rank1.exr: .*its samples are rendered again$")
        self.assertIn("continuing from 3 of 16 samples in c.exr\n", text)
        self.assertEqual(self.read("a.png"), self.read("whole.png"))
        # A rank's file of another render is refused, as the checkpoint itself is.
        self.ok(*self.render("--samples", "20:22", "--seed", "1", "--checkpoint", "c.rank1.exr", "-q"))
        refused = self.run_program(*self.render("--spp", "32", "--checkpoint", "c.exr", "-o", "a.png"))
        self.assertEqual(refused.returncode, 1)
        self.assertIn("fathom: c.rank1.exr: belongs to another render, which differs in: seed is 0, not 1", refused.stderr)

    def test_what_is_of_another_render_is_refused(self):
        self.ok(*self.render("--spp", "4", "--checkpoint", "c.exr", "-o", "a.png"))
        before = self.read("c.exr")
        refused = lambda *arguments, words: self.refused(1, *self.render("--checkpoint", "c.exr", "-o", "b.png", "-q", *arguments), words=words)
        refused("--spp", "8", "--seed", "3", words=["c.exr: ", "another render", "seed is 3, not 0"])
        refused("--spp", "2", words=["c.exr: ", "0:4", "0:2", "ask for more"])
        refused("--samples", "2:9", words=["c.exr: ", "0:4", "2:9"])
        self.assertEqual(self.read("c.exr"), before)
        self.scene("no-film.exr", "no film at all")
        self.refused(1, *self.render("--checkpoint", "no-film.exr", "-o", "b.png", "-q", "--spp", "1"), words=["no-film.exr: this is not a film file"])
        self.assertEqual(self.read("no-film.exr"), b"no film at all")
        for wrong in (["--every", "3"], ["--checkpoint", "c.png"], ["--checkpoint", "c.exr", "--frames", "0:2"],
                      ["--checkpoint", "c.exr", "-o", "c.exr"], ["--part", "3/2"], ["--part", "0/2"], ["--part", "2"],
                      ["--part", "1/2", "--time", "3"]):
            self.refused(2, "render", "box.json", *wrong)
        result = self.run_program("render", "box.json", "--part", "1/9", "--spp", "8", "-o", "a.exr")
        self.assertEqual(result.returncode, 2)
        self.assertIn("--part: 8 samples can't be split into 9 parts", result.stderr)

    def test_what_differs_is_told_by_name(self):
        if not PROGRAM:
            self.skipTest("needs the program")
        def scene(color, radius="1", camera="[0, 0, 5]"):
            self.scene("s.json", '{"fathom": 1, "camera": {"position": %s, "look_at": [0, 0, 0]}, "materials": {"wall": '
                       '{"color": %s}}, "environment": {"kind": "constant", "color": 1}, "scene": '
                       '[{"sphere": {"radius": %s}, "material": "wall"}]}' % (camera, color, radius))
        run = lambda: self.run_program("render", "s.json", "--spp", "2", "--size", "8x8", "--checkpoint", "c.exr", "-q", program=PROGRAM)
        scene("[0.5, 0.5, 0.5]")
        self.assertEqual(run().returncode, 0, run().stderr)
        for arguments, words in ((["[0.5, 0.5, 0.6]"], "material 'wall': color;"), (["[0.5, 0.5, 0.5]", "2"], "shapes, placement"),
                                 (["[0.5, 0.5, 0.5]", "1", "[0, 1, 5]"], "camera 'camera': place")):
            scene(*arguments)
            result = run()
            self.assertEqual(result.returncode, 1)
            self.assertIn(words, result.stderr)

    def test_interrupted_and_killed_renders_go_on(self):
        self.ok(*self.render("--spp", "1000", "-o", "whole.png"))
        arguments = ["--size", "9x7", "--spp", "1000", "--checkpoint", "c.exr", "--every", "0.01s", "-o", "a.png"]
        process, gate = self.start_at_gate(3, *arguments)
        process.send_signal(signal.SIGTERM)
        self.read_until(process, "interrupted")
        gate.allow(4)
        text = waiting.finish(process)[1]
        self.assertEqual(process.returncode, 130, text)
        self.assertEqual(self.sums("c.exr")[0], [[0, 4]])

        # A render that is killed between the two renamings leaves the newer generation under the name of the previous
        # one.
        def kept():
            """Returns the number of saved samples. While the program runs, each generation may be without its name for
            a moment."""
            found = [self.run_program("info", file, "--json") for file in ("c.exr", "c.previous.exr")]
            return max((json.loads(result.stdout)["samples"][0][1] for result in found if result.returncode == 0), default=0)

        process, gate = self.start_at_gate(5, *arguments)
        allowed = 5
        while kept() <= 5 and allowed < 990:
            allowed += 1
            gate.allow(allowed)
            gate.wait(process, allowed)
        process.kill()
        text = waiting.finish(process)[1]
        self.assertEqual(process.returncode, -9, text)
        samples = max(self.sums(file)[0][0][1] for file in ("c.exr", "c.previous.exr") if os.path.exists(self.path(file)))
        self.assertGreater(samples, 5, "no checkpoint was written meanwhile")
        self.assertLessEqual(samples, allowed)
        text = self.ok("render", "box.json", *arguments).stderr
        self.assertIn(f"continuing from {samples} of 1000", text)
        self.assertEqual(self.read("a.png"), self.read("whole.png"))

    def test_time_is_that_of_this_run(self):
        self.scene("slow.json", "camera a slow 20")
        for run in range(3):
            text = self.ok("render", "slow.json", "--size", "9x7", "--time", "0.5", "--checkpoint", "c.exr", "-o", "a.png").stderr
            self.assertEqual("continuing from" in text, run > 0)
        first = self.sums("c.previous.exr")[0]
        last = self.sums("c.exr")[0]
        self.assertEqual(len(last), 1)
        self.assertGreater(last[0][1], first[0][1])

    def test_a_checkpoint_that_can_t_be_written_stops_nothing(self):
        # A limit on the size of files simulates a full disk; the image is small enough.
        limit = lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (800, 800))
        self.scene("slow.json", "camera a slow 20")
        text = self.ok("render", "slow.json", "--size", "9x7", "--spp", "30", "--checkpoint", "c.exr", "--every", "0.1", "-o", "a.png",
                       preexec_fn=limit).stderr
        self.assertEqual(text.count("c.exr: can't write"), 1, text)
        self.assertIn("the render continues and will try again", text)
        self.assertTrue(os.path.exists(self.path("a.png")))
        self.assertFalse(os.path.exists(self.path("c.exr")))

    def test_a_picture_that_can_t_be_written_is_written_elsewhere(self):
        for folder in "out", "work", "tmp":
            os.mkdir(self.path(folder))
        process, gate = self.start_at_gate(1, "--size", "9x7", "-o", "../out/a.png", cwd=self.path("work"),
                                           env={**os.environ, "TMPDIR": self.path("tmp")})
        os.rmdir(self.path("out"))
        gate.allow()
        text = waiting.finish(process)[1]
        self.assertEqual(process.returncode, 1)
        self.assertIn("out/a.png: can't write", text)
        self.assertIn("wrote " + os.path.realpath(self.path("work")) + "/a.png", text)
        self.assertEqual(os.listdir(self.path("work")), ["a.png"])

    def test_a_signal_asks_for_the_picture(self):
        process, gate = self.start_at_gate(2, "--size", "9x7", "--checkpoint", "c.exr", "--every", "1h", "-o", "a.png")
        process.send_signal(signal.SIGUSR1)
        gate.allow(3)
        for name in "a.png", "c.exr":
            waiting.wait_for(name, lambda: os.path.exists(self.path(name)), stop=waiting.ended(process))
        gate.wait(process, 3)
        self.assertEqual(self.sums("c.exr")[0], [[0, 3]])
        process.send_signal(signal.SIGINT)
        self.read_until(process, "interrupted")
        gate.allow()
        waiting.finish(process)
        self.assertEqual(process.returncode, 130)

    def test_an_interrupt_while_loading_ends_at_once(self):
        """The gate never opens, so the program must not wait until the file is loaded."""
        for number in signal.SIGINT, signal.SIGTERM, signal.SIGHUP:
            gate = Gate(self)
            self.scene("slow.json", f"camera a load-gate {gate.path}")
            process = subprocess.Popen([DOUBLE, "render", "slow.json", "-o", "a.png"], cwd=self.folder,
                                       stderr=subprocess.PIPE, text=True)
            gate.wait(process, 0)
            process.send_signal(number)
            text = waiting.finish(process)[1]
            self.assertEqual(process.returncode, 130)
            self.assertIn("interrupted before anything was rendered", text)

    def interrupt(self, process):
        """Interrupts a process. Returns the processor time until it ends, which does not depend on the machine's load,
        and what it printed meanwhile."""
        before = waiting.processor_seconds(process.pid)
        process.send_signal(signal.SIGTERM)
        said = process.stderr.read()
        process.stderr.close()
        _, status, usage = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
        self.assertEqual(process.returncode, 130)
        return usage.ru_utime + usage.ru_stime - before, said

    def test_an_interrupt_does_not_wait_for_a_long_pass(self):
        """Interrupts the program in the second pass of samples that take seconds each, and while it learns guiding."""
        if not PROGRAM:
            self.skipTest("needs the program")
        spheres = ", ".join('{"sphere": {"radius": %g}, "material": "white", "transform": [{"translate": [%d, 0, 0]}]}' % at
                            for at in ((20, 0), (0.6, -1), (0.6, 1)))
        self.scene("white.json", '{"fathom": 1, "camera": {"position": [0, 0, 5], "look_at": [0, 0, 0]}, "materials": '
                   '{"white": {"kind": "diffuse", "color": [0.97, 0.97, 0.97]}}, "environment": {"kind": "gradient"}, '
                   '"scene": [%s]}' % spheres)

        def start(guiding):
            return subprocess.Popen([PROGRAM, "render", "white.json", "--size", "1920x1080", "--roulette-depth", "100",
                                     "--spp", "1000", "--threads", "1", "--guiding", guiding, "--progress", "json",
                                     "--checkpoint", f"{guiding}.exr", "-o", "a.png"], cwd=self.folder, stderr=subprocess.PIPE, text=True)

        def passes(said):
            events = [json.loads(line) for line in said.splitlines()]
            return max((event["samples_done"] for event in events if event["event"] == "progress"), default=0) // (1920 * 1080)

        process = start("off")
        said = self.read_until(process, '"progress"')
        one_pass = waiting.processor_seconds(process.pid)
        seconds, rest = self.interrupt(process)
        # The limit includes the time for writing files at the end.
        self.assertLess(seconds, one_pass / 2)
        # One pass is kept, or more if the signal came late.
        self.assertEqual(json.loads(self.ok("info", "off.exr", "--json").stdout)["samples"], [[0, passes(said + rest)]])

        for _ in range(10):
            process = start("on")
            waiting.wait_for("the program to learn", lambda: waiting.processor_seconds(process.pid) >= one_pass / 10,
                             stop=waiting.ended(process), pause_s=0.01)
            seconds, said = self.interrupt(process)
            if passes(said) == 0:
                break
            os.remove(self.path("on.exr"))  # the machine was busy with other work for the duration of a pass
        self.assertLess(seconds, one_pass / 4)
        self.assertFalse(os.path.exists(self.path("on.exr")))

    def test_parts(self):
        self.ok(*self.render("--spp", "11", "-o", "whole.png"))
        for part in range(1, 5):
            self.ok(*self.render("--spp", "11", "--part", f"{part}/4", "-o", f"{part}.exr"))
        self.assertEqual([self.sums(f"{part}.exr")[0] for part in range(1, 5)], [[[0, 2]], [[2, 5]], [[5, 8]], [[8, 11]]])
        text = self.ok("merge", "4.exr", "2.exr", "-o", "some.exr").stderr
        self.assertIn("missing: samples 0:2,5:8 (parts 1, 3 of 4)\n", text)
        text = self.ok("merge", "some.exr", "3.exr", "-o", "more.exr").stderr
        self.assertIn("missing: samples 0:2 (part 1 of 4)\n", text)
        self.assertNotIn("missing", self.ok("merge", "more.exr", "1.exr", "-o", "all.png").stderr)
        self.assertEqual(self.read("all.png"), self.read("whole.png"))

    def test_the_page_on_long_renders(self):
        """The commands of the page work as they are written, in their order."""
        page = Path(__file__).parents[3] / "docs" / "long-renders.md"
        commands = [line.split() for line in page.read_text().splitlines() if line.lstrip().startswith("fathom ")]
        self.assertGreater(len(commands), 8)
        self.scene("scene.json", "camera main size 9 7")
        told = "".join(self.ok(*command[1:]).stderr for command in commands)
        self.assertIn("continuing from 1024 of 4096 samples in film.exr", told)
        self.assertIn("missing: samples 512:768 (part 3 of 4)", told)
        self.assertEqual(told.count("missing"), 1)

    def test_a_part_has_a_checkpoint_too(self):
        self.ok(*self.render("--spp", "12", "--part", "2/3", "-o", "whole.exr"))
        arguments = self.render("--spp", "12", "--part", "2/3", "--checkpoint", "c.exr", "-o", "a.exr")
        self.ok(*arguments)
        self.assertIn("continuing from 4 of 4 samples", self.ok(*arguments).stderr)
        self.assertEqual(self.sums("a.exr"), self.sums("whole.exr"))
        self.assertIn(": 4:8", self.ok("merge", "c.exr", "-o", "m.exr").stderr)


if __name__ == "__main__":
    run_tests()
