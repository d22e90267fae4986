# SPDX-License-Identifier: Apache-2.0
"""The protocol of renderer processes: requests and answers are lines of JSON.

A process loads a scene, renders one sample so that nothing is compiled or built later, and prints {"ready": true}. Then each
request {"spp", "seed", "out"} is answered by {"wall_s", "cpu_s"} of rendering alone, after the image was written as out.npy.
"""
import json
import os
import resource
import sys
import time

import numpy as np


def cpu_seconds(who=resource.RUSAGE_SELF):
    usage = resource.getrusage(who)
    return usage.ru_utime + usage.ru_stime


def timed(action):
    """Result, elapsed seconds and processor seconds of all threads."""
    wall, cpu = time.perf_counter(), cpu_seconds()
    result = action()
    return result, time.perf_counter() - wall, cpu_seconds() - cpu


def answers():
    """The stream for answers. Renderers print to the standard output, so that is sent to the standard error instead."""
    stream = os.fdopen(os.dup(1), "w")
    os.dup2(2, 1)
    return stream


def serve(stream, render):
    """render(spp, seed) returns image, wall_s and cpu_s."""
    print(json.dumps({"ready": True}), file=stream, flush=True)
    for line in sys.stdin:
        request = json.loads(line)
        image, wall, cpu = render(request["spp"], request["seed"])
        np.save(request["out"], np.asarray(image, np.float32))
        print(json.dumps({"wall_s": wall, "cpu_s": cpu}), file=stream, flush=True)
    stream.close()
    os._exit(0)  # Some renderers crash when they are unloaded.


def without_start(run, starts):
    """Returns a function like run(spp, seed), which returns pixels, wall and processor time, that leaves the time of
    starting out. starts: wall and processor times of renders with one sample, which are mostly starting."""
    wall_start, cpu_start = (min(values) for values in zip(*starts))

    def rendered(spp, seed):
        pixels, wall, cpu = run(spp, seed)
        if spp == 1:
            return pixels, wall, cpu
        scale = spp / (spp - 1)
        return pixels, max(wall - wall_start, 1e-3) * scale, max(cpu - cpu_start, 1e-3) * scale

    return rendered
