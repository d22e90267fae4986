# SPDX-License-Identifier: Apache-2.0
"""Writes measured BSDF files in the format of the RGL database: tabulated metals with GGX microfacets.

usage: measured_file.py FILE [--anisotropic] [--spectra]     a metal, to inspect or for other renderers

Dupuy and Jakob 2018, "An Adaptive Parameterization for Efficient Material Acquisition and Rendering". The tables are as
small as possible: a reader interpolates them, so it gets this interpolation rather than GGX.
"""
import bisect
import math
import struct
import sys

FLOAT32, UINT8 = 10, 1


def tensor_file(fields):
    """A file of named arrays: [(name, type, shape, bytes)]."""
    header = b"tensor_file\0" + bytes([1, 0]) + struct.pack("<I", len(fields))
    size = len(header) + sum(2 + len(name) + 2 + 1 + 8 + 8 * len(shape) for name, _, shape, _ in fields)
    data = b""
    for name, kind, shape, content in fields:
        header += struct.pack("<H", len(name)) + name.encode() + struct.pack("<HBQ", len(shape), kind, size + len(data))
        header += struct.pack(f"<{len(shape)}Q", *shape)
        data += content
    return header + data


class Warp:
    """Samples points of the unit square from a density that is bilinear between the values of a table."""

    def __init__(self, values, width, height):
        self.v, self.w, self.h = values, width, height
        self.rows = [sum((r[i] + r[i + 1]) / 2 for i in range(width - 1)) for r in self.row_list()]

    def row_list(self):
        return [self.v[j * self.w:(j + 1) * self.w] for j in range(self.h)]

    @staticmethod
    def invert(values, x):
        """Inverts the integral of a piecewise linear function at the fraction x; returns (index, offset in the
        interval)."""
        sums = [0.0]
        for a, b in zip(values, values[1:]):
            sums.append(sums[-1] + (a + b) / 2)
        x *= sums[-1]
        i = min(max(bisect.bisect_right(sums, x) - 1, 0), len(values) - 2)
        a, b, r = values[i], values[i + 1], x - sums[i]
        root = a + math.sqrt(max(a * a + 2 * r * (b - a), 0))
        return i, min(2 * r / root, 1) if root > 0 else 0.0

    def sample(self, x, y):
        j, t = self.invert(self.rows, y)
        a, b = self.v[j * self.w:(j + 1) * self.w], self.v[(j + 1) * self.w:(j + 2) * self.w]
        i, s = self.invert([(1 - t) * p + t * q for p, q in zip(a, b)], x)
        return (i + s) / (self.w - 1), (j + t) / (self.h - 1)


def direction(theta, phi):
    return (math.sin(theta) * math.cos(phi), math.sin(theta) * math.sin(phi), math.cos(theta))


def dot(a, b):
    return sum(x * y for x, y in zip(a, b))


class Metal:
    """GGX microfacets with Schlick's reflectance and roughness alpha along x and y."""

    def __init__(self, alpha_x, alpha_y):
        self.x, self.y = alpha_x, alpha_y

    def ndf(self, m):
        e = (m[0] / self.x) ** 2 + (m[1] / self.y) ** 2 + m[2] ** 2
        return 1 / (math.pi * self.x * self.y * e * e)

    def stretched(self, w):
        return math.sqrt((self.x * w[0]) ** 2 + (self.y * w[1]) ** 2 + w[2] ** 2)

    def sigma(self, w):
        return (w[2] + self.stretched(w)) / 2

    def shadowing(self, wi, wo):
        """G2 / G1: the fraction of the microfacets visible from wi that is visible from wo, height-correlated."""
        a, b = 1 / (2 * wi[2] / (wi[2] + self.stretched(wi))), (self.stretched(wo) / wo[2] - 1) / 2
        return a / (a + b)


def grid(width, height):
    return [(i / (width - 1), j / (height - 1)) for j in range(height) for i in range(width)]


