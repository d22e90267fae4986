// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Owen-scrambled Sobol points: the random numbers of a path. Every number is a function of (seed, pixel, sample index,
/// dimension) alone.
///
/// Dimensions come in pairs. Each pair is the first two Sobol dimensions, shuffled and scrambled independently
/// ("padding"): Burley 2020, "Practical Hash-based Owen Scrambling". The hash is the improved Laine-Karras hash of
/// Vegdahl 2021.
#include "math/hash.h"
#include "math/lanes.h"

namespace fathom {
inline namespace FATHOM_LANES {

/// A two-dimensional sample.
struct Sample2 {
    Float x, y;  ///< each in [0, 1)
};

/// Identifies the random numbers of a path: a hash of (seed, pixel), and the sample index with its bits reversed.
struct SampleKey {
    UInt pixel_hash;
    UInt reversed_index;
};

/// Owen scrambling of a number with reversed bits: each bit is flipped by a hash of the bits below it.
inline UInt scramble_reversed(UInt x, UInt seed)
{
    x ^= x * UInt(0x3d20adeau);
    x += seed;
    x *= (seed >> 16) | UInt(1);
    x ^= x * UInt(0x05526c56u);
    x ^= x * UInt(0x53a22864u);
    return x;
}

/// Second Sobol dimension of an index, with its bits reversed. The generator matrix is the Pascal triangle modulo 2:
/// bit (k, j) is set where the bits of k are a subset of those of j. Five steps apply it.
inline UInt sobol1_reversed(UInt i)
{
    i ^= (i >> 1) & UInt(0x55555555u);
    i ^= (i >> 2) & UInt(0x33333333u);
    i ^= (i >> 4) & UInt(0x0f0f0f0fu);
    i ^= (i >> 8) & UInt(0x00ff00ffu);
    i ^= i >> 16;
    return i;
}

/// Maps bits to [0, 1) with a precision of 24 bits, so that 1 is never reached.
inline Float unit_float(UInt bits)
{
    return to_float(bits >> 8) * Float(0x1p-24f);
}

/// Seed of a group of dimensions: the camera is one group, and each bounce is one.
inline UInt group_seed(const SampleKey& key, UInt group)
{
    return hash(key.pixel_hash + group * UInt(0x9e3779b9u));
}
/// Seed of a pair of dimensions within a group. The odd constants give a full period; the scrambling hash mixes
/// further.
inline UInt pair_seed(UInt group_seed, std::uint32_t pair)
{
    return group_seed * UInt(0x8da6b343u + 0x3504f330u * pair);
}

/// Index of the point of the sequence that a pair uses. Two pairs may share the index if their numbers never enter one
/// product: independent scrambling leaves their estimates uncorrelated. Other pairs must not share it.
inline UInt shuffled_index(const SampleKey& key, UInt seed)
{
    return reverse_bits(scramble_reversed(key.reversed_index, seed));
}

/// Two-dimensional sample in [0, 1)^2 for a shuffled index and the seed of a pair.
inline Sample2 sample_2d(UInt index, UInt seed)
{
    const UInt x = reverse_bits(scramble_reversed(index, rotate16(seed)));
    const UInt y = reverse_bits(scramble_reversed(sobol1_reversed(index), seed * UInt(0xd8163841u)));
    return {unit_float(x), unit_float(y)};
}
inline Sample2 sample_2d(const SampleKey& key, UInt seed)
{
    return sample_2d(shuffled_index(key, seed), seed);
}

/// Unstratified random number in [0, 1), for decisions that do not benefit from stratification.
inline Float sample_hash(const SampleKey& key, UInt seed)
{
    UInt x = (seed ^ key.reversed_index) * UInt(0x7feb352du);
    x ^= x >> 15;
    x *= UInt(0x846ca68bu);
    return unit_float(x ^ (x >> 16));
}

}  // namespace FATHOM_LANES
}  // namespace fathom
