# SPDX-License-Identifier: Apache-2.0
"""Small files with the names that documents use in their examples: model.glb, scene.json, scene.pbrt and others."""
import json
import struct

SCENE = {
    "fathom": 1,
    "render": {"size": [16, 12]},
    "camera": {"position": [0, 1, 4], "look_at": [0, 0, 0]},
    "environment": {"kind": "constant"},
    "materials": {"red": {"kind": "diffuse", "color": [0.8, 0.1, 0.1]}},
    "scene": [{"material": "red", "sphere": {"center": [0, 0, 0], "radius": 1}}],
}


def animated_glb():
    """A GLB with a triangle that moves for 5 seconds."""
    positions = struct.pack("<9f", 0, 0, 0, 1, 0, 0, 0, 1, 0)
    times, moves = struct.pack("<2f", 0, 5), struct.pack("<6f", 0, 0, 0, 0, 1, 0)
    data = positions + times + moves
    views = [{"buffer": 0, "byteOffset": offset, "byteLength": length} for offset, length in ((0, 36), (36, 8), (44, 24))]
    accessors = [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3", "min": [0, 0, 0], "max": [1, 1, 0]},
                 {"bufferView": 1, "componentType": 5126, "count": 2, "type": "SCALAR", "min": [0], "max": [5]},
                 {"bufferView": 2, "componentType": 5126, "count": 2, "type": "VEC3"}]
    animation = {"samplers": [{"input": 1, "output": 2}], "channels": [{"sampler": 0, "target": {"node": 0, "path": "translation"}}]}
    text = json.dumps({"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
                       "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}], "animations": [animation],
                       "accessors": accessors, "bufferViews": views, "buffers": [{"byteLength": len(data)}]}).encode()
    text += b" " * (-len(text) % 4)
    chunks = struct.pack("<I4s", len(text), b"JSON") + text + struct.pack("<I4s", len(data), b"BIN\0") + data
    return struct.pack("<4sII", b"glTF", 2, 12 + len(chunks)) + chunks


def write_example_files(folder, root):
    """Writes the files; the folder `scenes` is a link to that of the project, whose folder is `root`."""
    (folder / "model.glb").write_bytes(animated_glb())
    (folder / "scene.json").write_text(json.dumps(SCENE))
    (folder / "scene.pbrt").write_text('LookAt 0 1 4  0 0 0  0 1 0\nCamera "perspective"\nWorldBegin\nLightSource "infinite"\n'
                                       'Shape "sphere"\n')
    (folder / "model.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
    shapes = "".join(f'<shape type="obj"><string name="filename" value="{name}.obj"/></shape>' for name in "ab")
    (folder / "scene.xml").write_text(f'<scene version="3.0.0"><sensor type="perspective"/><emitter type="constant"/>{shapes}</scene>')
    # Half of the triangles of both files are degenerate.
    for name in "ab":
        (folder / f"{name}.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nf 1 2 2\n")
    (folder / "scene.glb").write_bytes(animated_glb())
    (folder / "models").mkdir()
    (folder / "models/model.glb").write_bytes(animated_glb())
    # Machines of mpirun.
    (folder / "hosts").write_text("localhost slots=8\n")
    # A Radiance file of 2x2 pixels, of which all are gray.
    (folder / "sky.hdr").write_bytes(b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 2 +X 2\n" + bytes([128, 128, 128, 129]) * 4)
    (folder / "scenes").symlink_to(root / "scenes")