def half_vector(u, turned):
    theta, phi = u[0] ** 2 * math.pi / 2, (2 * u[1] - 1) * math.pi
    return direction(theta, phi + turned)


def metal_file(metal, thetas, phis, size, side, colors, is_isotropic, wavelengths=None):
    """Makes a measured BSDF file.

    colors: reflectance at normal incidence per channel or wavelength. side: size of the reflectance tables, which
    Mitsuba requires to be square.
    """
    width, height = size
    flat = lambda values: struct.pack(f"<{len(values)}f", *values)
    theta_i = [t * math.pi / 180 for t in thetas]
    phi_i = [p * math.pi / 180 for p in phis]
    ndf = [metal.ndf(half_vector(u, 0)) for u in grid(width, height)]
    sigma = [metal.sigma(half_vector(u, 0)) for u in grid(width, height)]
    vndf, luminance, color = [], [], []
    for phi in phi_i:
        for theta in theta_i:
            wi = direction(theta, phi)
            table = []
            for u in grid(width, height):
                m = half_vector(u, phi if is_isotropic else 0)
                theta_m = u[0] ** 2 * math.pi / 2
                table.append(max(dot(wi, m), 0) * metal.ndf(m) * u[0] * math.sin(theta_m))
            vndf += table
            warp = Warp(table, width, height)
            channels = [[] for _ in colors]
            for s in grid(side, side):
                m = half_vector(warp.sample(*s), phi if is_isotropic else 0)
                cosine = dot(wi, m)
                wo = tuple(2 * cosine * a - b for a, b in zip(m, wi))
                g = metal.shadowing(wi, wo) if wo[2] > 1e-6 and cosine > 0 else 0
                schlick = (1 - min(max(cosine, 0), 1)) ** 5
                for channel, f0 in zip(channels, colors):
                    channel.append(g * (f0 + (1 - f0) * schlick))
            luminance += [sum(c) / len(colors) for c in zip(*channels)]
            color += [x for channel in channels for x in channel]
    n, shape = len(colors), (len(phi_i), len(theta_i))
    fields = [("description", UINT8, (5,), b"metal"), ("phi_i", FLOAT32, (len(phi_i),), flat(phi_i)),
              ("theta_i", FLOAT32, (len(theta_i),), flat(theta_i)),
              ("sigma", FLOAT32, (height, width), flat(sigma)), ("ndf", FLOAT32, (height, width), flat(ndf)),
              ("vndf", FLOAT32, shape + (height, width), flat(vndf)),
              ("spectra" if wavelengths else "rgb", FLOAT32, shape + (n, side, side), flat(color)),
              ("luminance", FLOAT32, shape + (side, side), flat(luminance)), ("jacobian", UINT8, (1,), b"\1")]
    if wavelengths:
        fields.append(("wavelengths", FLOAT32, (n,), flat(wavelengths)))
    return tensor_file(fields)


def gold(spectra=False, size=(16, 8), side=12, alpha=0.3):
    """An isotropic metal."""
    waves = [360 + 40 * i for i in range(16)] if spectra else None
    colors = [0.95 / (1 + math.exp((520 - w) / 30)) for w in waves] if spectra else [0.95, 0.6, 0.25]
    return metal_file(Metal(alpha, alpha), [0, 25, 45, 65, 80, 89], [-180], size, side, colors, True, waves)


def brushed(spectra=False, size=(8, 16), side=10, alphas=(0.5, 0.15), phis=(-180, -135, -90)):
    """An anisotropic metal, wide along x and narrow along y. It has a quarter of the azimuths; the others follow by
    symmetry."""
    waves = [400 + 50 * i for i in range(8)] if spectra else None
    colors = [0.9] * len(waves) if spectra else [0.9, 0.85, 0.8]
    return metal_file(Metal(*alphas), [0, 30, 60, 85], phis, size, side, colors, False, waves)


if __name__ == "__main__":
    make = brushed if "--anisotropic" in sys.argv else gold
    with open(sys.argv[1], "wb") as file:
        file.write(make("--spectra" in sys.argv))
