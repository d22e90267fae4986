#!/usr/bin/env python3
"""The command line: what options mean, what is refused, exit codes, what is printed and written.

command_line_test.py DOUBLE [PROGRAM]    DOUBLE is the program with the library of double.cpp behind it
"""
import base64
import fcntl
import json
import os
import pty
import re
import shutil
import resource
import signal
import struct
import subprocess
import sys
import tempfile
import termios
import time
import unittest
from pathlib import Path

DOUBLE = PROGRAM = FAKE_OIDN = None
# The leak check of a sanitized build needs /proc and a thread of its own; where a test takes these away, it can't run.
WITHOUT_LEAK_CHECK = {**os.environ, "ASAN_OPTIONS": "detect_leaks=0"}


def png_size(path):
    with open(path, "rb") as file:
        head = file.read(26)
    assert head[:8] == b"\x89PNG\r\n\x1a\n", head
    return struct.unpack(">II", head[16:24]) + (head[24], head[25])


def pixels_of_hdr(path):
    """The colours of a Radiance picture, as a flat list: rows of run lengths."""
    data = Path(path).read_bytes()
    height, width = map(int, re.search(rb"\n-Y (\d+) \+X (\d+)\n", data).groups())
    at, values = data.index(b"\n", data.index(b"\n-Y ") + 1) + 1, []
    for _ in range(height):
        assert data[at:at + 2] == b"\2\2", "no run lengths"
        at, row = at + 4, b""
        while len(row) < 4 * width:
            count = data[at]
            row += data[at + 1:at + 2] * (count - 128) if count > 128 else data[at + 1:at + 1 + count]
            at += 2 if count > 128 else 1 + count
        for x in range(width):
            values += [row[c * width + x] * 2.0 ** (row[3 * width + x] - 136) for c in range(3)]
    return values


