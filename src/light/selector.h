#pragma once
#include "light/light.h"
#include "sampling/inversion.h"

namespace fathom::inline FATHOM_LANES {

/// Which light a surface samples: one of all, by power or each as often as any other.
class LightSelector {
public:
    LightSelector(const LightTables& tables, LightSelection how)
        : tables_(tables),
          count_(std::uint32_t(tables.lights.size())),
          is_uniform_(how == LightSelection::uniform),
          uniform_pmf_(count_ > 0 ? 1 / float(count_) : 0)
    {
    }

    /// The light for a number in [0, 1).
    UInt select(Float u) const
    {
        if (is_uniform_) {
            const UInt light = to_uint(u * Float(float(count_)));
            return fathom::select(less(light, UInt(count_)), light, UInt(count_ - 1));
        }
        return find_interval(tables_.light_cdf.data(), UInt(0u), int(count_), u);
    }

    /// The probability with which select() gives the light.
    template <class Light>
    Float pmf(const Light& light) const
    {
        return is_uniform_ ? Float(uniform_pmf_) : light.pmf();
    }
    float pmf(std::uint32_t light) const { return is_uniform_ ? uniform_pmf_ : tables_.lights[light].pmf; }

private:
    const LightTables& tables_;
    std::uint32_t count_;
    bool is_uniform_;
    float uniform_pmf_;
};

}  // namespace fathom::inline FATHOM_LANES
