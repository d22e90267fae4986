# SPDX-License-Identifier: Apache-2.0
"""Renders with Mitsuba 3, `llvm_ad_rgb`: mitsuba.py FOLDER_OR_XML INTEGRATOR THREADS WIDTH HEIGHT."""
import glob
import os
import sys
from pathlib import Path

sys.path[0] = str(Path(__file__).resolve().parents[1])
from runners import serve

LARGEST_PASS = 2**23  # samples: LLVM variants keep all samples of a pass in memory


def variant(threads):
    if "DRJIT_LIBLLVM_PATH" not in os.environ:
        found = sorted(glob.glob("/usr/lib/*/libLLVM.so.*") + glob.glob("/usr/lib/*/libLLVM-1[6-9].so*"))
        if found:
            os.environ["DRJIT_LIBLLVM_PATH"] = found[-1]
    import drjit
    import mitsuba as mi
    mi.set_variant("llvm_ad_rgb")
    # Mitsuba 3.9.1 hangs when it reads OpenEXR files with one thread.
    drjit.set_thread_count(max(2, threads))
    return mi, drjit


def load_file(mi, path, width, height):
    """A Mitsuba scene as it is, except for size and filter."""
    mi.file_resolver().append(str(path.parent))
    config = mi.parser.ParserConfig(mi.variant())
    config.unused_properties = config.unused_parameters = mi.LogLevel.Warn
    state = mi.parser.parse_file(config, str(path))
    for node in state.nodes:
        kind = node.props.plugin_name()
        if kind == "hdrfilm":
            node.props["width"], node.props["height"] = width, height
        if kind in ("gaussian", "tent", "mitchell", "catmullrom", "lanczos"):
            for key in node.props.keys():
                node.props.remove_property(key)
            node.props.set_plugin_name("box")
    mi.parser.transform_all(config, state)
    made = mi.parser.instantiate(config, state)
    return made[0] if isinstance(made, list) else made


def load(mi, source, integrator, width, height):
    if source.suffix == ".xml":
        return load_file(mi, source, width, height)
    import neutral
    from exporters import mitsuba
    return mi.load_dict(mitsuba.build(mi, neutral.load(source), source, integrator))


def main(source, integrator, threads, width, height):
    stream = serve.answers()
    mi, drjit = variant(int(threads))
    import numpy as np
    scene = load(mi, Path(source), integrator, int(width), int(height))
    drjit.set_thread_count(int(threads))
    step = max(1, LARGEST_PASS // (int(width) * int(height)))
    compiled = set()

    def compile_passes(spp):
        """The kernels of `ptracer` depend on the number of samples: a first pass of each number is not timed."""
        for count in {min(step, spp), spp % step} - {0} - compiled if integrator == "ptracer" else ():
            np.array(mi.render(scene, spp=count, seed=998))
            compiled.add(count)

    def render(spp, seed):
        total, done = 0, 0
        while done < spp:
            count = min(step, spp - done)
            total = total + count * np.array(mi.render(scene, spp=count, seed=(seed * 100003 + done) % 2**32))[..., :3].astype(np.float64)
            done += count
        return total / spp

    render(1, 999)

    def timed(spp, seed):
        compile_passes(spp)
        return serve.timed(lambda: render(spp, seed))

    serve.serve(stream, timed)


main(*sys.argv[1:])
