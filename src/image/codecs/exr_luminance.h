#pragma once
#include <ImfChannelList.h>
#include <ImfHeader.h>

#include <string>

#include "image/codecs/codecs.h"

namespace fathom {

/// Whether a channel is one of the two of chroma, RY = (R - Y) / Y and BY = (B - Y) / Y, at half the resolution.
bool is_half_chroma(const std::string& channel, const Imf::Channel& format);

/// Makes R, G and B of layers with luminance and chroma. The weights of luminance are those of the file's primaries.
/// image   as its part is read, without chroma at half resolution, which is read here by OpenEXR's own filter
/// is_later_part  whether it is not the first part, of which alone OpenEXR reads such chroma
void add_chroma(Image& image, const EncodedImage& file, const Imf::Header& header, bool is_later_part, int threads);

}  // namespace fathom
