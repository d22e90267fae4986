#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Tests of standard input and output, of names with {name}, {view} and {frame}, of --config and of --watch."""
import os
import pathlib
import signal
import subprocess
import unittest

from harness import PROGRAM, CommandLine, png_size, run_tests, waiting

TRIANGLE = b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"
UNKNOWN = b"fathom: /dev/stdin: its format can't be detected from the content: give a file whose name has an extension, or --format\n"
SMALL = ["--size", "16x12", "--spp", "1", "--quiet"]


def fathom(folder, *words, **more):
    return subprocess.run([PROGRAM, *words], cwd=folder, capture_output=True, timeout=120, **more)


class Pipes(CommandLine):
    def render(self, *words, **more):
        return fathom(self.folder, "render", *words, *SMALL, **more)

    def test_a_model_goes_in_and_an_image_comes_out(self):
        self.scene("model.obj", TRIANGLE.decode())
        for kind, magic in (("png", b"\x89PNG"), ("jpg", b"\xff\xd8"), ("exr", b"\x76\x2f\x31\x01"), ("webp", b"RIFF")):
            out = self.render("-", "--format", "obj", "-o", "-", "--output-format", kind, input=TRIANGLE)
            self.assertEqual((out.returncode, out.stderr), (0, b""))
            self.assertTrue(out.stdout.startswith(magic), kind)
            self.assertEqual(self.render("model.obj", "-o", "file." + kind).returncode, 0)
            if kind == "png":
                self.assertEqual(out.stdout, pathlib.Path(self.path("file.png")).read_bytes())
        self.assertEqual([name for name in os.listdir(self.folder) if name.startswith("std")], [])

    def test_the_format_of_a_pipe_must_be_known(self):
        out = self.render("-", "-o", "-", "--output-format", "png", input=TRIANGLE)
        self.assertEqual((out.returncode, out.stdout, out.stderr), (1, b"", UNKNOWN))
        out = self.render("-", "--format", "obj", "-o", "-", input=TRIANGLE)
        self.assertEqual(out.returncode, 1)
        self.assertEqual(out.stderr.count(b"\n"), 1)
        self.assertIn(b"/dev/stdout: can't write an image without an extension", out.stderr)

    def test_the_output_format_overrides_the_name(self):
        self.scene("model.obj", TRIANGLE.decode())
        self.assertEqual(self.render("model.obj", "-o", "thumbnail", "--output-format", "png").returncode, 0)
        self.assertEqual(pathlib.Path(self.path("thumbnail")).read_bytes()[:4], b"\x89PNG")

    def test_a_closed_pipe_is_one_error_and_the_image_is_kept(self):
        reader, writer = os.pipe()
        os.close(reader)
        result = subprocess.run([PROGRAM, "render", "-", "--format", "obj", "-o", "-", "--output-format", "png", *SMALL],
                                cwd=self.folder, input=TRIANGLE, stdout=writer, stderr=subprocess.PIPE, timeout=120)
        os.close(writer)
        self.assertEqual(result.returncode, 1)
        self.assertEqual(result.stderr.decode().splitlines()[0], "fathom: /dev/stdout: can't write: Broken pipe")
        self.assertEqual(pathlib.Path(self.path("stdout.png")).read_bytes()[:4], b"\x89PNG")

    def test_a_full_disk_is_an_error(self):
        with open("/dev/full", "wb") as full:
            result = subprocess.run([PROGRAM, "render", "-", "--format", "obj", "-o", "-", "--output-format", "png", *SMALL],
                                    cwd=self.folder, input=TRIANGLE, stdout=full, stderr=subprocess.PIPE, timeout=120)
        self.assertEqual(result.returncode, 1)
        self.assertTrue(result.stderr.decode().startswith("fathom: /dev/stdout: can't write: No space left on device\n"))

    def test_names_with_placeholders(self):
        self.scene("model.obj", TRIANGLE.decode())
        self.assertEqual(self.render("model.obj", "-o", "{name}-small.png").returncode, 0)
        self.assertEqual(self.render("model.obj", "--turntable", "2", "-o", "{name}.{view}.png").returncode, 0)
        made = set(os.listdir(self.folder))
        self.assertLessEqual({"model-small.png", "model.0000.png", "model.0001.png"}, made)


