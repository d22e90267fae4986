#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Checks the model against renders: several processes at a time, each standing for a machine, read a scene from a file
server of low bandwidth.

    bench/scaling/check.py FATHOM SCENE_FOLDER SCENE [--processes 8] [--mb-s 40] [--names-s 500] [--cached]

Prints when the first and the last process begin to render, measured and by model.py; parsing and building are measured
without a server. Needs permission to mount, and the package fusepy.
"""
import argparse
import json
import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import model

HERE = Path(__file__).resolve().parent


def begun(words):
    """Starts a render; returns a function that waits for its end and returns the time until rendering began."""
    process = subprocess.Popen(words, stderr=subprocess.PIPE, text=True)

    def wait():
        last = None
        for line in process.stderr:
            event = json.loads(line)
            if event["event"] == "summary":
                last = event
        if process.wait() != 0 or not last:
            sys.exit("a render failed")
        return last["load_s"] + last["build_s"]
    return wait


def main():
    p = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    p.add_argument("fathom"), p.add_argument("folder"), p.add_argument("scene")
    p.add_argument("--processes", type=int, default=8)
    p.add_argument("--mb-s", type=float, default=40)
    p.add_argument("--names-s", type=float, default=500)
    p.add_argument("--cached", action="store_true")
    o = p.parse_args()
    with tempfile.TemporaryDirectory() as temporary:
        mount, log = Path(temporary) / "share", Path(temporary) / "log"
        mount.mkdir()

        def words(folder, index):
            return [o.fathom, "render", f"{folder}/{o.scene}", "--size", "32x24", "--spp", "1", "--threads", "1", "--guiding", "off", "--progress", "json",
                    "-o", f"{temporary}/{index}.exr"]
        # This measurement has no server, and the files are in the cache.
        begun(words(o.folder, 0))()
        waits = [begun(words(o.folder, i)) for i in range(o.processes)]
        local = sorted(wait() for wait in waits)

        server = subprocess.Popen([sys.executable, HERE / "share.py", o.folder, mount, str(o.mb_s), str(o.names_s), log, *(["--cached"] if o.cached else [])])
        while not os.path.ismount(mount):
            time.sleep(0.05)
        waits = [begun(words(mount, i)) for i in range(o.processes)]
        seen = sorted(wait() for wait in waits)
        subprocess.run(["fusermount", "-u", mount], check=True)
        server.wait()
        asked = json.loads(log.read_text())
    readers = 1 if o.cached else o.processes
    options = model.parser().parse_args([])
    options.machines, options.scene_gb, options.names = readers, asked["bytes"] / 1e9 / readers, asked["names"] / readers
    options.server_gb_s, options.link_gb_s, options.names_s, options.names_link_s = o.mb_s / 1e3, 100, o.names_s, o.names_s
    # All processes finish reading at the same time, and then share this machine's cores.
    options.parse_s, options.build_s, options.render_s = local[len(local) // 2], 0, 1e-3
    modelled = model.Farm(options).result()
    print(json.dumps({"bytes_from_server": asked["bytes"], "names_from_server": asked["names"], "without_server_s": local[len(local) // 2],
                      "first_s": seen[0], "last_s": seen[-1], "model_first_s": modelled["first_renders_s"],
                      "model_last_s": modelled["last_renders_s"]}, indent=1))


if __name__ == "__main__":
    main()
