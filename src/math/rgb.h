// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>

namespace fathom {

/// Number of channels of Spectrum, and of colors in records and files: linear Rec.709.
inline constexpr int channels = 3;

using Rgb = std::array<float, channels>;

}  // namespace fathom
