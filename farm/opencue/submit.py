#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Submits the parts of an image and their merge to OpenCue: docs/farm/opencue.md.

    farm/opencue/submit.py SCENE FOLDER [--parts N] [--spp N] [--picture NAME] [--program FATHOM] [--show SHOW] [--shot SHOT]
                           [--memory GB] [--print]

All hosts must see SCENE and FOLDER. --print prints the job and submits nothing; otherwise OpenCue's Python package
(opencue-pycue) must be installed.
"""
import argparse
import getpass
import os
import re
import shlex
import sys
import xml.etree.ElementTree as xml

DOCTYPE = '<?xml version="1.0"?>\n<!DOCTYPE spec PUBLIC "SPI Cue  Specification Language" "http://localhost:8080/spcue/dtd/cjsl-1.15.dtd">\n'


def commands(options):
    """Commands of the layer that renders, with a frame for each part, and of the layer that merges. #IFRAME# is the
    frame's number."""
    folder = os.path.abspath(options.folder)
    render = [options.program, "render", os.path.abspath(options.scene), "--spp", str(options.spp), "--part", f"#IFRAME#/{options.parts}",
              "--checkpoint", os.path.join(folder, "part-#IFRAME#.exr")]
    merge = [options.program, "merge", *(os.path.join(folder, f"part-{part}.exr") for part in range(1, options.parts + 1)),
             "-o", os.path.join(folder, options.picture)]
    # Hosts pass a command to a shell, which must not quote the placeholder of the frame's number.
    return [" ".join(shlex.quote(word) if re.search(r"[^\w#./=+:,@%-]", word) else word for word in words) for words in (render, merge)]


def add(parent, tag, text=None, /, **attributes):
    element = xml.SubElement(parent, tag, attributes)
    element.text = None if text is None else str(text)
    return element


def add_layer(layers, name, command, frames, options):
    layer = add(layers, "layer", name=name, type="Render")
    add(layer, "cmd", command)
    add(layer, "range", frames)
    add(layer, "chunk", 1)
    add(layer, "memory", f"{options.memory}g")
    add(layer, "env")
    add(add(layer, "services"), "service", "shell")


def job_name(scene):
    """Converts the scene's name to a valid job name of OpenCue: letters, digits and underscores."""
    return "fathom-" + re.sub(r"[^A-Za-z0-9_-]", "_", os.path.splitext(os.path.basename(scene))[0])


def job_text(options):
    spec = xml.Element("spec")
    for name, text in (("facility", "local"), ("show", options.show), ("shot", options.shot), ("user", getpass.getuser()), ("uid", os.getuid())):
        add(spec, name, text)
    name = job_name(options.scene)
    job = add(spec, "job", name=name)
    # A retried frame continues from its checkpoint.
    for key, text in (("paused", "False"), ("priority", 1), ("maxretries", 3), ("autoeat", "False")):
        add(job, key, text)
    add(job, "env")
    layers = add(job, "layers")
    render, merge = commands(options)
    add_layer(layers, "render", render, f"1-{options.parts}", options)
    add_layer(layers, "merge", merge, "1", options)
    depend = add(add(spec, "depends"), "depend", type="LAYER_ON_LAYER", anyframe="False")
    for key, text in (("depjob", name), ("deplayer", "merge"), ("onjob", name), ("onlayer", "render")):
        add(depend, key, text)
    xml.indent(spec)
    return DOCTYPE + xml.tostring(spec, encoding="unicode") + "\n"


def main():
    parser = argparse.ArgumentParser(usage=__doc__.split("\n\n")[1].strip())
    parser.add_argument("scene")
    parser.add_argument("folder")
    parser.add_argument("--parts", type=int, default=16)
    parser.add_argument("--spp", type=int, default=1024)
    parser.add_argument("--picture", default="picture.exr")
    parser.add_argument("--program", default="fathom")
    parser.add_argument("--show", default="testing")
    parser.add_argument("--shot", default="default")
    parser.add_argument("--memory", type=int, default=4)
    parser.add_argument("--print", action="store_true", dest="only_print")
    options = parser.parse_args()
    text = job_text(options)
    if options.only_print:
        print(text, end="")
        return 0
    import opencue
    for job in opencue.api.launchSpecAndWait(text):
        print(job.name())
    return 0


if __name__ == "__main__":
    sys.exit(main())
