// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Access to the numbers of glTF's materials.
#include <algorithm>

#include "formats/json/json.h"

namespace fathom {

/// The number of an optional key, or the default.
inline float float_or(const JsonValue& v, const char* key, float otherwise)
{
    return v.has(key) ? v[key].single() : otherwise;
}

/// A factor clamped to [0, 1], which the format requires.
inline float factor_or(const JsonValue& v, const char* key, float otherwise)
{
    return std::clamp(float_or(v, key, otherwise), 0.0f, 1.0f);
}

/// A color from three array elements, clamped to [0, 1].
inline Color clamped(const JsonValue& v, std::size_t i0 = 0)
{
    const auto channel = [&](std::size_t i) { return std::clamp(v[i].single(), 0.0f, 1.0f); };
    return {channel(i0), channel(i0 + 1), channel(i0 + 2)};
}

}  // namespace fathom
