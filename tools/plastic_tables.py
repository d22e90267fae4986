#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Writes src/materials/closures/plastic_tables.h: transmittance of a rough boundary of index 1.5 by cosine and
roughness, for closures/plastic.h. Microfacets as in ggx_albedo.py, with Fresnel's equations."""
import numpy as np

from ggx_albedo import SIZE, smith_lambda, visible_normals

IOR = 1.5
STRATA = 160


def fresnel(cosine, eta):
    """Fresnel reflectance, and the cosine beyond the boundary."""
    s2 = (1 - cosine * cosine) / eta**2
    t = np.sqrt(np.clip(1 - s2, 0, 1))
    p, s = (eta * cosine - t) / (eta * cosine + t), (cosine - eta * t) / (cosine + eta * t)
    return np.where(s2 >= 1, 1, (p * p + s * s) / 2), t


CORRELATED, SEPARABLE, BECKMANN = range(3)
# Factor from a Beckmann alpha to the GGX alpha that is sampled for it: ggx_of_beckmann of microfacet.h.
GGX_OF_BECKMANN = 0.7


def beckmann_shadowing(z, alpha):
    """Beckmann's shadowing term: Walter et al. 2007, equation 27."""
    a = z / (alpha * np.sqrt(np.maximum(1 - z * z, 1e-12)))
    return np.where(a < 1.6, (3.535 * a + 2.181 * a * a) / (1 + 2.276 * a + 2.577 * a * a), 1)


def beckmann_by_ggx(n, cosine, alpha):
    """Ratio of the densities of Beckmann's and GGX's visible normals."""
    wide, t2 = alpha / GGX_OF_BECKMANN, (1 - n[..., 2]**2) / n[..., 2]**2
    beckmann = np.exp(-t2 / wide**2) / wide**2
    ggx = 1 / (alpha**2 * (1 + t2 / alpha**2)**2)
    return beckmann / ggx * beckmann_shadowing(cosine, wide) * (1 + smith_lambda(cosine, alpha))


def shares(cosine, alpha, eta, facets=CORRELATED):
    """Returns the fractions of light that are reflected, that pass, and that perfectly reflecting facets would reflect,
    in one scattering event (Walter et al. 2007)."""
    wo = np.array([np.sqrt(max(0, 1 - cosine * cosine)), 0, cosine])
    u = (np.arange(STRATA) + 0.5) / STRATA
    n = visible_normals(wo, alpha, *np.meshgrid(u, u))
    c = np.clip(n @ wo, 0, 1)
    f, t = fresnel(c, eta)
    up = 2 * c * n[..., 2] - wo[2]
    down = wo[2] / eta - (c / eta - t) * n[..., 2]
    lo = smith_lambda(cosine, alpha)

    def seen(z):
        above = np.clip(z, 1e-6, 1)
        if facets == BECKMANN:
            by_other = beckmann_shadowing(above, alpha / GGX_OF_BECKMANN) * beckmann_by_ggx(n, cosine, alpha)
        else:
            hidden = 1 + lo if facets == CORRELATED else 1
            by_other = hidden / (hidden + smith_lambda(above, alpha))
        return np.where(z > 0, by_other, 0)

    return np.array([(f * seen(up)).mean(), ((1 - f) * seen(down)).mean(), seen(up).mean()])


def diffuse_mean(function):
    """Mean over diffuse light."""
    points, weights = np.polynomial.legendre.leggauss(64)
    roots = (points + 1) / 2  # square roots of the cosines: dense at grazing angles
    return sum(2 * w * r**3 * function(r * r) for r, w in zip(roots, weights))


def cosine_of(reflectance):
    """Returns the cosine at which a smooth boundary has the given reflectance."""
    low, high = 0.0, 1.0
    for _ in range(40):
        middle = (low + high) / 2
        low, high = (middle, high) if fresnel(middle, IOR)[0] > reflectance else (low, middle)
    return (low + high) / 2


def smooth_mean(ior):
    return diffuse_mean(lambda c: fresnel(c, ior)[0])


