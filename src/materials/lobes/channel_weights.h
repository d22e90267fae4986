// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "math/spectrum.h"

namespace fathom {
inline namespace FATHOM_LANES {

/// Weights of the channels when a closure chooses among its lobes.
///
/// Noise is judged relative to the brightness of each channel. On a red surface, green and blue come from the white
/// specular lobes alone: these must be sampled more often than their share of all light suggests. With probabilities
/// p_i and albedos a_i, the sum over channels of the relative variances is proportional to
///
///     sum_i 1 / p_i sum_c (a_ic / A_c)^2,   A_c = sum_i a_ic,
///
/// which is smallest for p_i proportional to sqrt(sum_c (a_ic / A_c)^2). The squared mean over the channels is added to
/// A_c^2, because the noise of a dark channel beside a bright one is less visible. Weights add up to 1, so that gray
/// lobes have their albedo as norm.
class ChannelWeights {
public:
    ChannelWeights() = default;
    /// body: approximate albedo of the colored lobes. The white lobes are assumed to reflect 4 % at least.
    explicit ChannelWeights(const Spectrum& body)
    {
        constexpr float white = 0.04f;
        const Float average = mean(body) + Float(white), floor = average * average;
        Float sum(0);
        for (int i = 0; i < channels; ++i) {
            const Float a = body.c[i] + Float(white);
            weights_.c[i] = Float(1) / fma(a, a, floor);
            sum = sum + weights_.c[i];
        }
        weights_ = weights_ * (Float(1) / sum);
    }
    /// Factor of a lobe's selection probability, from its albedo by channel.
    Float norm(const Spectrum& albedo) const
    {
        Float sum(0);
        for (int i = 0; i < channels; ++i) sum = fma(weights_.c[i] * albedo.c[i], albedo.c[i], sum);
        return sqrt(sum);
    }

private:
    Spectrum weights_{Float(1.0f / 3)};
};

}  // namespace FATHOM_LANES
}  // namespace fathom
