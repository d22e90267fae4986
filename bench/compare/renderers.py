# SPDX-License-Identifier: Apache-2.0
"""Opens a scene in a renderer: every renderer has render(spp, seed), which returns image, wall_s and cpu_s of rendering alone."""
import json
import subprocess
from pathlib import Path

import numpy as np

import environments
import neutral
import pbrt_process
from exporters import fathom as fathom_exporter
from exporters import pbrt as pbrt_exporter
from exrs import read_exr
from programs import timed_run

HERE = Path(__file__).resolve().parent
# name: environment, script, mode of the script
PEERS = {"mitsuba": ("mitsuba", "mitsuba.py", "path"), "mitsuba-ptracer": ("mitsuba", "mitsuba.py", "ptracer"),
         "cycles": ("cycles", "cycles.py", "path"), "luxcore": ("luxcore", "luxcore.py", "path"),
         "luxcore-bidir": ("luxcore", "luxcore.py", "bidir"), "luxcore-hybrid": ("luxcore", "luxcore.py", "hybrid"),
         "luxcore-cache": ("luxcore", "luxcore.py", "cache")}
PBRT = {"pbrt": "volpath", "pbrt-bdpt": "bdpt", "pbrt-sppm": "sppm"}
# Fathom with its defaults, with light paths in any case, which shows what its own choice costs, and with photons.
FATHOM = {"fathom": [], "fathom-caustics-on": ["--caustics", "on"], "fathom-caustics-merged": ["--caustics", "merged"]}
NAMES = [*FATHOM, *PEERS, *PBRT]
CAUSTIC_ONLY = {"fathom-caustics-on", "fathom-caustics-merged", "mitsuba-ptracer", "luxcore-bidir", "luxcore-hybrid", "luxcore-cache", "pbrt-bdpt", "pbrt-sppm"}
READS_ROOMS = {"fathom", "mitsuba"}


class Unsupported(Exception):
    """A renderer lacks a feature of the scene."""


class Failed(Exception):
    """A renderer ended with an error."""


class Fathom:
    """Whole runs of the program; loading is subtracted, as the processor time of a run of one pixel without learning."""

    def __init__(self, program, settings, source, size, threads, folder):
        self.out, self.settings = folder / "fathom.exr", settings
        scene = source if source.suffix == ".xml" else fathom_exporter.write(neutral.load(source), source)
        self.command = [str(program), "render", str(scene), "--size", f"{size[0]}x{size[1]}", "--threads", str(threads), "--filter", "box",
                        "--build", "high", "--progress", "json", "-o", str(self.out)]
        one_pixel = ["--crop", "0,0,1,1", "--guiding", "off", "--caustics", "off"]
        self.loading_s = min(self.run(1, 0, *one_pixel)[1] for _ in range(2))

    def run(self, spp, seed, *options):
        self.out.unlink(missing_ok=True)
        status, text, _, cpu = timed_run([*self.command, "--spp", str(spp), "--seed", str(seed), *options])
        if status or not self.out.exists():
            raise Failed(f"fathom: {(text.strip().splitlines() or ['no message'])[-1]}")
        return last_event(text)["render_s"], cpu

    def render(self, spp, seed):
        wall, cpu = self.run(spp, seed, *self.settings)
        return read_exr(self.out), wall, max(cpu - self.loading_s, 1e-3)

    def close(self):
        pass


class Process:
    """A renderer that runs in its own environment and answers requests (runners/serve.py)."""

    def __init__(self, name, environment, script, mode, source, size, threads, folder):
        self.name, self.out, self.log = name, folder / f"{name}.npy", folder / f"{name}.log"
        command = [str(environment), str(HERE / "runners" / script), str(source), mode, str(threads), str(size[0]), str(size[1])]
        self.process = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=open(self.log, "w"), text=True)
        first = self.answer()
        if "unsupported" in first:
            self.close()
            raise Unsupported(f"{name}: {first['unsupported']}")

    def answer(self):
        line = self.process.stdout.readline()
        if not line:
            lines = self.log.read_text(errors="replace").strip().splitlines()
            raise Failed(f"{self.name}: {lines[-1] if lines else 'ended without a message'}")
        return json.loads(line)

    def render(self, spp, seed):
        print(json.dumps({"spp": spp, "seed": seed, "out": str(self.out)}), file=self.process.stdin, flush=True)
        answer = self.answer()
        return np.load(self.out).astype(np.float64), answer["wall_s"], answer["cpu_s"]

    def close(self):
        try:
            self.process.stdin.close()
        except OSError:  # It has ended already.
            pass
        self.process.wait()


def last_event(text):
    return json.loads([line for line in text.splitlines() if line.startswith("{")][-1])


def open_renderer(name, source, size, options, folder):
    """source: the folder of a generated scene, or the XML file of a room."""
    if source.suffix == ".xml" and name not in READS_ROOMS:
        raise Unsupported(f"{name} doesn't read Mitsuba's files")
    if name in FATHOM:
        return Fathom(options.fathom, FATHOM[name], source, size, options.threads, folder)
    if name in PBRT:
        if not options.pbrt:
            raise environments.Missing(f"{name}: no program; --pbrt BINARY names one")
        scene = neutral.load(source)
        reason = pbrt_exporter.unsupported(scene)
        if reason:
            raise Unsupported(f"{name}: {reason}")
        return pbrt_process.Pbrt(options.pbrt, PBRT[name], scene, source, options.threads, folder)
    environment, script, mode = PEERS[name]
    return Process(name, environments.python_of(environment, options.environments), script, mode, source, size, options.threads, folder)
