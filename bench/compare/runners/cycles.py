# SPDX-License-Identifier: Apache-2.0
"""Renders with Cycles in bpy: cycles.py FOLDER MODE THREADS WIDTH HEIGHT. Blender's z axis points up."""
import os
import sys
import tempfile
from pathlib import Path

sys.path[0] = str(Path(__file__).resolve().parents[1])
from runners import serve


def main(folder, _, threads, width, height):
    stream = serve.answers()
    import bpy
    import numpy as np

    import neutral
    from exporters import cycles as exporter
    source = neutral.load(Path(folder))
    source["size"] = [int(width), int(height)]
    scene = exporter.build(bpy, source)
    cycles, render = scene.cycles, scene.render
    render.engine, cycles.device = "CYCLES", "CPU"
    cycles.use_adaptive_sampling = cycles.use_denoising = cycles.use_auto_tile = False
    cycles.sampling_pattern, cycles.pixel_filter_type = "TABULATED_SOBOL", "BOX"
    cycles.sample_clamp_direct = cycles.sample_clamp_indirect = cycles.blur_glossy = cycles.light_sampling_threshold = 0
    cycles.caustics_reflective = cycles.caustics_refractive = True
    for kind in ("max", "diffuse", "glossy", "transmission", "volume"):
        setattr(cycles, f"{kind}_bounces", min(1024, source["depth"] - 1))  # Cycles counts from 0: direct light
    cycles.transparent_max_bounces = 1024
    render.threads_mode, render.threads, render.use_persistent_data = "FIXED", int(threads), True
    render.image_settings.file_format, render.image_settings.color_depth, render.image_settings.color_mode = "OPEN_EXR", "32", "RGB"
    scene.view_settings.view_transform = "Raw"

    with tempfile.TemporaryDirectory() as temporary:
        render.filepath = os.path.join(temporary, "image.exr")

        def run(spp, seed):
            cycles.samples, cycles.seed = spp, seed

            def picture():
                bpy.ops.render.render(write_still=True)
            _, wall, cpu = serve.timed(picture)
            loaded = bpy.data.images.load(render.filepath)
            loaded.colorspace_settings.name = "Non-Color"
            pixels = np.array(loaded.pixels[:], dtype=np.float32).reshape(int(height), int(width), -1)[::-1, :, :3]
            bpy.data.images.remove(loaded)
            return pixels, wall, cpu

        run(1, 999)
        # Synchronization of the scene is a part of each run; it is measured with one sample, most of which is no rendering.
        starts = [run(1, 998)[1:] for _ in range(3)]
        serve.serve(stream, serve.without_start(run, starts))


main(*sys.argv[1:])
