#!/usr/bin/env python3
"""Writes src/shading/ggx_albedo_table.h: the share of light that a GGX mirror reflects in one bounce, by cosine and
roughness. It is the mean of G2 / G1 over visible normals (Heitz 2018), with the height-correlated Smith term; and the same
weighted by Schlick's (1 - cos)^5, from which the albedo for any reflectance at normal incidence follows."""
import numpy as np

SIZE = 32
STRATA = 192


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


def table(name, values):
    lines = ["    " + ", ".join(f"{v:.5f}f" for v in row) + "," for row in values]
    return f"inline constexpr float {name}[ggx_albedo_size * ggx_albedo_size] = {{\n" + "\n".join(lines) + "\n};\n"


def main():
    pairs = [[albedo(max(i / (SIZE - 1), 0.004), max(j / (SIZE - 1), 0.02) ** 2) for i in range(SIZE)] for j in range(SIZE)]
    with open("src/shading/ggx_albedo_table.h", "w") as file:
        file.write("#pragma once\n// A row of the table is a line here.\n// clang-format off\n\nnamespace fathom {\n\n"
                   "/// Made by tools/ggx_albedo.py: rows by roughness (alpha's root) 0 to 1, columns by cosine 0 to 1.\n"
                   f"inline constexpr int ggx_albedo_size = {SIZE};\n"
                   "/// The share that perfectly reflecting facets give back in one bounce.\n"
                   + table("ggx_albedo_table", [[p[0] for p in row] for row in pairs])
                   + "/// The same weighted by Schlick's (1 - cos)^5.\n"
                   + table("ggx_schlick_table", [[p[1] for p in row] for row in pairs])
                   + "\n}  // namespace fathom\n")


if __name__ == "__main__":
    main()
