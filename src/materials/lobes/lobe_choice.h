// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "math/lanes.h"

namespace fathom {
inline namespace FATHOM_LANES {

/// Chooses among lobes by one coordinate of a two-dimensional sample: each lobe has an interval of it, which is then
/// stretched to [0, 1). The points of a lobe so remain evenly spread. A random number of its own would give each lobe a
/// random subset of the points, which is not.
class LobeChoice {
public:
    explicit LobeChoice(Float u) : left_(u), stretched_(u) {}

    /// Returns the lanes that choose the next lobe, which has this probability.
    Mask take(Float probability)
    {
        const Mask chosen = (left_ >= Float(0)) & (left_ < probability);
        stretched_ = select(chosen, left_ / max(probability, Float(1e-20f)), stretched_);
        left_ = left_ - probability;
        return chosen;
    }
    /// Gives the last lobe, which has this probability, to the lanes that have not chosen any.
    void take_rest(Float probability) { take(max(probability, left_ * Float(1 + 0x1p-20f))); }
    /// The coordinate within the lobe that was chosen.
    Float stretched() const { return clamp(stretched_, Float(0), Float(1 - 0x1p-24f)); }

private:
    Float left_, stretched_;
};

}  // namespace FATHOM_LANES
}  // namespace fathom
