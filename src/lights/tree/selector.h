// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "lights/light.h"
#include "lights/tree/tree.h"
#include "sampling/inversion.h"

namespace fathom {
inline namespace FATHOM_LANES {

/// Selects the light that a path vertex samples: by estimated contribution (light tree), by power, or uniformly. The
/// tree selects among lights with a position; the others are selected by their share of the power.
class LightSelector {
public:
    LightSelector(const LightTables& tables, LightSelection how)
        : tables_(tables),
          tree_(tables),
          count_(std::uint32_t(tables.lights.size())),
          is_uniform_(how == LightSelection::uniform),
          has_tree_(how == LightSelection::tree && !tables.light_tree.empty()),
          uniform_pmf_(count_ > 0 ? 1 / float(count_) : 0),
          tree_share_(has_tree_ ? tables.light_cdf[tables.positioned_lights] : 0)
    {
    }

    /// The index of a light, and its selection probability.
    using Choice = LightTree::Choice;

    /// Selects a light for a path vertex at p by a number u in [0, 1), for the lanes of m. With many lights the bits of
    /// u don't suffice; `noise`, also in [0, 1), provides more.
    Choice select(Vec3 p, Float u, Float noise, Mask m) const
    {
        if (!has_tree_) return select_anywhere(u);
        const Mask beyond = u >= Float(tree_share_);
        if (none(m & !beyond)) return select_by_power(tables_.positioned_lights, u);
        const Float within = min(u * Float(1 / tree_share_), Float(1 - 0x1p-24f));
        Choice c = tree_.select(p, within, noise, m & !beyond);
        c.pmf = c.pmf * Float(tree_share_);
        if (none(m & beyond)) return c;
        const Choice other = select_by_power(tables_.positioned_lights, u);
        return {fathom::select(beyond, other.light, c.light), fathom::select(beyond, other.pmf, c.pmf)};
    }

    /// Probability with which select() returns the light for a vertex at p, for the lanes of m.
    template <class Light>
    Float pmf(const Light& light, Vec3 p, Mask m) const
    {
        if (is_uniform_) return Float(uniform_pmf_);
        if (!has_tree_) return light.pmf();
        const UInt place = light.tree_place();
        const Mask in_tree = m & (place != UInt(no_index));
        if (none(in_tree)) return light.pmf();
        const Float seen = tree_.pmf(fathom::select(in_tree, place, UInt(0u)), p, in_tree);
        return fathom::select(in_tree, seen * Float(tree_share_), light.pmf());
    }
    /// Selection probability of a light without a position.
    float pmf(std::uint32_t light) const { return is_uniform_ ? uniform_pmf_ : tables_.lights[light].pmf; }

private:
    Choice select_anywhere(Float u) const
    {
        if (!is_uniform_) return select_by_power(0, u);
        const UInt light = to_uint(u * Float(float(count_)));
        return {fathom::select(less(light, UInt(count_)), light, UInt(count_ - 1)), Float(uniform_pmf_)};
    }
    /// Selects among the lights from index `first` on.
    Choice select_by_power(std::uint32_t first, Float u) const
    {
        if (first == count_) return {UInt(count_ - 1), Float(0)};
        const UInt light = UInt(first) + find_interval(tables_.light_cdf.data(), UInt(first), int(count_ - first), u);
        return {light, LightReader<false>(tables_.lights.data(), light).pmf()};
    }

    const LightTables& tables_;
    const LightTree tree_;
    std::uint32_t count_;
    bool is_uniform_, has_tree_;
    float uniform_pmf_;
    float tree_share_;  ///< sum of the probabilities of lights in the tree
};

}  // namespace FATHOM_LANES
}  // namespace fathom
