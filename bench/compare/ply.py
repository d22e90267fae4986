# SPDX-License-Identifier: Apache-2.0
"""Writes triangle meshes as binary PLY."""
import numpy as np


def write(path, positions, triangles, normals=None):
    columns = [positions] if normals is None else [positions, normals]
    vertices = np.hstack(columns).astype("<f4")
    names = ["x", "y", "z", "nx", "ny", "nz"][:vertices.shape[1]]
    faces = np.zeros(len(triangles), [("count", "u1"), ("indices", "<i4", 3)])
    faces["count"], faces["indices"] = 3, triangles
    header = ["ply", "format binary_little_endian 1.0", f"element vertex {len(vertices)}", *(f"property float {name}" for name in names),
              f"element face {len(faces)}", "property list uchar int vertex_indices", "end_header"]
    path.write_bytes(("\n".join(header) + "\n").encode() + vertices.tobytes() + faces.tobytes())
