// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace fathom {

/// Luminance of a linear Rec.709 color of three channels.
inline double luminance(const float* c)
{
    return 0.2126 * double(c[0]) + 0.7152 * double(c[1]) + 0.0722 * double(c[2]);
}

}  // namespace fathom
