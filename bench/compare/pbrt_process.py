# SPDX-License-Identifier: Apache-2.0
"""Runs pbrt-v4, one process for each image. Loading is subtracted: it is measured with one sample per pixel."""
from exporters import pbrt as exporter
from exrs import read_exr
from programs import timed_run


class Pbrt:
    def __init__(self, program, integrator, scene, folder, threads, out_folder):
        self.program, self.integrator, self.scene, self.folder, self.threads = program, integrator, scene, folder, threads
        self.out = out_folder / f"{integrator}.exr"
        self.start = self.run(1, 0)

    def run(self, spp, seed):
        path = exporter.write(self.scene, self.folder, integrator=self.integrator, spp=spp, seed=seed, out=str(self.out))
        self.out.unlink(missing_ok=True)
        status, text, wall, cpu = timed_run([self.program, "--quiet", "--nthreads", self.threads, path])
        if status or not self.out.exists():
            raise OSError(f"pbrt: {(text.strip().splitlines() or ['no message'])[-1]}")
        return wall, cpu

    def render(self, spp, seed):
        wall, cpu = (max(value - start, 1e-3) for value, start in zip(self.run(spp, seed), self.start))
        return read_exr(self.out), wall, cpu

    def close(self):
        pass
