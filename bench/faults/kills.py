#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Kills renders at random moments and cuts their writes at random bytes: no checkpoint may be lost or damaged, and
every final image must equal that of an uninterrupted run bit by bit.

usage: kills.py FATHOM [KILLS [SEED]]
    KILLS   number of renders to kill (default 1000)

Each run of a render is killed (kill -9) after a random time, or not. One run in three can write files of a random
length only (RLIMIT_FSIZE), and one in three writes to a nearly full file system (a tmpfs, which needs root; otherwise
the report says that it was left out). After each run both checkpoints are read: the newer one must be complete, and
must not have fewer samples than before.
"""
import json
import os
import random
import resource
import subprocess
import sys
import tempfile
import time

from film import numbers_of

SCENE = {"fathom": 1, "camera": {"position": [0, 0, 5], "look_at": [0, 0, 0]},
         "materials": {"glass": {"kind": "glass"}, "wall": {"color": [0.8, 0.3, 0.2]}},
         "environment": {"kind": "gradient"},
         "scene": [{"sphere": {"radius": 1}, "material": "glass"},
                   {"sphere": {"radius": 100, "center": [0, -101, 0]}, "material": "wall"}]}
SAMPLES = 192


class Faults:
    def __init__(self, fathom, folder, seed):
        self.fathom, self.folder, self.random = fathom, folder, random.Random(seed)
        self.kills = self.renders = self.limited = self.full = self.lost = self.damaged = self.different = 0
        self.previous_taken = 0
        with open(os.path.join(folder, "scene.json"), "w") as file:
            json.dump(SCENE, file)
        self.small_disk = os.path.join(folder, "small")
        os.mkdir(self.small_disk)
        self.has_small_disk = subprocess.run(["mount", "-t", "tmpfs", "-o", "size=3m", "tmpfs", self.small_disk],
                                             capture_output=True).returncode == 0
        self.seconds = float("inf")
        self.run(["--checkpoint", "whole.exr", "-o", "whole.png"], is_whole=True)
        self.picture = self.read("whole.png")
        self.sums = numbers_of(self.path("whole.exr"))[1]

    def close(self):
        if self.has_small_disk:
            subprocess.run(["umount", self.small_disk], check=True)

    def path(self, name):
        return os.path.join(self.folder, name)

    def read(self, name):
        with open(self.path(name), "rb") as file:
            return file.read()

    def run(self, arguments, kill_after=None, limit=None, is_whole=False):
        def set_limit():
            resource.setrlimit(resource.RLIMIT_FSIZE, (limit, limit))

        start = time.monotonic()
        process = subprocess.Popen([self.fathom, "render", "scene.json", "--size", "96x64", "--spp", str(SAMPLES),
                                    "--every", "0.02s", *arguments], cwd=self.folder, stderr=subprocess.PIPE, text=True,
                                   preexec_fn=set_limit if limit is not None else None)
        try:
            text = process.communicate(timeout=kill_after)[1]
        except subprocess.TimeoutExpired:
            process.kill()
            text = process.communicate()[1]
        # Kills are timed within the shortest render so far: a run on a busy machine takes longer, and later kills might
        # miss.
        if is_whole and process.returncode == 0:
            self.seconds = min(self.seconds, time.monotonic() - start)
        return process.returncode, text

    def samples(self, checkpoint):
        """The checkpoint that a render would resume from: the one that reports more samples."""
        best = 0
        for name in checkpoint + ".exr", checkpoint + ".previous.exr":
            if not os.path.exists(self.path(name)):
                continue
            result = subprocess.run([self.fathom, "info", name, "--json"], cwd=self.folder, capture_output=True, text=True)
            if result.returncode != 0:
                self.damaged += 1
                print(f"damaged: {result.stderr}", flush=True)
                continue
            best = max(best, json.loads(result.stdout)["samples_per_pixel"])
        return best

    def fill_disk(self):
        """Fills the small disk up to a random amount of free space."""
        ballast = os.path.join(self.small_disk, "ballast")
        if os.path.exists(ballast):
            os.remove(ballast)
        status = os.statvfs(self.small_disk)
        with open(ballast, "wb") as file:
            file.write(bytes(self.random.randrange(status.f_bavail * status.f_frsize)))

    def render(self, kind):
        """Renders one image in as many runs as it takes."""
        place = "small/" if kind == "full" else ""
        for name in "c.exr", "c.previous.exr", "ballast", "a.png":
            if os.path.exists(self.path(place + name)):
                os.remove(self.path(place + name))
        before, is_done, arguments = 0, False, ["--checkpoint", place + "c.exr", "-o", place + "a.png"]
        for attempt in range(1000):
            # The last attempts run undisturbed: a finished image may coincide with a checkpoint that found no space.
            hindered = attempt < 30 and not is_done
            limit = self.random.randrange(600_000) if hindered and kind == "limit" else None
            if hindered and kind == "full":
                self.fill_disk()
            elif kind == "full" and os.path.exists(self.path("small/ballast")):
                os.remove(self.path("small/ballast"))
            code, text = self.run(arguments, self.random.uniform(0, 0.8 * self.seconds) if hindered else None, limit, before == 0)
            self.kills += code == -9
            self.limited += limit is not None
            self.full += hindered and kind == "full"
            self.previous_taken += "c.previous.exr" in text
            now = self.samples(place + "c")
            if now < before:
                self.lost += 1
                print(f"lost: {before} samples became {now}: {text}", flush=True)
            before = now
            if code == 0 and now == SAMPLES:
                break
            is_done = is_done or code == 0
        self.renders += 1
        if self.read(place + "a.png") != self.picture or numbers_of(self.path(place + "c.exr"))[1] != self.sums:
            self.different += 1
            print("a picture differs", flush=True)


def main():
    if len(sys.argv) < 2:
        print(__doc__)
        return 2
    fathom = os.path.abspath(sys.argv[1])
    kills, seed = (int(sys.argv[i]) if len(sys.argv) > i else value for i, value in ((2, 1000), (3, 1)))
    with tempfile.TemporaryDirectory() as folder:
        faults = Faults(fathom, folder, seed)
        try:
            kinds = ["none", "limit"] + (["full"] if faults.has_small_disk else [])
            if not faults.has_small_disk:
                print("skipped: a file system that is full (a tmpfs can't be mounted here)")
            while faults.kills < kills:
                faults.render(kinds[faults.renders % len(kinds)])
            for kind in kinds[faults.renders:]:
                faults.render(kind)
        finally:
            faults.close()
        print(f"{faults.kills} kills in {faults.renders} renders; {faults.limited} runs with writes that end, {faults.full} on a "
              f"full disk; the state before was taken {faults.previous_taken} times")
        print(f"{faults.lost} checkpoints lost, {faults.damaged} damaged, {faults.different} pictures that differ")
        return 1 if faults.lost + faults.damaged + faults.different else 0


if __name__ == "__main__":
    sys.exit(main())
