#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Tests of the command line: invalid input and output, files that are never overwritten, full disks."""
import os
import resource
import shutil
import subprocess

from harness import CommandLine, DOUBLE, is_sanitized, png_size, run_tests, waiting


class Files(CommandLine):
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

    def test_names_that_are_too_long(self):
        """Names are refused before anything is rendered: for their own length, for that with a suffix, or for that of
        their folders."""
        limit = os.pathconf(self.folder, "PC_NAME_MAX")
        longest = "x" * (limit - 4)
        before = sorted(os.listdir(self.folder))
        long_name = ["can't write: the name has ", f" bytes, and this folder allows {limit}"]
        self.refused(1, "render", "box.json", "-o", longest + "x.exr", words=long_name)
        self.refused(1, "render", "box.json", "-o", "a.png", "-o", "x" * 300 + ".exr", words=long_name)
        self.refused(1, "render", "box.json", "--checkpoint", longest + "x.exr", words=long_name)
        self.refused(1, "render", "box.json", "--checkpoint", "x" * (limit - 12) + ".exr", words=["NAME.previous.exr", str(limit + 1)])
        # The last frame has one digit more than the first.
        self.refused(1, "render", "box.json", "--frames", "9:10", "-o", "x" * (limit - 5) + "#.exr", words=long_name)
        self.refused(1, "render", "box.json", "--turntable", "11", "-o", "x" * (limit - 5) + "#.exr", words=long_name)
        folder = "/".join(["y" * 200] * 20)
        self.refused(1, "render", "box.json", "-o", folder + "/a.exr", words=["can't write"])
        self.refused(1, "render", "box.json", "-o", "/" + "y/" * 2040 + "a" * 30 + ".exr", words=["the path has 4115 bytes"])
        self.assertEqual(sorted(os.listdir(self.folder)), before)
        self.ok("render", "box.json", "-q", "--spp", "1", "-o", longest + ".png", "--checkpoint", "x" * (limit - 13) + ".exr")
        self.assertIn(longest + ".png", os.listdir(self.folder))

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
                         words=[f"fathom: {name} is {what}: choose another file with -o"])
        # The default name of the output is checked, too; files that the scene does not read are not protected.
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
            process = waiting.run([DOUBLE, "render", "box.json", "--spp", "1", "-o", "a.png"], cwd=self.folder, stderr=None,
                                  preexec_fn=close)
            self.assertEqual(process.returncode, 1)
            self.assertEqual(png_size(self.path("a.png"))[:2], (800, 600))
            os.remove(self.path("a.png"))
        # The reader of the progress goes away, as `| head -1` does.
        process, gate = self.start_at_gate(2, "--spp", "20", "--progress", "json", "-o", "a.png")
        process.stderr.readline()
        process.stderr.close()
        process.stderr = None
        gate.allow()
        waiting.finish(process)
        self.assertEqual(process.returncode, 1)
        self.assertEqual(png_size(self.path("a.png"))[:2], (800, 600))
        # Closed streams are no error if there is nothing to print.
        process = waiting.run([DOUBLE, "version"], stderr=None, preexec_fn=lambda: os.close(2))
        self.assertEqual(process.returncode, 0)

    def test_output_that_can_t_be_printed(self):
        for arguments in (["version"], ["--version"], ["--help"], ["info", "box.json"], ["info", "box.json", "--json"],
                          ["render", "box.json", "-q", "--only-sample", "1,2,3"]):
            with open("/dev/full", "w") as full:
                result = waiting.run([DOUBLE, *arguments], cwd=self.folder, stdout=full)
            self.assertEqual(result.returncode, 1, arguments)
            lines = [line for line in result.stderr.splitlines() if "warning" not in line]
            self.assertEqual(len(lines), 1, result.stderr)
            self.assertIn("standard output: can't write: ", lines[0])

    def test_without_proc(self):
        if is_sanitized():
            self.skipTest("a sanitizer needs /proc")
        script = 'mount -t tmpfs none /proc && exec "$@"'
        rights = [] if os.geteuid() == 0 else ["--user", "--map-root-user"]
        command = ["unshare", *rights, "--mount", "sh", "-c", script, "sh"]
        if not shutil.which("unshare") or subprocess.run([*command, "true"], capture_output=True).returncode != 0:
            self.skipTest("nothing can be mounted here")
        result = waiting.run([*command, DOUBLE, "render", "box.json", "--spp", "1", "-o", "a.exr", "-o", "a.png"],
                             cwd=self.folder)
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertEqual(sorted(os.listdir(self.folder)), ["a.exr", "a.png", "box.json"])

    def test_too_large_is_refused_before_it_is_tried(self):
        before = waiting.processor_seconds_of_children()
        self.refused(1, "render", "box.json", "--size", "16000000x16000000", "-o", "a.exr", words=["GB"])
        self.assertLess(waiting.processor_seconds_of_children() - before, 5)

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


if __name__ == "__main__":
    run_tests()
