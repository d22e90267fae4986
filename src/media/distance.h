#pragma once
#include <limits>

#include "math/elementary.h"
#include "math/spectrum.h"

namespace fathom {
inline namespace FATHOM_LANES {

/// What a way of this length leaves of the light, unscattered; lengths may be infinite.
inline Spectrum transmittance(const Spectrum& extinction, Float length)
{
    Spectrum left;
    for (int c = 0; c < channels; ++c) {
        const Float sigma = extinction.c[c];
        // Nothing is lost over an infinite way through empty space.
        left.c[c] = select(sigma > Float(0), exp(-(sigma * length)), Float(1));
    }
    return left;
}

/// Where light in a medium meets something next, which scatters or absorbs it.
///
/// The distance is that of one channel, taken by chance in proportion to the path's throughput, so weights are divided
/// by the density of all channels together (the balance heuristic): Chiang, Kutz and Burley 2016, "Practical and
/// Controllable Subsurface Scattering for Production Path Tracing".
class DistanceSample {
public:
    /// u, pick: in [0, 1), for distance and channel. Some channel of the throughput is above 0.
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
            // What rounding leaves at the end is of the last channel that there is.
            sigma = select(it, extinction.c[c], sigma);
            found |= it & (left < throughput.c[c]);
            left = left - throughput.c[c];
        }
        distance_ = select(sigma > Float(0), -log(Float(1) - u) / sigma, Float(std::numeric_limits<float>::infinity()));
    }
    Float distance() const { return distance_; }

    /// Weight of light that something after the way of this distance scatters.
    Spectrum scattered(const Spectrum& scattering) const
    {
        const Spectrum left = transmittance(extinction_, distance_);
        return scattering * left * (Float(1) / mean(extinction_ * left));
    }
    /// Weight of light that goes all of a way that is no longer than the distance.
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