class Config(CommandLine):
    def test_the_command_line_overrides_the_file(self):
        self.scene("model.obj", TRIANGLE.decode())
        self.scene("options", "# a comment\nsize = 20x10   # behind a value\nspp = 2\noutput = \"from file.png\"\nquiet = true\n")
        out = fathom(self.folder, "render", "model.obj", "--config", "options")
        self.assertEqual((out.returncode, out.stderr), (0, b""))
        self.assertEqual(png_size(self.path("from file.png"))[:2], (20, 10))
        out = fathom(self.folder, "render", "--config=options", "--size", "8x6", "-o", "other.png", "model.obj")
        self.assertEqual(out.returncode, 0)
        self.assertEqual(png_size(self.path("other.png"))[:2], (8, 6))

    def test_errors_name_the_line(self):
        self.scene("options", "spp = 2\nspq = 3\n")
        out = fathom(self.folder, "render", "model.obj", "--config", "options")
        self.assertEqual((out.returncode, out.stderr), (2, b"fathom: options:2: 'spq' is no option of fathom render\n"))
        self.scene("options", "spp 2\n")
        out = fathom(self.folder, "render", "model.obj", "--config", "options")
        self.assertEqual((out.returncode, out.stderr), (2, b"fathom: options:1: expected NAME = VALUE, found 'spp 2'\n"))
        out = fathom(self.folder, "render", "model.obj", "--config", "missing")
        self.assertEqual((out.returncode, out.stderr), (1, b"fathom: missing: can't be read: No such file or directory\n"))


class Watch(CommandLine):
    def wait_for(self, condition):
        waiting.wait_for("the program", condition)

    def test_an_interrupt_right_after_the_image_is_not_lost(self):
        self.scene("model.obj", TRIANGLE.decode())
        image = pathlib.Path(self.path("model.png"))
        for _ in range(8):
            program = subprocess.Popen([PROGRAM, "render", "model.obj", "--watch", "--size", "16x12", "--spp", "1", "-q"], cwd=self.folder)
            self.end_at_the_end(program)
            waiting.wait_for("the image", image.exists, pause_s=0.0001)
            program.send_signal(signal.SIGINT)
            waiting.finish(program)
            self.assertEqual(program.returncode, 130)
            image.unlink()

    def test_renders_again_after_a_change_until_an_interrupt(self):
        self.scene("model.obj", "mtllib model.mtl\nusemtl red\n" + TRIANGLE.decode())
        self.scene("model.mtl", "newmtl red\nKd 1 0 0\n")
        image = pathlib.Path(self.path("model.png"))
        log = pathlib.Path(self.path("log"))
        with open(log, "w") as stderr:
            program = subprocess.Popen([PROGRAM, "render", "model.obj", "--watch", "--size", "16x12", "--spp", "1"], cwd=self.folder,
                                       stderr=stderr, stdout=subprocess.DEVNULL)
        self.end_at_the_end(program)
        waits = lambda: log.read_text().count("watching 2 files")
        self.wait_for(lambda: waits() == 1)
        first = image.read_bytes()
        self.scene("model.mtl", "newmtl red\nKd 0 0 1\n")
        self.wait_for(lambda: waits() == 2)
        self.assertNotEqual(image.read_bytes(), first)
        self.scene("model.obj", "f 1 2 3\n")
        self.wait_for(lambda: waits() == 3)
        self.assertIn("model.obj", log.read_text().splitlines()[-2])
        self.scene("model.obj", "mtllib model.mtl\nusemtl red\n" + TRIANGLE.decode())
        self.wait_for(lambda: waits() == 4)
        program.terminate()
        waiting.finish(program)
        self.assertEqual(program.returncode, 130)

    def test_needs_a_file(self):
        out = fathom(self.folder, "render", "-", "--watch", input=TRIANGLE)
        self.assertEqual((out.returncode, out.stderr), (2, b"fathom: --watch: needs the name of a scene file, not the standard input\n"))


run_tests()
