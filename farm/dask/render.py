#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Renders an image in parts on the workers of Dask, and merges them: docs/farm/dask.md.

    farm/dask/render.py SCENE FOLDER [--parts N] [--spp N] [--picture NAME] [--program FATHOM] [--scheduler ADDRESS]
                        [-- OPTION...]

All workers must see SCENE and FOLDER. Without --scheduler, a cluster on this machine is started. OPTION...: further
options of `fathom render`.
"""
import argparse
import os
import subprocess
import sys

INTERRUPTED = 130  # exit code of an interrupted render, which keeps its samples


def render_part(words):
    """Renders a part until it has all samples; returns the error output of a part that failed, else nothing."""
    for _ in range(10):
        result = subprocess.run(words, capture_output=True, text=True)
        if result.returncode != INTERRUPTED:
            break
    return None if result.returncode == 0 else (result.stderr.strip().splitlines() or [f"exit code {result.returncode}"])[-1]


def client_of(options):
    from dask.distributed import Client, LocalCluster
    if options.scheduler:
        return Client(options.scheduler)
    # Each worker renders one part at a time, since a part uses all cores.
    return Client(LocalCluster(n_workers=1, threads_per_worker=1, dashboard_address=None))


def main():
    parser = argparse.ArgumentParser(usage=__doc__.split("\n\n")[1].strip())
    parser.add_argument("scene")
    parser.add_argument("folder")
    parser.add_argument("--parts", type=int, default=16)
    parser.add_argument("--spp", type=int, default=1024)
    parser.add_argument("--picture", default="picture.exr")
    parser.add_argument("--program", default="fathom")
    parser.add_argument("--scheduler")
    parser.add_argument("options", nargs="*")
    options = parser.parse_args()
    folder = os.path.abspath(options.folder)
    films = [os.path.join(folder, f"part-{part}.exr") for part in range(1, options.parts + 1)]
    words = [[options.program, "render", os.path.abspath(options.scene), "--spp", str(options.spp), "--part", f"{part}/{options.parts}",
              "--checkpoint", film, *options.options] for part, film in enumerate(films, 1)]
    with client_of(options) as client:
        # If a worker is lost, its part loses only the samples since its last checkpoint.
        failures = client.gather(client.map(render_part, words, retries=3, pure=False))
    for part, failure in enumerate(failures, 1):
        if failure:
            print(f"part {part}: {failure}", file=sys.stderr)
    there = [film for film in films if os.path.exists(film)]
    if not there:
        return 1
    merged = subprocess.run([options.program, "merge", *there, "-o", os.path.join(folder, options.picture)])
    return merged.returncode or (1 if any(failures) else 0)


if __name__ == "__main__":
    sys.exit(main())
