# SPDX-License-Identifier: Apache-2.0
"""Meshes that the scenes are made of: positions, triangles and, for smooth ones, normals."""
import numpy as np


def unit(vectors):
    return vectors / np.linalg.norm(vectors, axis=-1, keepdims=True)


def mesh(positions, triangles, normals=None):
    return {"positions": np.asarray(positions, np.float32), "triangles": np.asarray(triangles, np.int32),
            "normals": None if normals is None else np.asarray(normals, np.float32)}


def merged(parts):
    """One mesh of several, all of which have normals or none has."""
    starts = np.cumsum([0] + [len(part["positions"]) for part in parts])
    normals = None if parts[0]["normals"] is None else np.vstack([part["normals"] for part in parts])
    return mesh(np.vstack([part["positions"] for part in parts]),
                np.vstack([part["triangles"] + start for part, start in zip(parts, starts)]), normals)


def grid_triangles(rows, columns, wrap=False):
    """Triangles of a grid of vertices in row-major order; with wrap, the last column meets the first."""
    row, column = np.meshgrid(np.arange(rows - 1), np.arange(columns if wrap else columns - 1), indexing="ij")
    a, b = row * columns + column, row * columns + (column + 1) % columns
    c, d = a + columns, b + columns
    return np.stack([np.stack([a, c, b], -1), np.stack([b, c, d], -1)], -2).reshape(-1, 3)


def ball(center, radius, segments=192):
    return revolved(*circle_profile(radius, segments // 2), center, segments)


def circle_profile(radius, steps):
    """Points (distance to the axis, height) and normals of a half circle, from the bottom to the top."""
    angle = np.linspace(-np.pi / 2, np.pi / 2, steps + 1)
    normals = np.stack([np.cos(angle), np.sin(angle)], -1)
    normals[[0, -1], 0] = 0
    return radius * normals, normals


def revolved(profile, normals, center=(0, 0, 0), segments=128):
    """The solid of revolution of a profile about the y axis. Profiles run so that their outside is at their right: for
    points on the axis, half of the triangles have no area and are left out."""
    phi = np.arange(segments) * 2 * np.pi / segments
    turn = lambda points: np.stack([np.multiply.outer(points[:, 0], np.cos(phi)),
                                    np.broadcast_to(points[:, 1, None], (len(points), segments)),
                                    np.multiply.outer(points[:, 0], -np.sin(phi))], -1).reshape(-1, 3)
    positions = turn(np.asarray(profile, float))
    triangles = grid_triangles(len(profile), segments, wrap=True)[:, ::-1]
    a, b, c = (positions[triangles[:, i]] for i in range(3))
    area = np.linalg.norm(np.cross(b - a, c - a), axis=-1)
    return mesh(positions + np.array(center), triangles[area > 1e-12], turn(np.asarray(normals, float)))


def smooth_profile(points, steps):
    """A Catmull-Rom curve through points of a profile, and its normals, which point to its right."""
    points = np.asarray(points, float)
    padded = np.vstack([2 * points[0] - points[1], points, 2 * points[-1] - points[-2]])
    t = np.linspace(0, 1, steps, endpoint=False)[:, None]
    parts = []
    for p0, p1, p2, p3 in zip(padded, padded[1:], padded[2:], padded[3:]):
        parts.append(0.5 * (2 * p1 + (p2 - p0) * t + (2 * p0 - 5 * p1 + 4 * p2 - p3) * t**2 + (3 * p1 - p0 - 3 * p2 + p3) * t**3))
    curve = np.vstack([*parts, points[-1:]])
    curve[:, 0] = np.maximum(curve[:, 0], 0)
    tangent = unit(np.gradient(curve, axis=0))
    return curve, np.stack([tangent[:, 1], -tangent[:, 0]], -1)


def height_field(x, z, height, gradient):
    """A surface y = height(x, z) over a grid, with normals that point up."""
    columns, rows = np.meshgrid(x, z)
    dx, dz = gradient(columns, rows)
    normals = unit(np.stack([-dx, np.ones_like(dx), -dz], -1))
    positions = np.stack([columns, height(columns, rows), rows], -1)
    return mesh(positions.reshape(-1, 3), grid_triangles(len(z), len(x)), normals.reshape(-1, 3))


def quads(corners):
    """A mesh of separate quads; corners: N x 4 x 3."""
    first = 4 * np.arange(len(corners))[:, None]
    return mesh(corners.reshape(-1, 3), np.vstack([first + [0, 1, 2], first + [0, 2, 3]]))
