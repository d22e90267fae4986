# SPDX-License-Identifier: Apache-2.0
"""Renders with LuxCore: luxcore.py FOLDER MODE THREADS WIDTH HEIGHT; MODE: path, bidir, hybrid (light tracing of caustics
beside path tracing) or cache (photons for caustics)."""
import json
import sys
import time
from pathlib import Path

sys.path[0] = str(Path(__file__).resolve().parents[1])
from runners import serve

MODES = {"path": {"renderengine.type": "PATHCPU"}, "bidir": {"renderengine.type": "BIDIRCPU"},
         "hybrid": {"renderengine.type": "PATHCPU", "path.hybridbackforward.enable": 1, "path.hybridbackforward.partition": 0.8,
                    "path.hybridbackforward.glossinessthreshold": 0.05},
         "cache": {"renderengine.type": "PATHCPU", "path.photongi.caustic.enabled": 1, "path.photongi.caustic.maxsize": 100000,
                   "path.photongi.photon.maxcount": 5000000, "path.photongi.caustic.lookup.radius": 0.02}}


def settings(mode, depth, threads, size, spp, seed):
    return {**MODES[mode], "sampler.type": "SOBOL", "sampler.sobol.adaptive.strength": 0.0, "renderengine.seed": seed + 1, "native.threads.count": threads,
            "path.pathdepth.total": depth, "path.pathdepth.diffuse": depth, "path.pathdepth.glossy": depth,
            "path.pathdepth.specular": depth, "path.clamping.variance.maxvalue": 0.0, "light.maxdepth": depth, "path.maxdepth": depth,
            "film.filter.type": "NONE", "film.width": size[0], "film.height": size[1], "film.outputs.0.type": "RGB",
            "film.outputs.0.filename": "unused.exr", "batch.haltspp": spp, "film.noiseestimation.warmup": 2**30}


def main(folder, mode, threads, width, height):
    stream = serve.answers()
    import numpy as np
    import pyluxcore

    import neutral
    from exporters import luxcore as exporter
    source, size = neutral.load(Path(folder)), (int(width), int(height))
    source["size"] = size
    reason = exporter.unsupported(source)
    if reason:
        print(json.dumps({"unsupported": reason}), file=stream, flush=True)
        return
    pyluxcore.Init(lambda message: None)

    def to_properties(rows):
        made = pyluxcore.Properties()
        for key, value in rows.items():
            plain = [x.item() if hasattr(x, "item") else x for x in value] if not isinstance(value, (str, int, float)) else value
            made.Set(pyluxcore.Property(key, plain))
        return made

    scene = exporter.build(pyluxcore, to_properties, source)

    def run(spp, seed):
        config = pyluxcore.RenderConfig(to_properties(settings(mode, source["depth"], int(threads), size, spp, seed)), scene)
        session = pyluxcore.RenderSession(config)

        def picture():
            session.Start()
            while not session.HasDone():
                time.sleep(0.01)
                session.UpdateStats()
        _, wall, cpu = serve.timed(picture)
        session.Stop()
        pixels = np.zeros((size[1], size[0], 3), dtype=np.float32)
        session.GetFilm().GetOutputFloat(pyluxcore.FilmOutputType.RGB, pixels, 0, True)
        return np.roll(pixels[::-1], -1, axis=0), wall, cpu  # LuxCore's image is one row too low.

    # Building the BVH is a part of each run; it is measured with one sample. A cache of photons counts as rendering.
    run(1, 999)
    serve.serve(stream, run if mode == "cache" else serve.without_start(run, [run(1, 998)[1:] for _ in range(2)]))


main(*sys.argv[1:])
