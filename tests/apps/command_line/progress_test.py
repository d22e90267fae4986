#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Tests of the command line: time limits, progress, signals, threads."""
import fcntl
import json
import os
import pty
import re
import resource
import signal
import struct
import subprocess
import termios
import time

from harness import CommandLine, DOUBLE, PROGRAM, WITHOUT_LEAK_CHECK, Gate, is_thread_sanitized, png_size, run_tests, waiting


class Running(CommandLine):
    def test_time(self):
        self.scene("slow.json", "camera a slow 20")
        text = self.ok("render", "slow.json", "--time", "0.8s", "--size", "4x4").stderr
        samples = int(re.search(r"(\d+) samples per pixel", text).group(1))
        self.assertGreater(samples, 0)
        self.assertLess(samples, 256)  # without a time limit there would be 256
        self.assertIn(" 1 samples per pixel", self.ok("render", "slow.json", "--time", "0.001", "--size", "4x4").stderr)
        self.assertIn(" 3 samples per pixel", self.ok("render", "slow.json", "--time", "1h", "--spp", "3").stderr)

    def test_quiet(self):
        lines = self.ok("render", "box.json", "--spp", "1", "-q").stderr.splitlines()
        self.assertEqual([line for line in lines if "warning" not in line], [])

    def test_progress_json(self):
        self.scene("slow.json", "camera a slow 40 warn something")
        lines = self.ok("render", "slow.json", "--spp", "30", "--size", "4x4", "--progress", "json").stderr.splitlines()
        events = [json.loads(line) for line in lines]
        kinds = [event["event"] for event in events]
        for kind in ("progress", "warning", "written", "summary"):
            self.assertIn(kind, kinds)
        # Loading is reported only if it takes longer.
        for event in events:
            if event["event"] == "phase":
                self.assertGreaterEqual(event["elapsed_s"], 0.5)
        progress = [event for event in events if event["event"] == "progress"]
        self.assertEqual(progress[-1]["samples_done"], 30 * 16)
        self.assertEqual(progress[-1]["done"], 1)
        counts = [event["samples_done"] for event in progress]
        self.assertEqual(sorted(set(counts)), counts, "a line is told twice")
        self.assertEqual(events[-1]["samples_per_pixel"], 30)
        self.assertGreater(events[-1]["peak_memory_bytes"], 1e6)
        result = self.run_program("render", "none.json", "--progress", "json")
        self.assertEqual(result.returncode, 1)
        self.assertEqual(json.loads(result.stderr)["event"], "error")

    def test_stats(self):
        text = self.ok("render", "box.json", "--spp", "2", "--size", "4x4", "--stats").stderr
        self.assertIn("camera 20.0 %, bounce 60.0 %, shadow 20.0 % (of these 50.0 % unoccluded)", text)
        self.assertIn("2.00 Mpath vertices, a light sampled at 25.0 %, 80.0 % of the lanes in use", text)
        stages = {line.split()[0]: line.split()[1:] for line in text.splitlines() if line.startswith(("trace", "light", "all"))}
        self.assertEqual(stages, {"trace": ["75.0", "%", "375.0"], "light": ["25.0", "%", "125.0"], "all": ["100.0", "%", "500.0"]})
        self.assertNotIn("ns per vertex", self.ok("render", "box.json", "--spp", "2", "--size", "4x4").stderr)
        lines = self.ok("render", "box.json", "--spp", "2", "--size", "4x4", "--stats", "--progress", "json").stderr.splitlines()
        stats = [event for event in map(json.loads, lines) if event["event"] == "stats"]
        self.assertEqual(len(stats), 1)
        self.assertEqual(stats[0]["rays"], {"camera": 32, "bounce": 96, "shadow": 32})
        self.assertEqual(stats[0]["shadow_rays_clear"], 16)
        self.assertEqual(stats[0]["vertices"], 2000000)
        self.assertEqual(stats[0]["light_samples"], 500000)
        self.assertAlmostEqual(stats[0]["lanes_in_use"], 0.8)
        self.assertEqual(stats[0]["stages"]["trace"], {"thread_s": 0.75, "share": 0.75, "ns_per_vertex": 375})
        self.assertEqual(set(stats[0]["stages"]), {"trace", "light"})

    def test_the_last_line_of_progress_is_told_once(self):
        # There are two passes, each long enough to be reported; the end of the second is the end of the render.
        self.scene("slow.json", "camera a slow 700")
        text = self.ok("render", "slow.json", "--spp", "2", "--size", "4x4", "--progress", "json").stderr
        done = [event["done"] for event in map(json.loads, text.splitlines()) if event["event"] == "progress"]
        self.assertEqual(done, [0.5, 1])

    def test_loading_is_told(self):
        gate = Gate(self)
        self.scene("slow.json", f"camera a load-gate {gate.path}")
        process = self.start("render", "slow.json", "--spp", "1", "--size", "4x4", "--progress", "json")
        times = []
        while len(times) < 2:
            event = json.loads(process.stderr.readline())
            self.assertEqual((event["event"], event["phase"]), ("phase", "load"))
            times.append(event["elapsed_s"])
        self.assertGreaterEqual(times[0], 0.5)
        self.assertGreaterEqual(times[1], times[0] + 0.5)
        gate.allow()
        waiting.finish(process)
        self.assertEqual(process.returncode, 0)

    def in_terminal(self, columns, gate, *arguments):
        """Returns what the program writes to a terminal with this number of columns. The gate opens once loading is
        reported there."""
        ours, its = pty.openpty()
        fcntl.ioctl(its, termios.TIOCSWINSZ, struct.pack("HHHH", 24, columns, 0, 0))
        process = subprocess.Popen([DOUBLE, *arguments], cwd=self.folder, stderr=its)
        os.close(its)
        text = b""
        while True:
            try:
                chunk = os.read(ours, 4096)
            except OSError:  # the other end is closed
                break
            if not chunk:
                break
            text += chunk
            if re.search(rb": \d+\.\d s", text):
                gate.allow()
        os.close(ours)
        waiting.finish(process)
        self.assertEqual(process.returncode, 0)
        return text.decode()

    def test_the_bar_fits_the_terminal(self):
        for columns in (20, 30, 50, 80, 300):
            gate = Gate(self)
            self.scene("slow.json", f"camera a load-gate {gate.path} slow 60")
            text = self.in_terminal(columns, gate, "render", "slow.json", "--spp", "8", "--size", "4x4")
            lines = [line.replace("\x1b[K", "") for line in re.findall(r"\r([^\r\n]+)", text)]
            bars = [line for line in lines if "%" in line]
            self.assertGreater(len(bars), 2, text)
            self.assertTrue(any(line.startswith("reading") or columns < 30 for line in lines), text)
            self.assertLess(max(len(line) for line in lines if "%" in line or "reading" in line), columns)
            self.assertIn("100.0 %", bars[-1])
            if columns >= 80:
                self.assertRegex(bars[-1], r"^\[#+\] .* elapsed, .* left$")

    def start(self, *arguments, **options):
        process = subprocess.Popen([DOUBLE, *arguments], cwd=self.folder, stderr=subprocess.PIPE, text=True, **options)
        self.end_at_the_end(process)
        return process

    def test_interrupt_writes_the_picture_so_far(self):
        for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
            process, gate = self.start_at_gate(3, "--size", "4x4", "--progress", "json", "-o", "a.png")
            process.send_signal(number)
            text = self.read_until(process, "interrupted")
            gate.allow(4)  # finishes the current pass
            text += waiting.finish(process)[1]
            self.assertEqual(process.returncode, 130, text)
            summary = [json.loads(line) for line in text.splitlines() if '"summary"' in line]
            self.assertEqual([event["samples_per_pixel"] for event in summary], [4])
            self.assertEqual(png_size(self.path("a.png"))[:2], (4, 4))
            os.remove(self.path("a.png"))

    def test_under_nohup_the_end_of_the_terminal_means_nothing(self):
        process, gate = self.start_at_gate(2, "--size", "4x4", "--progress", "json",
                                           preexec_fn=lambda: signal.signal(signal.SIGHUP, signal.SIG_IGN))
        process.send_signal(signal.SIGHUP)
        gate.allow()
        waiting.finish(process)
        self.assertEqual(process.returncode, 0)

    def test_second_interrupt_stops(self):
        """The current pass never ends, so the second signal must end the program."""
        process, _ = self.start_at_gate(2, "--size", "4x4", "--progress", "json", "-o", "a.png")
        process.send_signal(signal.SIGINT)
        self.read_until(process, "interrupted")
        process.send_signal(signal.SIGINT)
        waiting.finish(process)
        self.assertEqual(process.returncode, 130)
        self.assertEqual(sorted(os.listdir(self.folder)), ["box.json", "gated.json"])

    def test_an_echo_is_no_second_signal(self):
        """A scheduler signals a job and its processes, and the job's script passes the signal on: within two seconds
        both count as one request."""
        def is_handled(process):
            return not any(waiting.has_signal(process.pid, mask, signal.SIGTERM) for mask in ("ShdPnd", "SigPnd"))

        for _ in range(20):
            process, gate = self.start_at_gate(2, "--size", "4x4", "--progress", "json", "-o", "a.png")
            begin = time.monotonic()
            process.send_signal(signal.SIGTERM)
            self.read_until(process, "interrupted")
            for _ in range(2):
                process.send_signal(signal.SIGTERM)
                waiting.wait_for("the signal to be handled", lambda: is_handled(process), pause_s=0.001)
            took_s = time.monotonic() - begin
            gate.allow(3)
            waiting.finish(process)
            # A slow machine may take so long that the later signals are not echoes; the attempt then proves nothing.
            if took_s < 1:
                self.assertEqual(process.returncode, 130)
                self.assertIn("a.png", os.listdir(self.folder))
                return
        self.skipTest("this machine doesn't handle three signals within a second")

    def test_threads_that_can_t_be_started(self):
        if not PROGRAM or os.geteuid() != 0:
            self.skipTest("needs the program, and root, who can become a user that may have few threads")
        self.scene("sphere.json", '{"fathom": 1, "scene": [{"sphere": {"radius": 1}}]}')
        os.chmod(self.folder, 0o777)

        # The limit counts all processes of a user, so each run of this test has a user of its own.
        user = 20000 + os.getpid() % 40000

        def become_nobody(processes):
            os.setgid(user)
            resource.setrlimit(resource.RLIMIT_NPROC, (processes, processes))
            os.setuid(user)

        probe = self.run_program("version", program=PROGRAM, preexec_fn=lambda: become_nobody(3))
        if probe.returncode != 0:
            self.skipTest("another user can't run the program here")
        render = ["render", "sphere.json", "--spp", "4", "--size", "64x64"]
        self.ok(*render, "-o", "alone.exr", "-o", "alone.png", program=PROGRAM)
        # One of the threads that can be started shows progress, and one writes checkpoints.
        for processes, told in (2, 1), (3, 1), (6, 4):
            for more in [], ["--progress", "json"], ["--checkpoint", "c.exr", "--every", "0.001s"]:
                result = self.run_program(*render, "--threads", "16", "-o", "a.exr", "-o", "a.png", *more, program=PROGRAM,
                                          preexec_fn=lambda: become_nobody(processes + is_thread_sanitized()),
                                          env=WITHOUT_LEAK_CHECK)
                self.assertEqual(result.returncode, 0, result.stderr)
                self.assertIn(f"the system allows only {told} of 16 threads", result.stderr)
                self.assertEqual(self.read("a.png"), self.read("alone.png"))


if __name__ == "__main__":
    run_tests()
