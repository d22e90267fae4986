#!/usr/bin/env python3
"""Writes the directional albedos of GGX facets in one scattering event, as means of G2 / G1 over visible normals (Heitz 2018)
with the height-correlated Smith term:
  src/materials/microfacet/ggx_albedo_table.h         of perfect mirrors, by cosine and roughness; and the same weighted by Schlick's
                                         (1 - cos)^5, from which the albedo for any reflectance at normal incidence follows
  src/materials/microfacet/dielectric_albedo_table.h  of a dielectric boundary, reflection and refraction together, by cosine, roughness
                                         and relative index of refraction"""
import numpy as np

SIZE = 32
STRATA = 192
DIELECTRIC_SIZE = 16  # of cosines and roughnesses
DIELECTRIC_INDICES = 24
DIELECTRIC_MAX_INDEX_AXIS = 0.85  # an index of 6.2
DIELECTRIC_STRATA = 96


def visible_normals(wo, alpha, u1, u2):
    """Dupuy and Benyoub 2023, 'Sampling Visible GGX Normals with Spherical Caps'."""
    h = np.array([alpha * wo[0], alpha * wo[1], wo[2]])
    h /= np.linalg.norm(h)
    phi = 2 * np.pi * u1
    z = (1 - u2) * (1 + h[2]) - h[2]
    s = np.sqrt(np.clip(1 - z * z, 0, 1))
    c = np.stack([s * np.cos(phi), s * np.sin(phi), z], -1) + h
    n = np.stack([c[..., 0] * alpha, c[..., 1] * alpha, np.maximum(c[..., 2], 0)], -1)
    return n / np.linalg.norm(n, axis=-1, keepdims=True)


def smith_lambda(cosine, alpha):
    c2 = np.clip(cosine * cosine, 1e-12, 1)
    return (np.sqrt(1 + alpha * alpha * (1 - c2) / c2) - 1) / 2


def albedo(cosine, alpha):
    wo = np.array([np.sqrt(max(0, 1 - cosine * cosine)), 0, cosine])
    u = (np.arange(STRATA) + 0.5) / STRATA
    u1, u2 = np.meshgrid(u, u)
    n = visible_normals(wo, alpha, u1, u2)
    wi = 2 * (n @ wo)[..., None] * n - wo
    lo, li = smith_lambda(cosine, alpha), smith_lambda(wi[..., 2], alpha)
    g = np.where(wi[..., 2] > 0, (1 + lo) / (1 + lo + li), 0)
    return float(g.mean()), float((g * np.clip(1 - n @ wo, 0, 1) ** 5).mean())


def fresnel(cosine, eta):
    """Reflectance of a dielectric boundary (Born and Wolf, Principles of Optics, 1.5.2) and the cosine beyond it."""
    sine2 = (1 - cosine * cosine) / (eta * eta)
    cos_t = np.sqrt(np.clip(1 - sine2, 0, 1))
    p, s = (eta * cosine - cos_t) / (eta * cosine + cos_t), (cosine - eta * cos_t) / (cosine + eta * cos_t)
    return np.where(sine2 >= 1, 1, (p * p + s * s) / 2), cos_t


def dielectric_albedo(cosine, alpha, eta):
    wo = np.array([np.sqrt(max(0, 1 - cosine * cosine)), 0, cosine])
    u = (np.arange(DIELECTRIC_STRATA) + 0.5) / DIELECTRIC_STRATA
    u1, u2 = np.meshgrid(u, u)
    n = visible_normals(wo, alpha, u1, u2)
    o = np.clip(n @ wo, 0, 1)
    reflectance, cos_t = fresnel(o, eta)

    def shadowing(wi_z):
        lo, li = smith_lambda(cosine, alpha), smith_lambda(wi_z, alpha)
        return (1 + lo) / (1 + lo + li)

    reflected, refracted = 2 * o * n[..., 2] - wo[2], (o / eta - cos_t) * n[..., 2] - wo[2] / eta
    kept = np.where(reflected > 0, reflectance * shadowing(reflected), 0)
    kept += np.where(refracted < 0, (1 - reflectance) * shadowing(refracted), 0)
    return float(kept.mean())


def index_of_axis(t):
    """The axis is the signed root of (eta - 1) / (eta + 1): the albedo changes fastest where eta is near 1."""
    z = np.sign(t) * t * t
    eta = (1 + z) / (1 - z)
    return eta if abs(eta - 1) > 5e-4 else 1 + 5e-4


def table(name, size, values):
    lines = ["    " + ", ".join(f"{v:.5f}f" for v in row) + "," for row in values]
    return f"inline constexpr float {name}[{size}] = {{\n" + "\n".join(lines) + "\n};\n"


HEADER = "#pragma once\n// A row of the table is a line here.\n// clang-format off\n\nnamespace fathom {\n\n"


def write_dielectric_table():
    n = DIELECTRIC_SIZE
    rows = [[dielectric_albedo(max(i / (n - 1), 0.004), max(j / (n - 1), 0.02) ** 2, index_of_axis(t)) for i in range(n)]
            for t in np.linspace(-DIELECTRIC_MAX_INDEX_AXIS, DIELECTRIC_MAX_INDEX_AXIS, DIELECTRIC_INDICES) for j in range(n)]
    with open("src/materials/microfacet/dielectric_albedo_table.h", "w") as file:
        file.write(HEADER + "/// Made by tools/ggx_albedo.py: blocks by index axis, rows by roughness (root of alpha) 0 to 1, columns by\n"
                   "/// cosine 0 to 1. The index axis is the signed root of (eta - 1) / (eta + 1), from -max to max.\n"
                   f"inline constexpr int dielectric_albedo_size = {n}, dielectric_albedo_indices = {DIELECTRIC_INDICES};\n"
                   f"inline constexpr float dielectric_albedo_max_axis = {DIELECTRIC_MAX_INDEX_AXIS}f;\n"
                   "/// Share of light that a rough dielectric boundary reflects or refracts in one scattering event.\n"
                   + table("dielectric_albedo_table", "dielectric_albedo_indices * dielectric_albedo_size * dielectric_albedo_size",
                           rows)
                   + "\n}  // namespace fathom\n")


def write_mirror_tables():
    pairs = [[albedo(max(i / (SIZE - 1), 0.004), max(j / (SIZE - 1), 0.02) ** 2) for i in range(SIZE)] for j in range(SIZE)]
    with open("src/materials/microfacet/ggx_albedo_table.h", "w") as file:
        file.write(HEADER + "/// Made by tools/ggx_albedo.py: rows by roughness (alpha's root) 0 to 1, columns by cosine 0 to 1.\n"
                   f"inline constexpr int ggx_albedo_size = {SIZE};\n"
                   "/// The share that perfectly reflecting facets give back in one bounce.\n"
                   + table("ggx_albedo_table", "ggx_albedo_size * ggx_albedo_size", [[p[0] for p in row] for row in pairs])
                   + "/// The same weighted by Schlick's (1 - cos)^5.\n"
                   + table("ggx_schlick_table", "ggx_albedo_size * ggx_albedo_size", [[p[1] for p in row] for row in pairs])
                   + "\n}  // namespace fathom\n")


if __name__ == "__main__":
    write_mirror_tables()
    write_dielectric_table()
