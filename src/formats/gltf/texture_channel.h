// SPDX-License-Identifier: Apache-2.0
#pragma once

/// Channels of textures, as FloatInput::channel numbers them.
namespace fathom::texture_channel {

constexpr int red = 0, green = 1, blue = 2, alpha = 3;

}  // namespace fathom::texture_channel
