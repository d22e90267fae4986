#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Large OBJ and PLY files for measurements of reading, from a PLY mesh of triangles (binary, little-endian; x y z,
uchar int).

    bench/make_obj.py MESH.ply FOLDER [COPIES]

Writes to FOLDER, with COPIES copies of the mesh (default 4) side by side:
    plain.obj      positions and triangles
    full.obj       with normals and texture coordinates, in 16 objects with two alternating materials
    quads.obj      consecutive triangles joined to quads where they share an edge
    plain.ply      as plain.obj, binary
    full.ply       with normals and texture coordinates, binary
"""
import array
import math
import struct
import sys
from pathlib import Path


def read(path):
    data = Path(path).read_bytes()
    end = data.index(b"end_header\n") + len(b"end_header\n")
    header = data[:end].decode().split("\n")
    if "format binary_little_endian 1.0" not in header:
        sys.exit(f"{path}: not a little-endian binary PLY")
    count = {line.split()[1]: int(line.split()[2]) for line in header if line.startswith("element")}
    positions = array.array("f", data[end:end + 12 * count["vertex"]])
    faces, at = [], end + 12 * count["vertex"]
    if len(data) != at + 13 * count["face"]:
        sys.exit(f"{path}: not of triangles alone")
    for (n, a, b, c) in struct.iter_unpack("<Biii", data[at:]):
        faces.append((a, b, c))
    return positions, faces


def attributes(positions):
    """A normal and texture coordinates for each vertex, with realistic digits but arbitrary values."""
    normals, uvs = [], []
    for i in range(0, len(positions), 3):
        x, y, z = positions[i:i + 3]
        length = math.sqrt(x * x + y * y + z * z) or 1
        normals.append((x / length, y / length, z / length))
        uvs.append((x / (abs(x) + 1), y / (abs(y) + 1)))
    return normals, uvs


def quads(faces):
    """Joins two consecutive triangles that share an edge to one polygon."""
    result, i = [], 0
    while i < len(faces):
        (a, b, c) = faces[i]
        following = faces[i + 1] if i + 1 < len(faces) else ()
        if a in following and c in following and len(set(following) - {a, b, c}) == 1 and b not in following:
            result.append((a, b, c, *(set(following) - {a, c})))
            i += 2
        else:
            result.append(faces[i])
            i += 1
    return result


def write_obj(path, positions, faces, copies, shift, more=None):
    vertices = len(positions) // 3
    with open(path, "w") as file:
        for copy in range(copies):
            dx = copy * shift
            base = 1 + copy * vertices
            file.writelines(f"v {positions[i] + dx:.6f} {positions[i + 1]:.6f} {positions[i + 2]:.6f}\n"
                            for i in range(0, len(positions), 3))
            if more is None:
                file.writelines("f " + " ".join(str(base + i) for i in face) + "\n" for face in faces)
                continue
            file.writelines(f"vt {u:.6f} {v:.6f}\n" for u, v in more[1])
            file.writelines(f"vn {x:.4f} {y:.4f} {z:.4f}\n" for x, y, z in more[0])
            step = len(faces) // 16 + 1
            for part in range(16):
                file.write(f"o part{copy}_{part}\nusemtl m{part % 2}\n")
                file.writelines("f " + " ".join(f"{base + i}/{base + i}/{base + i}" for i in face) + "\n"
                                for face in faces[part * step:(part + 1) * step])


def write_ply(path, positions, faces, copies, shift, more=None):
    vertices = len(positions) // 3
    names = ["x", "y", "z"] + (["nx", "ny", "nz", "u", "v"] if more else [])
    with open(path, "wb") as file:
        file.write((f"ply\nformat binary_little_endian 1.0\nelement vertex {vertices * copies}\n" +
                    "".join(f"property float {name}\n" for name in names) +
                    f"element face {len(faces) * copies}\nproperty list uchar int vertex_indices\nend_header\n").encode())
        for copy in range(copies):
            for i in range(vertices):
                row = [positions[3 * i] + copy * shift, positions[3 * i + 1], positions[3 * i + 2]]
                if more:
                    row += more[0][i] + more[1][i]
                file.write(struct.pack(f"<{len(row)}f", *row))
        for copy in range(copies):
            base = copy * vertices
            file.writelines(struct.pack("<Biii", 3, *(base + i for i in face)) for face in faces)


def main():
    if len(sys.argv) < 3:
        sys.exit(__doc__)
    positions, faces = read(sys.argv[1])
    folder = Path(sys.argv[2])
    folder.mkdir(parents=True, exist_ok=True)
    copies = int(sys.argv[3]) if len(sys.argv) > 3 else 4
    shift = max(positions[0::3]) - min(positions[0::3])
    more = attributes(positions)
    write_obj(folder / "plain.obj", positions, faces, copies, shift)
    write_obj(folder / "full.obj", positions, faces, copies, shift, more)
    write_obj(folder / "quads.obj", positions, quads(faces), copies, shift)
    write_ply(folder / "plain.ply", positions, faces, copies, shift)
    write_ply(folder / "full.ply", positions, faces, copies, shift, more)
    for name in ("plain.obj", "full.obj", "quads.obj", "plain.ply", "full.ply"):
        print(f"{name}: {(folder / name).stat().st_size / 1e6:.1f} MB")


if __name__ == "__main__":
    main()
