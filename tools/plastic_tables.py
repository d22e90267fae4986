#!/usr/bin/env python3
"""Writes src/materials/closures/plastic_tables.h: what a rough boundary of index 1.5 lets through, by cosine and roughness, as
closures/plastic.h takes it. Facets as in ggx_albedo.py, with Fresnel's equations."""
import numpy as np

from ggx_albedo import SIZE, smith_lambda, visible_normals

IOR = 1.5
STRATA = 160


def fresnel(cosine, eta):
    """Reflectance, and the cosine beyond."""
    s2 = (1 - cosine * cosine) / eta**2
    t = np.sqrt(np.clip(1 - s2, 0, 1))
    p, s = (eta * cosine - t) / (eta * cosine + t), (cosine - eta * t) / (cosine + eta * t)
    return np.where(s2 >= 1, 1, (p * p + s * s) / 2), t


CORRELATED, SEPARABLE, BECKMANN = range(3)
# Beckmann's alpha by that of the GGX facets that are sampled for it: ggx_of_beckmann of microfacet.h.
GGX_OF_BECKMANN = 0.7


def beckmann_shadowing(z, alpha):
    """Walter et al. 2007, equation 27."""
    a = z / (alpha * np.sqrt(np.maximum(1 - z * z, 1e-12)))
    return np.where(a < 1.6, (3.535 * a + 2.181 * a * a) / (1 + 2.276 * a + 2.577 * a * a), 1)


def beckmann_by_ggx(n, cosine, alpha):
    """How many of Beckmann's normals are seen where GGX's are sampled."""
    wide, t2 = alpha / GGX_OF_BECKMANN, (1 - n[..., 2]**2) / n[..., 2]**2
    beckmann = np.exp(-t2 / wide**2) / wide**2
    ggx = 1 / (alpha**2 * (1 + t2 / alpha**2)**2)
    return beckmann / ggx * beckmann_shadowing(cosine, wide) * (1 + smith_lambda(cosine, alpha))


def shares(cosine, alpha, eta, facets=CORRELATED):
    """What is reflected, what passes, and what would be reflected by mirrors, by one facet (Walter et al. 2007)."""
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
    """The mean over light from everywhere."""
    points, weights = np.polynomial.legendre.leggauss(64)
    roots = (points + 1) / 2  # of the cosines: much happens at grazing angles
    return sum(2 * w * r**3 * function(r * r) for r, w in zip(roots, weights))


def cosine_of(reflectance):
    """Where a smooth boundary reflects as much."""
    low, high = 0.0, 1.0
    for _ in range(40):
        middle = (low + high) / 2
        low, high = (middle, high) if fresnel(middle, IOR)[0] > reflectance else (low, middle)
    return (low + high) / 2


def smooth_mean(ior):
    return diffuse_mean(lambda c: fresnel(c, ior)[0])


def smooth_polynomial():
    """What a smooth boundary reflects of light from everywhere, by powers 1 to 7 of the root of (ior - 1) / (ior + 1)."""
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
        # From the law of smooth boundaries to that of normal incidence, which rough ones come near to.
        other = 1.3
        smooth_ratio, normal_ratio = smooth_mean(other) / smooth_mean(IOR), fresnel(1.0, other)[0] / fresnel(1.0, IOR)[0]
        ratio = diffuse_mean(lambda c: shares(c, alpha, other))[0] / reflected
        bend = np.clip((ratio - smooth_ratio) / (normal_ratio - smooth_ratio), 0, 1)
        means.append([reflected, bend, *of_facets])
    polynomial = ", ".join(f"{c:.7f}f" for c in smooth_polynomial())
    with open("src/materials/closures/plastic_tables.h", "w") as file:
        file.write("#pragma once\n// A row of a table is a line here.\n// clang-format off\n#include \"materials/microfacet/ggx_albedo_table.h\"\n\n"
                   "namespace fathom {\n\n"
                   "/// Made by tools/plastic_tables.py, of facets of a boundary of index 1.5. Rows by roughness (alpha's root) 0 to 1, columns\n"
                   "/// by cosine 0 to 1; first what mirrors would reflect by one facet, then what passes of what is not reflected: of\n"
                   "/// facets whose shadowing goes by heights, by each direction alone, and of Beckmann's (there rows are of the GGX facets\n"
                   "/// that are most like them).\n"
                   "inline constexpr float plastic_share_table[4 * ggx_albedo_size * ggx_albedo_size] = {\n"
                   f"{rows(mirrors)}\n{rows(passes[CORRELATED])}\n{rows(passes[SEPARABLE])}\n{rows(passes[BECKMANN])}\n}};\n"
                   "/// The cosine at which a smooth boundary reflects what facets do in the mean.\n"
                   "inline constexpr float plastic_cosine_table[ggx_albedo_size * ggx_albedo_size] = {\n"
                   f"{rows(cosines)}\n}};\n"
                   "/// By roughness, of light from everywhere: what is reflected; how far the change with the index is from a smooth\n"
                   "/// boundary's to that at normal incidence; of each kind of facets, what passes of what is not reflected, and what is\n"
                   "/// lost of light from within.\n"
                   f"inline constexpr float plastic_means_table[8 * ggx_albedo_size] = {{\n{rows(np.array(means).T)}\n}};\n"
                   "/// What a smooth boundary reflects of light from everywhere, by powers 1 to 7 of the root of (ior - 1) / (ior + 1).\n"
                   f"inline constexpr float smooth_mean_polynomial[7] = {{{polynomial}}};\n\n}}  // namespace fathom\n")


if __name__ == "__main__":
    main()
