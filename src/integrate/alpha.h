#pragma once
#include <cstdint>

#include "integrate/tables.h"

namespace fathom {

/// Whether a hit counts on a shape whose material has an alpha: by comparison with the cutoff, or, where alpha blends,
/// by a number hashed from the very place that was hit. On average a share of alpha of the rays is stopped, and the
/// answer for a place is always the same. context: the SceneTables.
bool alpha_passes(const void* context, std::uint32_t primitive, std::uint32_t instance, float u, float v);

/// The share of rays to this place of a primitive that alpha_passes stops, 0 to 1; 1 where it is not asked.
float alpha_share(const SceneTables& tables, std::uint32_t material, std::uint32_t primitive, float u, float v);

}  // namespace fathom
