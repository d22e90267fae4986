// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <limits>

#include "math/elementary.h"
#include "math/spectrum.h"

namespace fathom {
inline namespace FATHOM_LANES {

/// Transmittance over a length, which may be infinite.
inline Spectrum transmittance(const Spectrum& extinction, Float length)
{
    Spectrum left;
    for (int c = 0; c < channels; ++c) {
        const Float sigma = extinction.c[c];
        // The transmittance of empty space is 1 over infinite lengths, too.
        left.c[c] = select(sigma > Float(0), exp(-(sigma * length)), Float(1));
    }
    return left;
}

/// Samples the distance to the next absorption or scattering event in a homogeneous medium.
///
/// The distance is sampled by one channel, which is chosen in proportion to the path's throughput. Weights divide by
/// the mean density over channels (the balance heuristic): Chiang, Kutz and Burley 2016, "Practical and Controllable
/// Subsurface Scattering for Production Path Tracing".
class DistanceSample {
public:
    /// u, pick: random numbers in [0, 1) for the distance and the channel. The throughput must be positive in at least
    /// one channel.
    DistanceSample(const Spectrum& extinction, const Spectrum& throughput, Float u, Float pick)
        : extinction_(extinction)
    {
        Float total(0);
        for (int c = 0; c < channels; ++c) total = total + throughput.c[c];
        Float left = pick * total, sigma(0);
        Mask found(false);
        for (int c = 0; c < channels; ++c) {
            chance_.c[c] = throughput.c[c] / total;
            const Mask it = !found & (throughput.c[c] > Float(0));
            // If rounding leaves a remainder, the last channel with a positive throughput is chosen.
            sigma = select(it, extinction.c[c], sigma);
            found |= it & (left < throughput.c[c]);
            left = left - throughput.c[c];
        }
        distance_ = select(sigma > Float(0), -log(Float(1) - u) / sigma, Float(std::numeric_limits<float>::infinity()));
    }
    Float distance() const { return distance_; }

    /// Weight of a path that scatters at the sampled distance.
    Spectrum scattered(const Spectrum& scattering) const
    {
        const Spectrum left = transmittance(extinction_, distance_);
        return scattering * left * (Float(1) / mean(extinction_ * left));
    }
    /// Weight of a path that reaches the surface at distance `way`, no larger than the sampled distance.
    Spectrum passed(Float way) const
    {
        const Spectrum left = transmittance(extinction_, way);
        return left * (Float(1) / mean(left));
    }

private:
    Float mean(const Spectrum& density) const
    {
        Float sum(0);
        for (int c = 0; c < channels; ++c) sum = fma(chance_.c[c], density.c[c], sum);
        return sum;
    }

    Spectrum extinction_, chance_;
    Float distance_;
};

}  // namespace FATHOM_LANES
}  // namespace fathom
