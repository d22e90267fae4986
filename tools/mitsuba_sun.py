#!/usr/bin/env python3
"""Writes src/formats/mitsuba/sun_table.h: what the sun of Mitsuba's `sunsky` gives a surface that faces it, by turbidity and height.

    tools/mitsuba_sun.py > src/formats/mitsuba/sun_table.h

Measured: its radiance in many directions of the disk. Between the heights it is linear there, below the
first it stays as it is. Wants mitsuba.
"""
import drjit as dr
import mitsuba as mi
import numpy as np

mi.set_variant("llvm_ad_rgb")

HEIGHTS = [*range(2, 90, 3), 90]  # of the sun, degrees
RADIUS = np.radians(0.5358) / 2
# In float, as there.
SOLID_ANGLE = 2 * np.pi * float(np.float32(1) - np.float32(np.cos(RADIUS)))
RINGS, SPOKES = 4096, 4


def disk(height):
    """Directions, alike over the disk's solid angle, a little within its edge, where rounding decides."""
    cosine = 1 - (1 - np.cos(RADIUS)) * 0.9999 * (np.arange(RINGS) + 0.5) / RINGS
    sine = np.sqrt(1 - cosine * cosine)
    middle = np.array([np.cos(height), 0, np.sin(height)])
    up, side = np.array([-np.sin(height), 0, np.cos(height)]), np.array([0, 1, 0])
    angles = 2 * np.pi * (np.arange(SPOKES) + 0.5) / SPOKES
    return np.concatenate([np.outer(cosine, middle) + np.outer(sine * np.cos(a), up) + np.outer(sine * np.sin(a), side) for a in angles])


def irradiance(turbidity, height):
    directions = disk(height)
    emitter = mi.load_dict({"type": "sunsky", "turbidity": float(turbidity), "sky_scale": 0.0, "sun_scale": 1.0,
                            "sun_direction": [float(np.cos(height)), 0.0, float(np.sin(height))]})
    at = dr.zeros(mi.SurfaceInteraction3f, len(directions))
    at.wi = mi.Vector3f(-directions.T.astype(np.float32))
    return np.array(emitter.eval(at)).reshape(3, -1).mean(1) * SOLID_ANGLE


print("""#pragma once
#include <array>

namespace fathom::mitsuba {

/// What the sun of Mitsuba's `sunsky` gives a surface that faces it, whatever its size, by turbidity from 1 to 10 and its height in degrees.
/// By tools/mitsuba_sun.py. Between these it is linear, below the first height it stays as it is; what is below 0 is none.
inline constexpr double sun_heights_deg[] = {%s};
inline constexpr std::array<float, 3> sun_irradiance[10][%d] = {""" % (", ".join(map(str, HEIGHTS)), len(HEIGHTS)))
for turbidity in range(1, 11):
    row = [irradiance(turbidity, np.radians(h)) for h in HEIGHTS]
    print("    {" + ", ".join("{%s}" % ", ".join(f"{x:.5g}f" if "." in f"{x:.5g}" or "e" in f"{x:.5g}" else f"{x:.5g}.f" for x in c) for c in row) + "},")
print("};\n\n}  // namespace fathom::mitsuba")