def walking_model():
    """Two triangles, one of which moves and turns, one that bends by a target, a lamp whose light changes, a camera that
    goes back."""
    def floats(*values):
        return struct.pack(f"<{len(values)}f", *values)
    pieces = [floats(0, 0, 0, 1, 0, 0, 0, 1, 0), floats(0, 0, 1, 0, 0, -1, 1, 1, 0), floats(0, .5, 1), floats(0, 1, .3),
              floats(0, 0, 0, 4, 1, 0, 4, 1, -40), floats(0, 0, 0, 1, 0, .6, 0, .8, 0, 1, 0, 0),
              floats(10, 20, 400), floats(.3, .4, 5, .6, .2, 6, 1, .5, 9)]
    kinds = ["VEC3", "VEC3", "SCALAR", "SCALAR", "VEC3", "VEC4", "SCALAR", "VEC3"]
    each = {"VEC3": 12, "VEC4": 16, "SCALAR": 4}
    views, accessors, data = [], [], b""
    for piece, kind in zip(pieces, kinds):
        views.append({"buffer": 0, "byteOffset": len(data), "byteLength": len(piece)})
        accessors.append({"bufferView": len(views) - 1, "componentType": 5126, "count": len(piece) // each[kind], "type": kind})
        data += piece
    intensity = {"path": "pointer", "extensions": {"KHR_animation_pointer": {
        "pointer": "/extensions/KHR_lights_punctual/lights/0/intensity"}}}
    samplers = [{"input": 2, "output": output} for output in (3, 4, 5, 6, 7)]
    return {"asset": {"version": "2.0"}, "scenes": [{"nodes": [0, 1, 2, 3]}],
            "nodes": [{"mesh": 0}, {"mesh": 1}, {"translation": [0, 0, 3], "extensions": {"KHR_lights_punctual": {"light": 0}}}, {"camera": 0}],
            "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]},
                       {"weights": [0], "primitives": [{"attributes": {"POSITION": 0}, "targets": [{"POSITION": 1}]}]}],
            "extensionsUsed": ["KHR_lights_punctual", "KHR_animation_pointer"],
            "extensions": {"KHR_lights_punctual": {"lights": [{"type": "point", "intensity": 20}]}},
            "animations": [{"samplers": samplers, "channels": [
                {"sampler": 0, "target": {"node": 1, "path": "weights"}},
                {"sampler": 1, "target": {"node": 0, "path": "translation"}},
                {"sampler": 2, "target": {"node": 0, "path": "rotation"}},
                {"sampler": 3, "target": intensity},
                {"sampler": 4, "target": {"node": 3, "path": "translation"}}]}],
            "cameras": [{"type": "perspective", "perspective": {"yfov": 0.8, "znear": 0.1}}],
            "accessors": accessors, "bufferViews": views,
            "buffers": [{"byteLength": len(data),
                         "uri": "data:application/octet-stream;base64," + base64.b64encode(data).decode()}]}


class CommandLine(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = folder.name
        self.scene("box.json", "camera main camera side")

    def scene(self, name, text):
        with open(os.path.join(self.folder, name), "w") as file:
            file.write(text)

    def path(self, name):
        return os.path.join(self.folder, name)

    def run_program(self, *arguments, program=None, **options):
        return subprocess.run([program or DOUBLE, *arguments], cwd=self.folder, capture_output=True, text=True,
                              timeout=60, **options)

    def ok(self, *arguments, **options):
        result = self.run_program(*arguments, **options)
        self.assertEqual(result.returncode, 0, result.stderr)
        return result

    def refused(self, code, *arguments, words=(), **options):
        before = sorted(os.listdir(self.folder))
        result = self.run_program(*arguments, **options)
        self.assertEqual(result.returncode, code, f"{arguments}: {result.stderr}")
        lines = [line for line in result.stderr.splitlines() if not line.startswith("fathom: warning: ")]
        self.assertEqual(len(lines), 1, f"{arguments}: {result.stderr}")
        self.assertTrue(lines[0].startswith("fathom: "), lines[0])
        for word in words:
            self.assertIn(word, lines[0])
        self.assertEqual(sorted(os.listdir(self.folder)), before, "a file was left")
        return result

    # ------------------------------------------------------------------------------------------------ usage

    def test_help_and_version(self):
        for command in ("render", "merge", "info", "view", "version"):
            text = self.ok(*command.split(), "--help").stdout
            self.assertIn("Example", text)
            self.assertIn("Exit codes", text)
        self.assertIn("130", self.ok("--help").stdout)
        self.assertEqual(self.ok("--version").stdout, self.ok("version").stdout.splitlines()[0] + "\n")
        text = self.ok("version").stdout
        for word in ("fathom", "SIMD", "OpenEXR", "libpng"):
            self.assertIn(word, text)

    def test_wrong_usage(self):
        self.refused(2)
        self.refused(2, "rendre")
        self.refused(2, "render")
        self.refused(2, "render", "box.json", "--bogus", words=["--bogus"])
        self.refused(2, "render", "box.json", "other.json")
        self.refused(2, "render", "box.json", "--spp", "4", "--spp=5", words=["--spp is given more than once"])
        self.refused(2, "merge", "a.exr", words=["-o"])

    def test_nonsense_values(self):
        wrong = {
            "--spp": ["0", "-1", "1.5", "nan", "x", "", "99999999999999999999"],
            "--time": ["0", "-5s", "nan", "inf", "h", "5d", ""],
            "--size": ["0x600", "800x0", "800", "-1x5", "axb", "800x600x3", "99999999x1", "nanxnan"],
            "--threads": ["0", "-1", "x"],
            "--seed": ["-1", "4294967296", "x"],
            "--crop": ["0,0,0,0", "1,2,3", "5,5,4,9", "0,0,801,600", "-1,0,5,5"],
            "--filter": ["sinc"],
            "--max-depth": ["-1", "x"],
            "--roulette-depth": ["-1"],
            "--light-sampling": ["maybe"],
            "--samples": ["5:5", "9:3", "5", "a:b", "-1:4"],
            "--only-sample": ["1,2", "800,0,0", "0,600,0", "-1,0,0", "0,0,4294967296"],
            "--aov": ["colour", ""],
            "--exposure": ["nan", "inf", "1000", "x"],
            "--tonemap": ["reinhard"],
            "--quality": ["0", "101", "x"],
            "--background": ["blue", "#12345", "#gggggg", "1,2", "-1,0,0", "nan,0,0"],
            "--look-from": ["1,2", "nan,0,0", "1,2,3,4"],
            "--up": ["0,0,0"],
            "--fov": ["0", "180", "-5", "nan"],
            "--orbit": ["1", "0,91", "inf,0"],
            "--up-axis": ["x"],
            "--png-bits": ["12"],
            "--exr": ["double"],
            "--progress": ["xml"],
        }
        for option, values in wrong.items():
            for value in values:
                with self.subTest(option=option, value=value):
                    self.refused(2, "render", "box.json", f"{option}={value}", words=[option] if value else [])

    def test_options_that_disagree(self):
        self.refused(2, "render", "box.json", "--samples", "0:4", "--spp", "4", words=["--samples"])
        self.refused(2, "render", "box.json", "--samples", "0:4", "--time", "4", words=["--samples"])
        self.refused(2, "render", "box.json", "--aov", "depth", "-o", "a.png", words=["EXR"])
        self.refused(2, "render", "box.json", "--mergeable", words=["EXR"])
        self.refused(2, "render", "box.json", "--only-sample", "1,2,3", "-o", "a.png")
        self.refused(2, "render", "box.json", "--orbit", "1,2", "--look-from", "1,2,3")
        self.refused(2, "render", "box.json", "--look-from", "1,2,3", "--look-at", "1,2,3")

    # ------------------------------------------------------------------------------------------------ bad files

    def test_bad_input(self):
        self.refused(1, "render", "none.json", words=["none.json", "no such file"])
        self.refused(1, "render", ".", words=["."])
        self.scene("wrong.json", "nonsense")
        self.refused(1, "render", "wrong.json", words=["wrong.json: line 1: "])
        self.refused(1, "info", "none.json", words=["none.json"])
        self.refused(1, "merge", "none.exr", "-o", "a.exr", words=["none.exr"])
        self.refused(1, "render", "box.json", "--camera", "top", words=["'top'", "'main', 'side'"])
        self.refused(1, "render", "box.json", "--env", "none.hdr", words=["none.hdr: --env"])
        self.scene("filter.json", "camera a hint-filter sinc")
        self.refused(1, "render", "filter.json", words=["filter.json: filter: "])
        for text in ("camera a size 0 5", "camera a spp 0"):
            self.scene("zero.json", text)
            self.refused(1, "render", "zero.json", words=["zero.json"])

    def test_bad_output(self):
        self.refused(1, "render", "box.json", "-o", "a.bmp", words=["a.bmp", ".bmp", ".exr"])
        self.refused(1, "render", "box.json", "-o", "a", words=["a: "])
        self.refused(1, "render", "box.json", "-o", "none/a.png", words=["none/a.png", "folder"])
        self.refused(1, "render", "box.json", "-o", "/proc/a.png", words=["/proc/a.png"])
        os.mkdir(self.path("folder.png"))
        self.refused(1, "render", "box.json", "-o", "folder.png", words=["folder.png"])
        self.refused(1, "render", "box.json", "--size", "70000x10", "-o", "a.jpg", words=["a.jpg", "70000x10"])

    def test_no_input_is_overwritten(self):
        self.scene("box.png", "a texture")
        self.scene("box.bin", "vertices")
        self.scene("sky.exr", "a sky")
        self.scene("box.json", "camera main texture box.png file box.bin")
        os.link(self.path("box.png"), self.path("hard.png"))
        os.symlink("box.png", self.path("link.png"))
        os.symlink("box.json", self.path("scene.png"))
        os.symlink("box.bin", self.path("bin.exr"))
        os.mkdir(self.path("sub"))
        for name, what in (("box.png", "a texture of this scene"), ("./sub/../box.png", "a texture of this scene"),
                           ("hard.png", "a texture of this scene"), ("link.png", "a texture of this scene"),
                           ("scene.png", "the scene itself"), ("bin.exr", "a file of this scene"),
                           ("sky.exr", "a texture of this scene")):
            self.refused(1, "render", "box.json", "--env", "sky.exr", "-q", "-o", "new.png", "-o", name,
                         words=[f"fathom: {name} is {what}: name another with -o"])
        # The name that is taken where none is given, and only that of what is really read.
        self.refused(1, "render", "box.json", "-q", words=["box.png is a texture of this scene"])
        self.ok("render", "box.json", "-q", "--spp", "1", "-o", "sky.exr")

    def test_a_file_that_fails_leaves_the_others(self):
        def limit():
            resource.setrlimit(resource.RLIMIT_FSIZE, (500000, 500000))

        result = self.run_program("render", "box.json", "--spp", "1", "-q", "--size", "500x500", "-o", "a.exr",
                                  "-o", "a.png", preexec_fn=limit)
        self.assertEqual(result.returncode, 1)
        self.assertRegex(result.stderr, r"fathom: a.exr: can't write: .*\n$")
        self.assertEqual(png_size(self.path("a.png"))[:2], (500, 500))
        self.assertFalse(os.path.exists(self.path("a.exr")))
        self.ok("render", "box.json", "--samples", "0:1", "-q", "--size", "200x200", "-o", "p.exr")
        self.ok("merge", "p.exr", "-q", "-o", "m.exr", "-o", "m.png")
        most = (os.path.getsize(self.path("m.exr")) + os.path.getsize(self.path("m.png"))) // 2
        os.remove(self.path("m.png"))
        result = self.run_program("merge", "p.exr", "-q", "-o", "m.exr", "-o", "m.png",
                                  preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (most, most)))
        self.assertEqual(result.returncode, 1)
        self.assertEqual(png_size(self.path("m.png"))[:2], (200, 200))

    def test_the_picture_is_kept_when_nobody_listens(self):
        for close in (lambda: os.close(2), lambda: os.dup2(os.open("/dev/full", os.O_WRONLY), 2)):
            process = subprocess.run([DOUBLE, "render", "box.json", "--spp", "1", "-o", "a.png"], cwd=self.folder,
                                     stdout=subprocess.PIPE, preexec_fn=close, timeout=60)
            self.assertEqual(process.returncode, 1)
            self.assertEqual(png_size(self.path("a.png"))[:2], (800, 600))
            os.remove(self.path("a.png"))
        # A reader that goes away, as `| head -1` does, while progress is told.
        self.scene("slow.json", "camera a slow 30")
        process = subprocess.Popen([DOUBLE, "render", "slow.json", "--spp", "50", "--progress", "json", "-o", "a.png"],
                                   cwd=self.folder, stderr=subprocess.PIPE)
        process.stderr.readline()
        process.stderr.close()
        self.assertEqual(process.wait(timeout=60), 1)
        self.assertEqual(png_size(self.path("a.png"))[:2], (800, 600))
        # Where there is nothing to be said nothing is lost.
        process = subprocess.run([DOUBLE, "version"], stdout=subprocess.PIPE, preexec_fn=lambda: os.close(2), timeout=60)
        self.assertEqual(process.returncode, 0)

    def test_output_that_can_t_be_printed(self):
        for arguments in (["version"], ["--version"], ["--help"], ["info", "box.json"], ["info", "box.json", "--json"],
                          ["render", "box.json", "-q", "--only-sample", "1,2,3"]):
            with open("/dev/full", "w") as full:
                result = subprocess.run([DOUBLE, *arguments], cwd=self.folder, stdout=full, stderr=subprocess.PIPE,
                                        text=True, timeout=60)
            self.assertEqual(result.returncode, 1, arguments)
            lines = [line for line in result.stderr.splitlines() if "warning" not in line]
            self.assertEqual(len(lines), 1, result.stderr)
            self.assertIn("standard output: can't write: ", lines[0])

    def test_without_proc(self):
        script = 'mount -t tmpfs none /proc && exec "$@"'
        rights = [] if os.geteuid() == 0 else ["--user", "--map-root-user"]
        command = ["unshare", *rights, "--mount", "sh", "-c", script, "sh"]
        if not shutil.which("unshare") or subprocess.run([*command, "true"], capture_output=True).returncode != 0:
            self.skipTest("nothing can be mounted here")
        result = subprocess.run([*command, DOUBLE, "render", "box.json", "--spp", "1", "-o", "a.exr", "-o", "a.png"],
                                cwd=self.folder, capture_output=True, text=True, timeout=60, env=WITHOUT_LEAK_CHECK)
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertEqual(sorted(os.listdir(self.folder)), ["a.exr", "a.png", "box.json"])

    def test_too_large_is_refused_before_it_is_tried(self):
        start = time.monotonic()
        self.refused(1, "render", "box.json", "--size", "16000000x16000000", "-o", "a.exr", words=["GB"])
        self.assertLess(time.monotonic() - start, 5)

    def test_full_disk_leaves_the_earlier_file(self):
        def limit():
            resource.setrlimit(resource.RLIMIT_FSIZE, (2000, 2000))

        for name in ("a.exr", "a.png"):
            self.ok("render", "box.json", "--spp", "1", "--size", "4x4", "-q", "-o", name)
            with open(self.path(name), "rb") as file:
                before = file.read()
            size = "2000x2000"
            self.refused(1, "render", "box.json", "--spp", "1", "-q", "--size", size, "-o", name,
                         words=[name, "can't write"], preexec_fn=limit)
            with open(self.path(name), "rb") as file:
                self.assertEqual(file.read(), before)

    # ------------------------------------------------------------------------------------------------ what options mean

    def test_defaults(self):
        result = self.ok("render", "box.json")
        self.assertEqual(png_size(self.path("box.png")), (800, 600, 8, 2))
        self.assertIn("256 samples", result.stderr)
        self.assertIn("wrote box.png", result.stderr)
        self.assertRegex(result.stderr, r"load [\d.]+ s, build [\d.]+ s, render [\d.]+ s.*256 samples.*rays.*peak memory")
        self.assertEqual(result.stdout, "")
        self.scene("few.json", "camera a spp 3")
        text = self.ok("render", "few.json").stderr
        self.assertNotIn("256", text)
        self.assertIn("3 samples a pixel", text)
        self.assertIn("5 samples a pixel", self.ok("render", "few.json", "--spp", "5").stderr)

    def test_size(self):
        for text, arguments, size in (("camera a aspect 2", [], (800, 400)),
                                      ("camera a aspect 1", [], (600, 600)),
                                      ("camera a aspect 2", ["--size", "50x50"], (50, 50)),
                                      ("camera a size 64 32", [], (64, 32)),
                                      ("camera a size 64 32", ["--size", "8x9"], (8, 9)),
                                      ("camera a aspect 2 camera b aspect 1", ["--camera", "b"], (600, 600)),
                                      ("camera a aspect 2", ["--orbit", "0,0"], (800, 600))):
            self.scene("s.json", text)
            self.ok("render", "s.json", "--spp", "1", *arguments)
            self.assertEqual(png_size(self.path("s.png"))[:2], size, (text, arguments))

    def test_pictures(self):
        self.ok("render", "box.json", "--spp", "1", "--size", "20x10", "--background", "transparent", "--png-bits", "16",
                "-o", "a.png", "-o", "a.exr", "-o", "a.jpg", "-o", "a.webp", "--output", "a.hdr")
        self.assertEqual(png_size(self.path("a.png")), (20, 10, 16, 6))
        for name in ("a.exr", "a.jpg", "a.webp", "a.hdr"):
            self.assertTrue(os.path.exists(self.path(name)), name)
        self.ok("render", "box.json", "--spp", "1", "--size", "20x10", "-o", "b.exr", "--exr", "half",
                "--aov", "albedo,samples,variance")
        with open(self.path("b.exr"), "rb") as file:
            data = file.read()
        for word in (b"variance.R", b"samples.Y", b"fathom.seed", b"fathom.render_s"):
            self.assertIn(word, data)

    def camera_line(self, *arguments):
        return re.search(r"camera '.*", self.ok("render", "box.json", "--spp", "1", *arguments).stderr).group()

    def test_camera(self):
        self.assertIn("'main' at 1,2,3 to 1,2,2 up 0,1,0 fov 40", self.camera_line())
        self.assertIn("'side' at 1,2,3", self.camera_line("--camera", "side"))
        self.assertIn("at -5,6,7 to 1,2,2 up 0,1,0", self.camera_line("--look-from", "-5,6,7"))
        self.assertIn("at 1,2,3 to 0,0,0", self.camera_line("--look-at", "0,0,0"))
        self.assertIn("up 0,0,1 fov 60", self.camera_line("--up", "0,0,1", "--look-at", "9,9,9", "--fov", "60"))
        self.assertIn("up 0,0,-1", self.camera_line("--look-from", "0,5,0", "--look-at", "0,0,0"))
        self.assertIn("at 45,-20,100", self.camera_line("--orbit", "45,-20"))
        for name, place in (("front", "0,0"), ("back", "180,0"), ("left", "-90,0"), ("right", "90,0"), ("top", "0,90"),
                            ("bottom", "0,-90"), ("three-quarter", "30,20")):
            self.assertIn(f"at {place},100", self.camera_line("--view", name))
        self.refused(2, "render", "box.json", "--view", "side", words=["side", "three-quarter"])
        self.refused(2, "render", "box.json", "--view", "top", "--camera", "main", words=["--view"])
        self.scene("bare.json", "empty")
        text = self.ok("render", "bare.json", "--spp", "1").stderr
        self.assertIn("camera framing the model", text)
        self.assertIn("at 30,20,100", text)

    def test_environment_and_warnings(self):
        self.scene("sky.hdr", "x")
        self.scene("w.json", "camera a warn something nan")
        text = self.ok("render", "w.json", "--spp", "1", "--env", "sky.hdr", "--up-axis", "z", "-q").stderr
        self.assertIn("environment sky.hdr", text)
        self.assertIn("up axis z", text)
        self.assertIn("fathom: warning: something (2 times)\n", text)
        self.assertIn("3 samples were no number", text)
        self.assertIn("(--only-sample 7,8,9 replays one)", text)

    def test_light(self):
        self.scene("sky.hdr", "x")
        self.scene("dark.json", "camera a")
        text = self.ok("render", "dark.json", "--spp", "1", "--size", "200x100").stderr
        self.assertIn("light auto aspect 2", text)
        self.assertIn("light: added a lamp, an exposure", text)
        self.assertIn("light file", self.ok("render", "dark.json", "--spp", "1", "--light", "file").stderr)
        self.assertIn("light studio", self.ok("render", "dark.json", "--spp", "1", "--light", "studio").stderr)
        # A sky that is given is all the light.
        text = self.ok("render", "dark.json", "--spp", "1", "--env", "sky.hdr").stderr
        self.assertIn("light auto, its own", text)
        self.refused(2, "render", "dark.json", "--env", "sky.hdr", "--light", "studio", words=["one of both"])
        self.refused(2, "render", "dark.json", "--light", "moon", words=["moon"])

    def test_environment_turned_and_dimmed(self):
        self.scene("sky.hdr", "x")
        self.scene("plain.json", "camera a")
        seen = lambda *options: self.ok("render", "plain.json", "--spp", "1", "--env", "sky.hdr", *options).stderr
        self.assertIn("sky.hdr towards 1.000,0.000,0.000 times 1\n", seen())
        # Counter-clockwise seen from above: from +x (the right) to -z (ahead).
        self.assertIn("sky.hdr towards 0.866,0.000,-0.500 times 0.25\n", seen("--env-rotate", "30", "--env-strength", "0.25"))
        for option in ("--env-rotate", "--env-strength"):
            self.refused(2, "render", "plain.json", option, "2", words=["no environment", "--env FILE"])
        self.refused(2, "render", "plain.json", "--env", "sky.hdr", "--env-strength", "-1", words=["--env-strength"])

    def test_sun_and_sky(self):
        self.scene("sky.hdr", "x")
        seen = lambda *options: self.ok("render", "box.json", "--spp", "1", *options).stderr
        self.assertIn("sky and sun at 0.000,0.500,0.866\n", seen("--light", "sun", "--sun-elevation", "30", "--sun-azimuth", "0"))
        self.assertIn("sky without sun at 1.000,0.000,0.000\n",
                      seen("--light", "sky", "--sun-elevation", "0", "--sun-azimuth", "90"))
        self.assertIn("sky and sun at 1.000,2.000,3.000\n", seen("--light", "sun", "--sun-direction", "1,2,3"))
        self.assertIn("light file", seen("--light", "sun"))
        self.refused(2, "render", "box.json", "--light", "sun", "--env", "sky.hdr", words=["one of them"])
        self.refused(2, "render", "box.json", "--sun-elevation", "9", words=["--light sun"])
        self.refused(2, "render", "box.json", "--light", "sun", "--sun-direction", "0,0,0", words=["direction"])
        self.refused(2, "render", "box.json", "--light", "sun", "--sun-direction", "1,1,0", "--sun-azimuth", "3",
                     words=["leave out"])

    def test_denoise(self):
        if not FAKE_OIDN:
            self.skipTest("no library to denoise with")
        there = {**os.environ, "FATHOM_OIDN": FAKE_OIDN}
        render = ["render", "box.json", "--spp", "2", "--size", "20x10", "--denoise"]
        channels = lambda name: set(re.findall(rb"(?:denoised|albedo|normal)\.[A-Z]", Path(self.path(name)).read_bytes()))
        text = self.ok(*render, "-o", "a.exr", "-o", "a.png", "--mergeable", env=there).stderr
        self.assertIn("denoising by Open Image Denoise 2.98.76 (" + FAKE_OIDN + ")\n", text)
        self.assertEqual(channels("a.exr"), {b"denoised.R", b"denoised.G", b"denoised.B"})
        # The picture itself stays as it was, and a PNG shows the other.
        self.ok(*render[:-1], "-o", "raw.png")
        self.ok("merge", "a.exr", "-o", "merged.png")
        self.ok("merge", "a.exr", "--denoise", "-o", "denoised.png", "-o", "m.exr", env=there)
        data = {name: Path(self.path(name)).read_bytes() for name in ("a.png", "raw.png", "merged.png", "denoised.png")}
        self.assertEqual(data["raw.png"], data["merged.png"])
        self.assertEqual(data["a.png"], data["denoised.png"])
        self.assertIn(b"denoised.R", channels("m.exr"))
        # What helps the denoiser is left out again unless it is asked for; the stand-in for the library has no layers.
        if PROGRAM:
            self.scene("ball.json", '{"fathom": 1, "camera": {"position": [0, 0, 4], "look_at": [0, 0, 0]}, '
                                    '"environment": {"kind": "constant"}, "scene": [{"sphere": {"radius": 1}}]}')
            ball = ["render", "ball.json", "--spp", "2", "--size", "20x10", "--denoise", "-q", "-o", "b.exr"]
            self.ok(*ball, program=PROGRAM, env=there)
            self.assertEqual(channels("b.exr"), {b"denoised.R", b"denoised.G", b"denoised.B"})
            self.ok(*ball, "-o", "c.png", program=PROGRAM, env=there)
            self.ok(*[word for word in ball if word != "--denoise"], "-o", "d.png", program=PROGRAM)
            self.assertNotEqual(*(Path(self.path(name)).read_bytes() for name in ("c.png", "d.png")))
            self.ok(*ball, "--aov", "normal", program=PROGRAM, env=there)
            self.assertEqual({name[:8] for name in channels("b.exr")}, {b"denoised", b"normal.X", b"normal.Y", b"normal.Z"})
        # Asked for and not there: told before anything is rendered.
        self.refused(1, *render, "-o", "new.png", words=["/none.so: FATHOM_OIDN"], env={**there, "FATHOM_OIDN": "/none.so"})
        self.assertFalse(os.path.exists(self.path("new.png")))
        away = {"PATH": self.folder, "HOME": self.folder}
        result = self.run_program(*render, "-o", "new.png", env=away)
        if result.returncode:  # else the system has one
            self.assertEqual(result.stderr.count("\n"), 1)
            self.assertIn("pip install pyoidn", result.stderr)

    def test_only_sample(self):
        result = self.ok("render", "box.json", "--only-sample", "12,34,56")
        self.assertEqual(result.stdout, "pixel 12,34 sample 56: 12 34 56\n")
        self.assertFalse(os.path.exists(self.path("box.png")))

    # ------------------------------------------------------------------------------------------------ parts

    def merge_key(self, *arguments):
        return ["render", "box.json", "--size", "9x7", "-q", *arguments]

    def test_merge_makes_the_picture_of_one_run(self):
        self.ok(*self.merge_key("--spp", "16", "-o", "whole.exr", "-o", "whole.png", "--exposure", "-1"))
        self.ok(*self.merge_key("--samples", "4:16", "-o", "b.exr"))
        self.ok(*self.merge_key("--samples", "0:4", "-o", "a.exr"))
        result = self.ok("merge", "b.exr", "a.exr", "-o", "all.exr", "-o", "all.png", "--exposure", "-1")
        self.assertIn("16 samples a pixel: 0:16", result.stderr)
        with open(self.path("whole.png"), "rb") as one, open(self.path("all.png"), "rb") as other:
            self.assertEqual(one.read(), other.read())
        # What is merged can be merged again.
        self.ok(*self.merge_key("--samples", "16:20", "-o", "c.exr"))
        self.assertIn(": 0:20", self.ok("merge", "all.exr", "c.exr", "-o", "more.exr", "--no-sums").stderr)
        self.refused(1, "merge", "more.exr", "-o", "x.png", words=["more.exr", "--mergeable"])
        self.refused(1, "merge", "all.exr", "a.exr", "-o", "x.png", words=["a.exr", "overlap"])
        self.refused(1, "merge", "whole.exr", "-o", "x.png", words=["whole.exr", "--mergeable"])
        self.ok(*self.merge_key("--samples", "30:31", "-o", "d.exr", "--seed", "1"))
        self.refused(1, "merge", "a.exr", "d.exr", "-o", "x.png", words=["d.exr: ", "seed is 1, not 0"])
        with open(self.path("a.exr"), "rb") as file:
            data = file.read()
        with open(self.path("cut.exr"), "wb") as file:
            file.write(data[:-10])
        self.refused(1, "merge", "cut.exr", "-o", "x.png", words=["cut.exr"])

    # ------------------------------------------------------------------------------------------------ time, progress, signals

    def test_merge_overwrites_no_part(self):
        for name, range_ in ("a.exr", "0:2"), ("b.exr", "2:4"):
            self.ok("render", "box.json", "--size", "8x4", "--samples", range_, "-o", name)
        os.link(self.path("b.exr"), self.path("hard.exr"))
        os.symlink("a.exr", self.path("soft.exr"))
        os.mkdir(self.path("sub"))
        before = [Path(self.path(name)).read_bytes() for name in ("a.exr", "b.exr")]
        for output in "a.exr", "b.exr", "hard.exr", "soft.exr", "sub/../b.exr":
            self.refused(1, "merge", "a.exr", "b.exr", "-o", "all.png", "-o", output,
                         words=[f"{output} is a part of this picture: name another with -o"])
        self.assertEqual(before, [Path(self.path(name)).read_bytes() for name in ("a.exr", "b.exr")])
        self.ok("merge", "a.exr", "b.exr", "-o", "all.exr")

    def test_time(self):
        self.scene("slow.json", "camera a slow 20")
        text = self.ok("render", "slow.json", "--time", "0.8s", "--size", "4x4").stderr
        samples = int(re.search(r"(\d+) samples a pixel", text).group(1))
        self.assertGreater(samples, 0)
        self.assertLess(samples, 256)  # those that there would be without a limit of time
        self.assertIn(" 1 samples a pixel", self.ok("render", "slow.json", "--time", "0.001", "--size", "4x4").stderr)
        self.assertIn(" 3 samples a pixel", self.ok("render", "slow.json", "--time", "1h", "--spp", "3").stderr)

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
        self.assertNotIn("phase", kinds)
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

    def test_the_last_line_of_progress_is_told_once(self):
        # Two passes, each long enough to be told of: the end of the second is the end of all.
        self.scene("slow.json", "camera a slow 700")
        text = self.ok("render", "slow.json", "--spp", "2", "--size", "4x4", "--progress", "json").stderr
        done = [event["done"] for event in map(json.loads, text.splitlines()) if event["event"] == "progress"]
        self.assertEqual(done, [0.5, 1])

    def test_loading_is_told(self):
        self.scene("slow.json", "camera a slow-load 1300")
        text = self.ok("render", "slow.json", "--spp", "1", "--size", "4x4", "--progress", "json").stderr
        phases = [event for event in map(json.loads, text.splitlines()) if event["event"] == "phase"]
        self.assertEqual({phase["phase"] for phase in phases}, {"load"})
        self.assertGreater(phases[-1]["elapsed_s"], 0.9)

    def in_terminal(self, columns, *arguments):
        """What the program writes to a terminal so wide."""
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
        os.close(ours)
        self.assertEqual(process.wait(timeout=60), 0)
        return text.decode()

    def test_the_bar_fits_the_terminal(self):
        self.scene("slow.json", "camera a slow-load 700 slow 60")
        for columns in (20, 30, 50, 80, 300):
            text = self.in_terminal(columns, "render", "slow.json", "--spp", "8", "--size", "4x4")
            lines = [line.replace("\x1b[K", "") for line in re.findall(r"\r([^\r\n]+)", text)]
            bars = [line for line in lines if "%" in line]
            self.assertGreater(len(bars), 2, text)
            self.assertTrue(any(line.startswith("reading") or columns < 30 for line in lines), text)
            self.assertLess(max(len(line) for line in lines if "%" in line or "reading" in line), columns)
            self.assertIn("100.0 %", bars[-1])
            if columns >= 80:
                self.assertRegex(bars[-1], r"^\[#+\] .* elapsed, .* left$")

    def test_samples_that_can_t_be_merged(self):
        self.assertIn("add -o FILE.exr", self.ok("render", "box.json", "--samples", "0:2", "-o", "a.png").stderr)
        self.assertNotIn("merged", self.ok("render", "box.json", "--samples", "0:2", "-o", "a.exr").stderr)

    def start_slow(self, pass_ms, *arguments):
        self.scene("slow.json", f"camera a slow {pass_ms}")
        process = subprocess.Popen([DOUBLE, "render", "slow.json", "--spp", "1000", "--size", "4x4", *arguments],
                                   cwd=self.folder, stderr=subprocess.PIPE, text=True)
        for line in process.stderr:
            if "progress" in line:
                return process
        self.fail("no progress")

    def test_interrupt_writes_the_picture_so_far(self):
        for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
            process = self.start_slow(100, "--progress", "json", "-o", "a.png")
            process.send_signal(number)
            text = process.communicate(timeout=20)[1]
            self.assertEqual(process.returncode, 130, text)
            self.assertIn("interrupted", text)
            self.assertEqual(png_size(self.path("a.png"))[:2], (4, 4))
            os.remove(self.path("a.png"))

    def test_under_nohup_the_end_of_the_terminal_means_nothing(self):
        self.scene("slow.json", "camera a slow 40")
        process = subprocess.Popen([DOUBLE, "render", "slow.json", "--spp", "40", "--size", "4x4", "--progress", "json"],
                                   cwd=self.folder, stderr=subprocess.PIPE, text=True,
                                   preexec_fn=lambda: signal.signal(signal.SIGHUP, signal.SIG_IGN))
        process.stderr.readline()
        process.send_signal(signal.SIGHUP)
        process.communicate(timeout=20)
        self.assertEqual(process.returncode, 0)

    def test_second_interrupt_stops(self):
        # The pass under way must still be so when the second signal comes, on a busy machine too.
        # The first one must come within a pass: right after the progress line the program looks whether it is to stop.
        process = self.start_slow(2000, "--progress", "json", "-o", "a.png")
        time.sleep(0.3)
        process.send_signal(signal.SIGINT)
        time.sleep(0.02)
        process.send_signal(signal.SIGINT)
        process.communicate(timeout=20)
        self.assertEqual(process.returncode, 130)
        self.assertEqual(sorted(os.listdir(self.folder)), ["box.json", "slow.json"])

    # ------------------------------------------------------------------------------------------------ info, view

    def test_info(self):
        text = self.ok("info", "box.json").stdout
        for word in ("main (perspective)", "side", "bounds", "environment", "memory"):
            self.assertIn(word, text)
        info = json.loads(self.ok("info", "box.json", "--json").stdout)
        self.assertEqual(info["counts"]["cameras"], 2)
        self.assertEqual(info["cameras"][0]["name"], "main")
        self.assertEqual((info["scenes"], info["variants"]), ([], []))

    def test_choices(self):
        """What a file has several of: listed by info, chosen by name or number."""
        self.scene("box.json", "camera main camera side camera side scene one scene two variant dawn variant dusk")
        text = self.ok("info", "box.json").stdout
        self.assertIn("0: main (perspective), 1: side (perspective), 2: side (perspective)", text)
        self.assertRegex(text, r"scenes +one, two\n")
        self.assertRegex(text, r"variants +dawn, dusk\n")
        info = json.loads(self.ok("info", "box.json", "--json").stdout)
        self.assertEqual((info["scenes"], info["variants"]), (["one", "two"], ["dawn", "dusk"]))
        for chosen, name in (("0", "main"), ("1", "side"), ("main", "main"), ("side", "side")):
            words = self.ok("render", "box.json", "--spp", "1", "--camera", chosen).stderr
            self.assertIn(f"camera '{name}", words)
        # The second of a name, too.
        self.scene("same.json", "camera main camera side aspect 2 camera side aspect 4")
        words = self.ok("render", "same.json", "--spp", "1", "--camera", "2").stderr
        self.assertIn("aspect 4", words)
        self.scene("nameless.json", "camera 2 aspect 2 camera 1 aspect 4")
        words = self.ok("render", "nameless.json", "--spp", "1", "--camera", "1").stderr
        self.assertIn("camera '1'", words)
        self.refused(1, "render", "same.json", "--camera", "3", words=["there is no camera '3'", "'main'"])
        self.refused(1, "render", "same.json", "--camera", "99999999999999999999", words=["there is no camera"])
        words = self.ok("render", "box.json", "--spp", "1", "--variant", "dusk", "--scene", "two").stderr
        self.assertIn("variant dusk", words)
        self.assertIn("scene two", words)

    def test_poses_and_frames(self):
        self.scene("walk.json", "camera main moves stride")
        result = self.ok("render", "walk.json", "--spp", "1")
        self.assertIn("the pose at rest is shown; of the file's 1 animation (stride) --at", result.stderr)
        self.assertIn("camera 'main' at 1,2,3", result.stderr)
        self.assertRegex(self.ok("info", "walk.json").stdout, r"animations +0: stride \(2 s;")
        info = json.loads(self.ok("info", "walk.json", "--json").stdout)
        self.assertEqual(info["animations"], [{"name": "stride", "duration_s": 2.0, "channels": 1}])
        # The camera goes a metre a second, and stops at the end.
        for time_s, x in (("0", "0"), ("1.5", "1.5"), ("1.5s", "1.5"), ("7", "2")):
            words = self.ok("render", "walk.json", "--spp", "1", "--at", time_s).stderr
            self.assertIn(f"camera 'main' at {x},0,0", words)
            self.assertNotIn("at rest", words)
        self.assertIn("at 0.5,0,0", self.ok("render", "walk.json", "--spp", "1", "--frames", "12").stderr)
        before = set(os.listdir(self.folder))
        words = self.ok("render", "walk.json", "--spp", "1", "--frames", "8:12:2", "--fps", "8", "-o", "a.###.png", "-o",
                        "b#.png").stderr
        self.assertEqual(set(os.listdir(self.folder)) - before,
                         {"a.008.png", "a.010.png", "a.012.png", "b8.png", "b10.png", "b12.png"})
        for x in ("1", "1.25", "1.5"):
            self.assertEqual(words.count(f"camera 'main' at {x},0,0"), 1, words)
        # What the options make of a camera goes with it.
        words = self.ok("render", "walk.json", "--spp", "1", "--frames", "0:1", "--fps", "2", "--fov", "30", "-o",
                        "c.#.png").stderr
        for x in ("0", "0.5"):
            self.assertIn(f"camera 'command line' at {x},0,0", words)
        self.ok("render", "walk.json", "--spp", "1", "--frames", "0:1")
        self.assertTrue(os.path.exists(self.path("walk.0001.png")))

    def test_wrong_poses_and_frames(self):
        self.scene("walk.json", "camera main moves stride")
        def wrong(*arguments, words):
            self.refused(2, "render", "walk.json", "--spp", "1", *arguments, words=words)
        wrong("--frames", "0:3", "-o", "a.png", words=["a.png", "####"])
        wrong("--frames", "3:0", words=["--frames", "no frames"])
        wrong("--frames", "0:1:0", words=["--frames"])
        wrong("--frames", "0:1:1:1", words=["--frames", "A:B:STEP"])
        wrong("--frames", "0:99999999", words=["--frames", "1000000"])
        wrong("--frames", "0:1", "--at", "1", words=["--at", "--frames"])
        wrong("--frames", "0:1", "--time", "1s", words=["--frames", "--time"])
        wrong("--frames", "0:1", "--only-sample", "0,0,0", words=["--only-sample"])
        wrong("--frames", "0:1", "--fps", "0", words=["--fps"])
        wrong("--at", "-1", words=["--at"])
        wrong("--shutter", "0.5", words=["--shutter", "--at"])
        wrong("--animation", "stride", words=["--animation", "--at"])
        self.refused(1, "render", "walk.json", "--at", "1", "--animation", "strid", words=["there is no animation 'strid'"])
        self.refused(1, "render", "box.json", "--at", "1", words=["there is no animation"])

    def test_ground(self):
        def words(*options, command="box.json"):
            return self.ok("render", command, "--spp", "1", *options).stderr
        self.assertIn("ground where it fits of 0.55", words())
        self.assertIn("ground where it fits of 0.25", words("--background", "0.25"))
        self.assertIn("ground of 0.55", words("--ground", "shadow"))
        self.assertIn("ground of 0.75", words("--ground", "0.5,0.75,1", "--background", "0.25"))
        self.assertNotIn("ground", words("--ground", "none"))
        self.assertNotIn("ground", words("--background", "transparent"))
        self.assertIn("ground of 0.25", words("--ground", "0.25", "--background", "transparent"))
        self.refused(2, "render", "box.json", "--ground", "shadow", "--background", "transparent", words=["--ground", "--background"])
        self.refused(2, "render", "box.json", "--ground", "shade", words=["--ground", "shade"])

    def test_turntable(self):
        """Pictures from all around, of a scene that is compiled once."""
        before = set(os.listdir(self.folder))
        words = self.ok("render", "box.json", "--spp", "1", "--turntable", "4", "-o", "t.###.png", "-o", "t#.exr").stderr
        self.assertEqual(set(os.listdir(self.folder)) - before, {f"t.00{i}.png" for i in range(4)} | {f"t{i}.exr" for i in range(4)})
        self.assertEqual(words.count("camera 'orbit' at 30,20,100"), 1, words)
        self.assertEqual(words.count("camera '"), 1, words)
        words = self.ok("render", "box.json", "--spp", "1", "--turntable", "2", "--view", "left").stderr
        self.assertIn("at -90,0,100", words)
        self.assertTrue(os.path.exists(self.path("box.0001.png")))
        self.ok("render", "box.json", "--spp", "1", "--turntable", "1", "-o", "one.png")
        self.scene("walk.json", "camera main moves stride")
        self.ok("render", "walk.json", "--spp", "1", "--turntable", "1", "--at", "1", "-o", "one.png")

    def test_wrong_turntables(self):
        def wrong(*arguments, words):
            self.refused(2, "render", "box.json", "--spp", "1", *arguments, words=["--turntable", *words])
        wrong("--turntable", "0", words=[])
        wrong("--turntable", "3", "--frames", "0:1", words=["--frames"])
        wrong("--turntable", "3", "--camera", "main", words=["--camera", "--orbit"])
        wrong("--turntable", "3", "--look-from", "1,2,3", words=["--look-from"])
        wrong("--turntable", "3", "--look-at", "1,2,3", words=["--look-at"])
        wrong("--turntable", "3", "--up", "1,2,3", words=["--up"])
        wrong("--turntable", "3", "--time", "1s", words=["--time"])
        wrong("--turntable", "3", "--only-sample", "0,0,0", words=["--only-sample"])
        self.refused(2, "render", "box.json", "--turntable", "3", "-o", "a.png", words=["a.png", "####"])

    def test_a_turntable_goes_around(self):
        """With the library: the first picture has the bits of a run of its own, the others those of runs that begin there, but
        for the rounding of positions, which are relative to the first camera. Turned the other way they differ by far more."""
        if not PROGRAM:
            self.skipTest("no program given")
        with open(self.path("model.gltf"), "w") as file:
            json.dump(walking_model(), file)
        common = ["model.gltf", "-q", "--spp", "4", "--size", "48x36", "--tonemap", "srgb", "--light", "sky", "--exposure", "0"]
        def difference(a, b):
            return sum(abs(x - y) for x, y in zip(a, b)) / sum(a)
        for options in ([], ["--fov", "50"]):
            self.ok("render", *common, *options, "--turntable", "4", "--orbit", "30,20", "-o", "t.#.hdr", program=PROGRAM)
            turned = [pixels_of_hdr(self.path(f"t.{i}.hdr")) for i in range(4)]
            single = []
            for i in range(4):
                self.ok("render", *common, *options, "--turntable", "1", "--orbit", f"{30 + 90 * i},20", "-o", "a.hdr",
                        program=PROGRAM)
                single.append(pixels_of_hdr(self.path("a.hdr")))
            self.assertEqual(turned[0], single[0])
            for i in range(4):
                self.assertLess(difference(turned[i], single[i]), 1e-4, f"picture {i} with {options}")
            self.assertGreater(difference(turned[1], single[3]), 1e-2)

    def test_no_frame_is_written_over_an_input(self):
        self.scene("walk.json", "camera main moves stride texture t.0003.png")
        with open(self.path("t.0003.png"), "w") as file:
            file.write("a picture")
        self.refused(1, "render", "walk.json", "--spp", "1", "--frames", "0:5", "-o", "t.####.png",
                     words=["t.0003.png is a texture of this scene"])
        self.ok("render", "walk.json", "--spp", "1", "--frames", "0:2", "-o", "t.####.png")

    def test_frames_of_a_file_are_its_poses(self):
        """With the library: each frame has the bits of a run of its own, whatever moves."""
        if not PROGRAM:
            self.skipTest("no program given")
        with open(self.path("model.gltf"), "w") as file:
            json.dump(walking_model(), file)
        for options in ([], ["--orbit", "20,30"], ["--fov", "50"], ["--light", "file"], ["--shutter", "0.5"], ["--ground", "shadow"]):
            common = ["model.gltf", "-q", "--spp", "2", "--size", "64x48", "--exr", "float", *options]
            self.ok("render", *common, "--frames", "0:4", "--fps", "4", "-o", "f.#.exr", program=PROGRAM)
            pictures = set()
            for frame in range(5):
                self.ok("render", *common, "--fps", "4", "--at", str(frame / 4), "-o", "a.exr", program=PROGRAM)
                with open(self.path("a.exr"), "rb") as one, open(self.path(f"f.{frame}.exr"), "rb") as other:
                    a, b = (re.sub(rb"fathom\.(load|build|render)_s\0string\0.{4}[0-9.]+", b"", f.read(), flags=re.DOTALL)
                            for f in (one, other))
                self.assertTrue(a == b, f"frame {frame} with {options}")
                pictures.add(a)
            self.assertEqual(len(pictures), 5)

    def test_convert(self):
        self.scene("box.json", "camera main warn odd")
        result = self.ok("convert", "box.json", "new.json")
        self.assertIn("fathom: warning: odd", result.stderr)
        self.assertIn("wrote new.json", result.stderr)
        with open(self.path("new.json")) as file:
            written = json.load(file)
        self.assertEqual(list(written["cameras"]), ["main"])
        self.assertEqual(written["scene"], [{"transform": {"translate": [1, 2, 3]}, "camera": "main"}])
        self.assertNotIn("wrote", self.ok("convert", "box.json", "new.json", "-q").stderr)
        self.refused(2, "convert", "box.json", "new.glb", words=["new.glb", ".json"])
        self.refused(2, "convert", "box.json")
        self.refused(1, "convert", "box.json", "nowhere/new.json", words=["nowhere"])
        self.refused(1, "convert", "box.json", "box.json", words=["box.json", "read from this file"])
        os.symlink("box.json", self.path("link.json"))
        self.refused(1, "convert", "box.json", "link.json", words=["link.json", "read from this file"])
        with open(self.path("box.json")) as file:
            self.assertEqual(file.read(), "camera main warn odd")

    def test_what_decides_the_picture_is_the_same_for_render_and_view(self):
        def options(command):
            return set(re.findall(r"^ +(?:-\w,)?(--[a-z-]+)", self.ok(command, "--help").stdout, re.MULTILINE))
        of_files_only = {"--output", "--png-bits", "--exr", "--aov", "--mergeable", "--samples", "--only-sample", "--time",
                         "--crop", "--quiet", "--progress", "--frames", "--turntable", "--fps", "--shutter", "--quality", "--denoise"}
        self.assertEqual(options("render") - options("view"), of_files_only)
        self.assertEqual(options("view") - options("render"), {"--log-latency", "--script-moves"})
        self.assertIn("--scene", options("info"))
        self.refused(2, "view", "box.json", "--filter", "bix", words=["--filter", "box or gaussian"])

    def test_the_readme_has_every_option(self):
        with open(os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "README.md")) as file:
            table = "".join(line for line in file if line.startswith("|"))
        help_text = self.ok("render", "--help").stdout
        options = set(re.findall(r"^ +(?:-\w,)?(--[a-z-]+)", help_text, re.MULTILINE)) - {"--help", "--output"}
        self.assertGreater(len(options), 25)
        for option in options:
            self.assertIn(f"`{option}", table)
        for option in re.findall(r"`(--[a-z-]+)", table):
            self.assertIn(option, options)

    def test_a_scene_of_several(self):
        for command in ("render", "info"):
            result = self.ok(command, "box.json", "--scene", "two", *(["--spp", "1"] if command == "render" else []))
            self.assertIn("scene two", result.stderr + result.stdout)

    def test_threads_that_can_t_be_started(self):
        if not PROGRAM or os.geteuid() != 0:
            self.skipTest("needs the program, and root, who can become a user that may have few threads")
        self.scene("sphere.json", '{"fathom": 1, "scene": [{"sphere": {"radius": 1}}]}')
        os.chmod(self.folder, 0o777)

        def become_nobody():
            os.setgid(54321)
            resource.setrlimit(resource.RLIMIT_NPROC, (3, 3))
            os.setuid(54321)

        probe = self.run_program("version", program=PROGRAM, preexec_fn=become_nobody)
        if probe.returncode != 0:
            self.skipTest("another user can't run the program here")
        result = self.run_program("render", "sphere.json", "--spp", "4", "--size", "64x64", "--threads", "16", "-o",
                                  "a.exr", "-o", "a.png", program=PROGRAM, preexec_fn=become_nobody,
                                  env=WITHOUT_LEAK_CHECK)
        self.assertEqual(result.returncode, 0, result.stderr)
        # The thread sanitizer has one thread of its own.
        self.assertRegex(result.stderr, "only [23] of 16 threads can be started here")
        self.ok("render", "sphere.json", "--spp", "4", "--size", "64x64", "-o", "b.png", program=PROGRAM)
        with open(self.path("a.png"), "rb") as one, open(self.path("b.png"), "rb") as other:
            self.assertEqual(one.read(), other.read())

    def test_the_program_itself(self):
        if not PROGRAM:
            self.skipTest("only the double was given")
        self.ok("--help", program=PROGRAM)
        self.ok("version", program=PROGRAM)
        self.refused(1, "render", "none.json", words=["none.json"], program=PROGRAM)
        self.refused(2, "render", "box.json", "--spp", "0", words=["--spp"], program=PROGRAM)


if __name__ == "__main__":
    DOUBLE = os.path.abspath(sys.argv[1])
    PROGRAM = os.path.abspath(sys.argv[2]) if len(sys.argv) > 2 else None
    FAKE_OIDN = os.path.abspath(sys.argv[3]) if len(sys.argv) > 3 else None
    unittest.main(argv=sys.argv[:1], verbosity=1)
