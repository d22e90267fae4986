// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <ImfChannelList.h>
#include <ImfHeader.h>

#include <string>

#include "image/codecs/codecs.h"

namespace fathom {

/// Whether a channel is a chroma channel, RY = (R - Y) / Y or BY = (B - Y) / Y, at half resolution.
bool is_half_chroma(const std::string& channel, const Imf::Channel& format);

/// Converts layers of luminance and chroma to R, G and B. The luminance weights follow from the file's primaries.
///
/// image          the part as read, without chroma at half resolution, which is read here with OpenEXR's own filter
/// is_later_part  whether the part is not the first one: OpenEXR reads such chroma only from the first part
void add_chroma(Image& image, const EncodedImage& file, const Imf::Header& header, bool is_later_part, int threads);

}  // namespace fathom
