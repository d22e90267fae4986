# SPDX-License-Identifier: Apache-2.0
"""Tests the container image's root folder: its size, what it must not contain, and a render in it by an unprivileged
user."""
import os
import re
import shutil
import subprocess
import tempfile
import unittest
from pathlib import Path

from harness import BUILD, FARM, ROOT

LARGEST_BYTES = 60_000_000
USER = 10001


def is_sanitized():
    cache = (BUILD / "CMakeCache.txt").read_text()
    return bool(re.search(r"^FATHOM_SANITIZE:STRING=.+", cache, flags=re.M))


def can_change_root():
    return os.geteuid() == 0 and subprocess.run(["unshare", "--mount", "--pid", "--fork", "true"], capture_output=True).returncode == 0


class Container(unittest.TestCase):
    def test_the_file_names_what_the_program_needs(self):
        """The Dockerfile has all packages that scripts/setup.sh builds with, except those that an image does not need."""
        setup = (ROOT / "scripts" / "setup.sh").read_text()
        wanted = set(re.search(r"packages_to_build=\((.*?)\)", setup, flags=re.S)[1].split())
        file = (FARM / "container" / "Dockerfile").read_text()
        named = set(re.search(r"--no-install-recommends(.*?)\nCOPY", file, flags=re.S)[1].replace("\\", " ").split())
        self.assertEqual(wanted - named, {"ccache", "libassimp-dev", "libsfml-dev"})
        self.assertRegex(file, r"\nFROM scratch\n")
        self.assertRegex(file, rf"\nUSER {USER}:{USER}\n")

    @unittest.skipIf(is_sanitized(), "a sanitized build is no image")
    @unittest.skipUnless(shutil.which("ldd"), "ldd is not there")
    def test_a_render_in_it(self):
        with tempfile.TemporaryDirectory() as folder:
            root = Path(folder) / "root"
            made = subprocess.run([FARM / "container" / "root.sh", BUILD, root], capture_output=True, text=True)
            self.assertEqual(made.returncode, 0, made.stderr)
            weight = sum(file.lstat().st_size for file in root.rglob("*") if not file.is_dir())
            self.assertLess(weight, LARGEST_BYTES)
            writable = [file for file in root.rglob("*") if not file.is_symlink() and file.stat().st_mode & 0o022]
            self.assertEqual(writable, [root / "tmp", root / "work"])
            if not can_change_root():
                self.skipTest("a folder can't be made the root here: the image was made and weighed, nothing run in it")
            shutil.copy(ROOT / "scenes" / "cornell-box.json", root / "work" / "scene.json")
            (root / "work" / "scene.json").chmod(0o644)
            (root / "dev" / "null").touch()
            script = f"mount -t proc proc {root}/proc && mount --bind /dev/null {root}/dev/null && exec chroot --userspec={USER}:{USER} {root} \"$@\""

            def run(*words):
                result = subprocess.run(["unshare", "--mount", "--pid", "--fork", "sh", "-c", script, "sh", *words], capture_output=True, text=True)
                return result.returncode, result.stdout + result.stderr
            code, text = run("/usr/local/bin/fathom", "render", "work/scene.json", "--size", "40x30", "--spp", "4",
                             *[word for kind in ("exr", "png", "jpg", "webp", "avif", "hdr") for word in ("-o", f"work/a.{kind}")])
            self.assertEqual(code, 0, text)
            self.assertEqual((root / "work" / "a.exr").stat().st_uid, USER)
            if shutil.which("busybox"):
                # The render is ended once it has reported progress, which follows the first samples.
                code, text = run("/bin/sh", "-c", "cd /work && : >log && "
                                 "{ fathom render scene.json --spp 2000000 --checkpoint f.exr --progress json 2>log & } && "
                                 "until while read -r line; do case $line in *progress*) seen=1;; esac; done <log; [ \"$seen\" ]; do sleep 1; done; "
                                 "kill -TERM $!; wait $!; echo code $?")
                self.assertIn("code 130", text)
                self.assertTrue((root / "work" / "f.exr").exists())