def smooth_polynomial():
    """Fits the reflectance of a smooth boundary for diffuse light by powers 1 to 7 of the square root of (ior - 1) /
    (ior + 1)."""
    ior = np.concatenate([np.linspace(1.0005, 1.05, 30), np.linspace(1.05, 3, 80)])
    root = np.sqrt((ior - 1) / (ior + 1))
    return np.linalg.lstsq(np.stack([root**k for k in range(1, 8)], 1), [smooth_mean(i) for i in ior], rcond=None)[0]


def rows(values):
    return "\n".join("    " + ", ".join(f"{v:.5f}f" for v in row) + "," for row in values)


def main():
    mirrors, passes, cosines, means = [], [[], [], []], [], []
    for j in range(SIZE):
        alpha = max(j / (SIZE - 1), 0.02) ** 2
        outside = [shares(max(i / (SIZE - 1), 0.004), alpha, IOR) for i in range(SIZE)]
        effective = [cosine_of(r / all_) for r, _, all_ in outside]
        mirrors.append([all_ for _, _, all_ in outside])
        cosines.append(effective)
        reflected = diffuse_mean(lambda c: shares(c, alpha, IOR))[0]
        of_facets = []
        for facets in (CORRELATED, SEPARABLE, BECKMANN):
            passes[facets].append([shares(max(i / (SIZE - 1), 0.004), alpha, IOR, facets)[1] / (1 - fresnel(c, IOR)[0])
                                   for i, c in enumerate(effective)])
            through = diffuse_mean(lambda c: shares(c, alpha, IOR, facets))[1]
            lost_within = 1 - diffuse_mean(lambda c: shares(c, alpha, 1 / IOR, facets))[0] - through / IOR**2
            of_facets += [through / (1 - reflected), max(lost_within, 0)]
        # Interpolates between the behavior of smooth boundaries and that of normal incidence, which rough ones
        # approach.
        other = 1.3
        smooth_ratio, normal_ratio = smooth_mean(other) / smooth_mean(IOR), fresnel(1.0, other)[0] / fresnel(1.0, IOR)[0]
        ratio = diffuse_mean(lambda c: shares(c, alpha, other))[0] / reflected
        bend = np.clip((ratio - smooth_ratio) / (normal_ratio - smooth_ratio), 0, 1)
        means.append([reflected, bend, *of_facets])
    polynomial = ", ".join(f"{c:.7f}f" for c in smooth_polynomial())
    with open("src/materials/closures/plastic_tables.h", "w") as file:
        file.write("#pragma once\n// One row of a table per source line.\n// clang-format off\n#include \"materials/microfacet/ggx_albedo_table.h\"\n\n"
                   "namespace fathom {\n\n"
                   "/// Generated by tools/plastic_tables.py for microfacets of a boundary of index 1.5. Rows by roughness (square root of\n"
                   "/// alpha) 0 to 1, columns by cosine 0 to 1. Four blocks: single-scattering albedo of perfectly reflecting facets; then\n"
                   "/// the fraction of unreflected light that passes, for height-correlated shadowing, for separable shadowing, and for\n"
                   "/// Beckmann facets (whose rows are by the most similar GGX roughness).\n"
                   "inline constexpr float plastic_share_table[4 * ggx_albedo_size * ggx_albedo_size] = {\n"
                   f"{rows(mirrors)}\n{rows(passes[CORRELATED])}\n{rows(passes[SEPARABLE])}\n{rows(passes[BECKMANN])}\n}};\n"
                   "/// Cosine at which a smooth boundary has the mean Fresnel reflectance of the microfacets.\n"
                   "inline constexpr float plastic_cosine_table[ggx_albedo_size * ggx_albedo_size] = {\n"
                   f"{rows(cosines)}\n}};\n"
                   "/// By roughness, for diffuse light: reflectance; interpolation weight of its change with the index, from a smooth\n"
                   "/// boundary's (0) to that at normal incidence (1); then for each kind of facets the fraction of unreflected light that\n"
                   "/// passes, and the fraction of internal light that is lost.\n"
                   f"inline constexpr float plastic_means_table[8 * ggx_albedo_size] = {{\n{rows(np.array(means).T)}\n}};\n"
                   "/// Reflectance of a smooth boundary for diffuse light: coefficients of powers 1 to 7 of sqrt((ior - 1) / (ior + 1)).\n"
                   f"inline constexpr float smooth_mean_polynomial[7] = {{{polynomial}}};\n\n}}  // namespace fathom\n")


if __name__ == "__main__":
    main()
