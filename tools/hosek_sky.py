#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Writes src/lights/sky/hosek_sky_table.h: coefficients of the sky of L. Hosek and A. Wilkie 2012, "An Analytic Model
for Full Spectral Sky-Dome Radiance", by turbidity, ground albedo and channel, as polynomials of the sun's elevation.

usage: python3 tools/hosek_sky.py      needs Mitsuba 3 and numpy; takes some minutes

Fits the paper's formula to the radiance of Mitsuba's `sunsky` in many directions (Levenberg-Marquardt). Tables are
fitted together with those that they are blended with: interpolation of coefficients between turbidities and albedos
determines the common factors.
"""
import math

import mitsuba
import numpy as np

mitsuba.set_variant("llvm_ad_rgb")

TURBIDITIES, ALBEDOS = range(1, 11), (0, 1)
ELEVATIONS = (2.5, 5, 9, 15, 23, 33, 45, 58, 72, 86)  # elevations in degrees
STEPS = 11  # directions, from zenith to horizon, and around from the sun to its opposite
# Rows: A to I of the formula, and the mean radiance. Columns: six Bernstein coefficients.
START = """
-1.14 -1.12 -1.18 -1.04 -1.06 -1.07
-0.156 -0.163 -0.276 0.0239 -0.192 -0.219
0.04 -0.879 1.74 -1.15 1.05 0.424
0.988 -0.253 0.0947 0.247 -1.45 4.15
4.25 -3.87 2.14 -0.688 -3.15 -5.08
0.452 -0.263 0.974 -0.47 1.06 -0.111
0.0699 0.0276 -0.0412 0.237 -0.0573 0.0731
0.639 0.505 1.02 0.284 1 0.564
0.73 1.89 -1.9 3.03 -0.899 0.138
-0.13 0.248 0.034 0.469 0.109 0.196
"""


def directions():
    theta, phi = np.meshgrid(np.linspace(0, math.pi / 2 - 1e-3, STEPS), np.linspace(0, math.pi, STEPS), indexing="ij")
    return np.stack([np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi), np.cos(theta)], -1).reshape(-1, 3)


DIRECTIONS = directions()


def sun(elevation):
    return np.array([math.cos(math.radians(elevation)), 0, math.sin(math.radians(elevation))])


def shown(turbidity, albedo):
    """Mitsuba's radiance for all elevations and directions."""
    rows = []
    for elevation in ELEVATIONS:
        scene = mitsuba.load_dict({"type": "scene", "ball": {"type": "sphere"}, "sky": {
            "type": "sunsky", "turbidity": float(turbidity), "albedo": float(albedo), "sun_scale": 0.0,
            "sun_direction": [float(x) for x in sun(elevation)]}})
        seen = mitsuba.SurfaceInteraction3f()
        seen.wi = mitsuba.Vector3f(*[mitsuba.Float(-DIRECTIONS[:, k]) for k in range(3)])
        radiance = np.array(scene.environment().eval(seen))
        rows.append(radiance.T if radiance.shape[0] == 3 else radiance)
    return np.concatenate(rows).astype(float)


BERNSTEIN = np.array([[math.comb(5, j) * x**j * (1 - x)**(5 - j) for j in range(6)]
                      for x in [(e / 90)**(1 / 3) for e in ELEVATIONS]])
PLACE = np.repeat(np.arange(len(ELEVATIONS)), len(DIRECTIONS))
UP = np.tile(DIRECTIONS[:, 2], len(ELEVATIONS))
COSINE = np.clip(np.concatenate([DIRECTIONS @ sun(e) for e in ELEVATIONS]), -1, 1)
GAMMA = np.arccos(COSINE)


def formula(k):
    """Equation 8 of the paper, for coefficients per position and direction."""
    h = np.clip(k[7], -3, 0.999)
    glow = (1 + COSINE**2) / (1 + h * h - 2 * h * COSINE)**1.5
    return (1 + k[0] * np.exp(k[1] / (UP + 0.01))) * (k[2] + k[3] * np.exp(k[4] * GAMMA) + k[5] * COSINE**2 + k[6] * glow +
                                                      k[8] * np.sqrt(UP)) * k[9]


