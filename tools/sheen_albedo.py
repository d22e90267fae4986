#!/usr/bin/env python3
"""Writes src/materials/lobes/sheen_albedo_table.h: the share of light that a white sheen lobe reflects, by cosine and roughness: the
distribution of Estevez and Kulla 2017 ("Charlie"), with the visibility term of Ashikhmin and Premoze 2007."""
import numpy as np

SIZE = 32
COSINES, ANGLES = 400, 256


def albedo(cosine, roughness):
    # Cosines dense at grazing angles, where the lobe is.
    x = (np.arange(COSINES) + 0.5) / COSINES
    cos_i, dcos = (x * x)[:, None], (2 * x / COSINES)[:, None]
    phi = ((np.arange(ANGLES) + 0.5) / ANGLES * np.pi)[None, :]
    sin_i, sin_o = np.sqrt(1 - cos_i * cos_i), np.sqrt(1 - cosine * cosine)
    # The squared cosine of the half vector, from which its sine follows.
    i_dot_o = cos_i * cosine + sin_i * sin_o * np.cos(phi)
    cos2_h = np.clip((cos_i + cosine) ** 2 / (2 + 2 * i_dot_o), 0, 1)
    inverse = 1 / roughness**2
    d = (2 + inverse) * (1 - cos2_h) ** (inverse / 2) / (2 * np.pi)
    v = 1 / (4 * (cos_i + cosine - cos_i * cosine))
    return float((d * v * cos_i * dcos).mean(1).sum() * 2 * np.pi)


def main():
    rows = [[albedo(max(i / (SIZE - 1), 1e-3), max(j / (SIZE - 1), 0.07)) for i in range(SIZE)] for j in range(SIZE)]
    lines = ["    " + ", ".join(f"{v:.5f}f" for v in row) + "," for row in rows]
    with open("src/materials/lobes/sheen_albedo_table.h", "w") as file:
        file.write('#pragma once\n// A row of the table is a line here.\n// clang-format off\n#include "materials/microfacet/ggx_albedo_table.h"\n\n'
                   "namespace fathom {\n\n"
                   "/// Made by tools/sheen_albedo.py: the share of light that a white sheen reflects, in rows by roughness (from 0.07), columns by\n"
                   "/// cosine, of the size of ggx_albedo_table.\n"
                   "inline constexpr float sheen_albedo_table[ggx_albedo_size * ggx_albedo_size] = {\n" + "\n".join(lines)
                   + "\n};\n\n}  // namespace fathom\n")


main()
