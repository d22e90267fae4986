#pragma once
#include <array>

namespace fathom {

/// Channels of a transported Spectrum, and of colours in records and files: linear Rec.709.
inline constexpr int channels = 3;

using Rgb = std::array<float, channels>;

}  // namespace fathom