def fit(table, terms, steps):
    """Fits a table of 10 x 6 coefficients. terms: (the table that it is averaged with, or None; the target radiance).
    Returns the improved table and its error."""
    def coefficients(x, other):
        k = x @ BERNSTEIN.T
        return (k if other is None else (k + other @ BERNSTEIN.T) / 2)[:, PLACE]

    def errors(x):
        return np.concatenate([formula(coefficients(x, other)) / y - 1 for other, y in terms])

    def derivatives(x):
        blocks = []
        for other, y in terms:
            k = coefficients(x, other)
            here = formula(k)
            columns = []
            for i in range(10):
                d = 1e-6 * np.maximum(np.abs(k[i]), 1e-2)
                moved = k.copy()
                moved[i] += d
                columns.append((formula(moved) - here) / (d * y) * (1 if other is None else 0.5))
            blocks.append(np.concatenate([c[:, None] * BERNSTEIN[PLACE] for c in columns], 1))
        return np.concatenate(blocks)

    e = errors(table)
    cost, damping = e @ e, 1e-3
    for _ in range(steps):
        j = derivatives(table)
        a, b = j.T @ j, j.T @ e
        scale = np.diag(a) + 1e-9 * np.trace(a) / len(a)
        for _ in range(10):
            moved = table - np.linalg.solve(a + damping * np.diag(scale), b).reshape(10, 6)
            with np.errstate(all="ignore"):
                e_moved = errors(moved)
                cost_moved = e_moved @ e_moved
            if np.isfinite(cost_moved) and cost_moved < cost:
                break
            damping *= 5
        else:
            break
        is_small = cost - cost_moved < 1e-5 * cost
        table, e, cost, damping = moved, e_moved, cost_moved, max(damping / 5, 1e-13)
        if is_small:
            break
    return table, math.sqrt(cost / len(e))


def fit_all():
    data = {(t, a): shown(t, a) for t in TURBIDITIES for a in (0, 0.5, 1)}
    data |= {(t + 0.5, a): shown(t + 0.5, a) for t in TURBIDITIES[:-1] for a in ALBEDOS}
    start = np.array([[float(x) for x in line.split()] for line in START.strip().splitlines()])
    tables = {}
    for c in range(3):
        for a in ALBEDOS:
            # Starts in the middle; each table starts from its neighbor's result.
            for t in [3, 4, 5, 6, 7, 8, 9, 10, 2, 1]:
                near = [tables[key] for key in [(t - 1, a, c), (t + 1, a, c), (t, 0, c), (t, a, c - 1)] if key in tables]
                fits = [fit(x, [(None, data[t, a][:, c])], 200) for x in near + [start]]
                tables[t, a, c], error = min(fits, key=lambda f: f[1])
    worst = 0
    for sweep in range(12):
        worst = 0
        for c in range(3):
            for t in TURBIDITIES if sweep % 2 == 0 else reversed(TURBIDITIES):
                for a in ALBEDOS:
                    terms = [(None, data[t, a]), (tables[t, 1 - a, c], data[t, 0.5])]
                    terms += [(tables[n, a, c], data[(t + n) / 2, a]) for n in (t - 1, t + 1) if (n, a, c) in tables]
                    tables[t, a, c], error = fit(tables[t, a, c], [(x, y[:, c]) for x, y in terms], 12)
                    worst = max(worst, error)
        print(f"sweep {sweep}: {100 * worst:.2f} % at worst (root of the mean square of a table)", flush=True)
    return tables


def write(tables):
    rows = []
    for t in TURBIDITIES:
        for a in ALBEDOS:
            for c in range(3):
                rows += ["{" + ", ".join(f"{x:.6g}f" if "." in f"{x:.6g}" or "e" in f"{x:.6g}" else f"{x:.6g}.0f" for x in row) + "}"
                         for row in tables[t, a, c]]
    group = lambda items, n: ["{" + ",\n".join(items[i:i + n]) + "}" for i in range(0, len(items), n)]
    with open("src/lights/sky/hosek_sky_table.h", "w") as file:
        file.write("#pragma once\n\nnamespace fathom {\n\n"
                   "/// Generated by tools/hosek_sky.py. Indices: turbidity from 1, ground albedo 0 and 1, channel (red, green, blue),\n"
                   "/// coefficient; six Bernstein coefficients each. clang-format does not reformat it.\n// clang-format off\n"
                   "inline constexpr float hosek_sky_table[10][2][3][10][6] = " + group(group(group(group(rows, 10), 3), 2), 10)[0] + ";\n"
                   "// clang-format on\n\n}  // namespace fathom\n")


if __name__ == "__main__":
    write(fit_all())
