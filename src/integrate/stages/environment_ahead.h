#pragma once
#include <algorithm>

#include "light/records.h"
#include "sampling/inversion.h"
#include "sampling/sobol.h"

namespace fathom::inline FATHOM_LANES {

/// Whether samples of the environment read more than the caches near a core hold.
inline bool is_worth_fetching(const EnvironmentRecord& e)
{
    constexpr int least_texels = 1 << 16;
    return e.light != no_index && EnvironmentKind(e.kind) == EnvironmentKind::image &&
           e.width * e.height > least_texels;
}

/// Brings to the cache what samples of an environment's image are going to read: tables and texels, which are more than
/// caches hold, each found by what the one before says. Where a sample falls is decided by random numbers alone, so it
/// is known before the surface is that it is for.
class EnvironmentAhead {
public:
    explicit EnvironmentAhead(const EnvironmentRecord& environment) : e_(environment) {}

    /// The rows of the samples for a gang: its next steps can then be fetched.
    void find_rows(std::size_t gang, Sample2 random)
    {
        Steps& s = steps_[gang % gangs];
        const GuidedInterval row = find_guided(e_.marginal, e_.marginal_guide, e_.height, UInt(0u), random.y);
        const UInt guide = row.number * UInt(guide_size(e_.width)) + guide_entry(e_.width, random.x);
        // Texels of two rows are mixed: this one and the nearer of its neighbours.
        const Mask above = random.y - row.begin < (row.end - row.begin) * Float(0.5f);
        store(s.row, row.number);
        store(s.first_texel_row, select(above & (row.number != UInt(0u)), row.number - UInt(1u), row.number));
        store(s.guide, guide);
        for (int lane = 0; lane < lanes; ++lane) __builtin_prefetch(&e_.conditional_guides[s.guide[lane]]);
    }
    /// Where in their rows the samples are, about.
    void fetch_columns(std::size_t gang) const
    {
        const Steps& s = steps_[gang % gangs];
        const std::size_t width = std::size_t(e_.width), last = std::size_t(e_.height) - 1;
        for (int lane = 0; lane < lanes; ++lane) {
            const std::uint32_t bounds = e_.conditional_guides[s.guide[lane]];
            const std::size_t column = ((bounds & 0xffff) + (bounds >> 16)) / 2;
            __builtin_prefetch(&e_.conditional[s.row[lane] * (width + 1) + column]);
            const std::size_t top = s.first_texel_row[lane], bottom = std::min(top + 1, last);
            __builtin_prefetch(&e_.texels[4 * (top * width + column)]);
            __builtin_prefetch(&e_.texels[4 * (bottom * width + column)]);
        }
    }

private:
    static constexpr std::size_t gangs = 2;
    struct Steps {
        std::uint32_t row[lanes], first_texel_row[lanes], guide[lanes];
    };

    const EnvironmentRecord& e_;
    Steps steps_[gangs];
};

}  // namespace fathom::inline FATHOM_LANES
