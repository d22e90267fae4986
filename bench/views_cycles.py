#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Compares `fathom render --cameras --dataset` with Cycles: processor time for several views of each model, loading included,
and noise.

usage: views_cycles.py PROGRAM BPY_PYTHON [--views N] [--size N] [--spp N] MODEL...

BPY_PYTHON is the Python of an environment with the package bpy (measured with 4.2.0). Both programs render the views of equal
cameras under bench's sky with a box filter, without adaptive sampling, clamping and denoising, on two threads. The noise is
the relMSE of one image: half of that between two seeds. Needs numpy and OpenEXR.
"""
import argparse
import json
import math
import pathlib
import resource
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent
SKY = ROOT / "scenes" / "images" / "sky.hdr"


def processor_seconds(command):
    """Runs a command; returns its processor time. bpy may crash when it ends, so images tell whether it has rendered."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    subprocess.run([str(word) for word in command], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, check=False)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def render_with_cycles(model, cameras, folder, spp, seed, size):
    """Renders all views with Cycles. Runs in BPY_PYTHON."""
    import bpy
    import mathutils
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.ops.import_scene.gltf(filepath=model)
    scene = bpy.context.scene
    for thing in [thing for thing in scene.objects if thing.type in ("LIGHT", "CAMERA")]:
        bpy.data.objects.remove(thing)
    world = scene.world = bpy.data.worlds.new("sky")
    world.use_nodes = True
    image = world.node_tree.nodes.new("ShaderNodeTexEnvironment")
    image.image = bpy.data.images.load(str(SKY))
    world.node_tree.links.new(image.outputs["Color"], world.node_tree.nodes["Background"].inputs[0])
    render, cycles = scene.render, scene.cycles
    render.engine, cycles.device, cycles.samples, cycles.seed = "CYCLES", "CPU", int(spp), int(seed)
    cycles.use_denoising = cycles.use_adaptive_sampling = False
    cycles.max_bounces = cycles.diffuse_bounces = cycles.glossy_bounces = cycles.transmission_bounces = 64
    # Both would make images darker on average, and less noisy.
    cycles.sample_clamp_indirect = cycles.blur_glossy = 0
    cycles.pixel_filter_type = "BOX"
    cycles.caustics_reflective = cycles.caustics_refractive = True
    render.threads_mode, render.threads = "FIXED", 2
    render.use_persistent_data = render.film_transparent = True
    render.resolution_x = render.resolution_y = int(size)
    settings = render.image_settings
    settings.file_format, settings.color_depth, settings.color_mode = "OPEN_EXR", "32", "RGBA"
    scene.view_settings.view_transform = "Raw"
    lens = bpy.data.cameras.new("camera")
    scene.camera = bpy.data.objects.new("camera", lens)
    scene.collection.objects.link(scene.camera)
    views = json.loads(pathlib.Path(cameras).read_text())
    lens.angle_x = 2 * math.atan(views["w"] / 2 / views["fl_x"])
    for i, view in enumerate(views["frames"]):
        scene.camera.matrix_world = mathutils.Matrix(view["transform_matrix"])
        render.filepath = f"{folder}/{i:02}.exr"
        bpy.ops.render.render(write_still=True)


def read(path):
    import numpy as np
    import OpenEXR
    channels = OpenEXR.File(str(path)).channels()
    color = next(channels[name] for name in ("RGBA", "RGB") if name in channels)
    return np.array(color.pixels[..., :3], float)


def compare(options, model, folder):
    """Returns seconds, relMSE and mean of both programs."""
    import numpy as np
    light = ["--env", SKY, "--background", "transparent", "--ground", "none"]
    processor_seconds([options.program, "render", model, "--views", options.views, "--dataset", "nerfstudio", "--size", "16x16",
                       "--spp", 1, *light, "-o", folder / "cameras"])
    cameras = folder / "cameras" / "transforms.json"
    size = f"{options.size}x{options.size}"
    results = {}
    for name in ("fathom", "cycles"):
        images, seconds = [], []
        for seed in (1, 2):
            out = folder / f"{name}{seed}"
            common = [options.program, "render", model, "--cameras", cameras, "--size", size, "--spp", options.spp,
                      "--seed", seed, "--threads", 2, "--filter", "box", *light]
            if name == "fathom":
                seconds.append(processor_seconds([*common, "--dataset", "nerfstudio", "-o", out]))
                processor_seconds([*common, "--guiding", "off", "--caustics", "off", "-o", f"{out}.##.exr"])
                images.append([read(f"{out}.{i:02}.exr") for i in range(options.views)])
            else:
                seconds.append(processor_seconds([options.bpy_python, __file__, "--cycles", model, cameras, out, options.spp,
                                                  seed, options.size]))
                images.append([read(out / f"{i:02}.exr") for i in range(options.views)])
        one, two = np.array(images)
        noise = ((one - two) ** 2 / 2 / (((one + two) / 2) ** 2 + 0.01)).mean()
        results[name] = sum(seconds) / 2, noise, float(np.array(images).mean())
    return results


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("program"), parser.add_argument("bpy_python"), parser.add_argument("models", nargs="+")
    parser.add_argument("--views", type=int, default=12)
    parser.add_argument("--size", type=int, default=512)
    parser.add_argument("--spp", type=int, default=64)
    options = parser.parse_args()
    logarithms = []
    for model in map(pathlib.Path, options.models):
        with tempfile.TemporaryDirectory() as folder:
            try:
                results = compare(options, model.resolve(), pathlib.Path(folder))
            except (OSError, RuntimeError) as error:
                print(f"| {model.stem} | not rendered: {error} |", flush=True)
                continue
        (own_s, own_noise, own_mean), (s, noise, mean) = results["fathom"], results["cycles"]
        if own_noise == 0 or noise == 0:
            print(f"| {model.stem} | not compared: an image without noise; means {own_mean:.4f}, {mean:.4f} |", flush=True)
            continue
        efficiency = s * noise / (own_s * own_noise)
        logarithms.append(math.log(efficiency))
        print(f"| {model.stem} | {own_s:.2f} s | {s:.2f} s | {s / own_s:.2f} | {noise / own_noise:.2f} | {efficiency:.2f} "
              f"| {own_mean:.4f}, {mean:.4f} |", flush=True)
    print(f"geometric mean of the efficiency: {math.exp(sum(logarithms) / len(logarithms)):.2f}")


if __name__ == "__main__":
    if sys.argv[1:2] == ["--cycles"]:
        render_with_cycles(*sys.argv[2:])
    else:
        main()
