// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <algorithm>
#include <cstring>
#include <memory>

#include "fathom/error.h"
#include "image/codecs/codecs.h"

// Formats that have readers of their own are disabled here. stb_image's HDR reader loops forever on some truncated
// files.
#define STBI_NO_HDR
#define STBI_NO_JPEG
#define STBI_NO_PNG
#define STBI_NO_STDIO
#define STBI_NO_LINEAR
#define STB_IMAGE_STATIC
#define STB_IMAGE_IMPLEMENTATION
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wall"
#pragma GCC diagnostic ignored "-Wextra"
#pragma GCC diagnostic ignored "-Wshadow"
#pragma GCC diagnostic ignored "-Wunused-function"
#include <stb/stb_image.h>
#pragma GCC diagnostic pop

namespace fathom {

namespace {

/// Input callbacks for stb_image that detect truncated files: stb_image itself reads zeros beyond the end.
class Feed {
public:
    explicit Feed(const EncodedImage& file) : file_(file) {}

    static int read(void* user, char* destination, int size)
    {
        auto* feed = static_cast<Feed*>(user);
        // Reads into stb_image's internal buffer are read-ahead, for which a short read is no error. All other reads
        // ask for exactly the bytes that are needed.
        if (!feed->buffer_) feed->buffer_ = destination;
        const bool ahead = destination == feed->buffer_;
        const std::size_t count = std::min(std::size_t(size), feed->file_.size - feed->position_);
        if (count == 0 || (!ahead && count < std::size_t(size))) feed->beyond_end_ = true;
        if (count > 0) std::memcpy(destination, feed->file_.bytes + feed->position_, count);
        feed->position_ += count;
        return int(count);
    }
    static void skip(void* user, int size)
    {
        auto* feed = static_cast<Feed*>(user);
        if (size < 0) {
            feed->position_ -= std::min(std::size_t(-size), feed->position_);
            return;
        }
        if (std::size_t(size) > feed->file_.size - feed->position_) feed->beyond_end_ = true;
        feed->position_ += std::min(std::size_t(size), feed->file_.size - feed->position_);
    }
    static int at_end(void* user)
    {
        auto* feed = static_cast<Feed*>(user);
        return feed->position_ >= feed->file_.size;
    }
    bool beyond_end() const { return beyond_end_; }

private:
    const EncodedImage& file_;
    std::size_t position_ = 0;
    char* buffer_ = nullptr;
    bool beyond_end_ = false;
};

constexpr stbi_io_callbacks callbacks = {Feed::read, Feed::skip, Feed::at_end};

struct Free {
    void operator()(void* values) const { stbi_image_free(values); }
};

template <class Value>
Image take_values(const EncodedImage& file, const Feed& feed, Value* values, int width, int height, int channels,
                  float scale)
{
    const std::unique_ptr<Value, Free> owner(values);
    if (!values) throw Error(file.name, "", fmt::format("damaged image: {}", stbi_failure_reason()));
    if (feed.beyond_end()) throw Error(file.name, "", "the file is truncated");
    Image image = make_image(width, height, channels);
    std::vector<float>& pixels = image.layers[0].pixels;
    for (std::size_t i = 0; i < pixels.size(); ++i) pixels[i] = float(values[i]) / scale;
    return image;
}

/// Whether stb_image reads 16-bit PNM values in machine byte order, as before version 2.28; the file is big-endian.
bool pnm_is_swapped()
{
    static const unsigned char picture[] = "P5 1 1 65535\n\x01\x02";
    int width = 0, height = 0, channels = 0;
    const std::unique_ptr<stbi_us, Free> value(
        stbi_load_16_from_memory(picture, sizeof picture - 1, &width, &height, &channels, 0));
    return value && *value == 0x0201;
}

/// Rejects numbers in PNM headers that overflow: stb_image before 2.28 lets them wrap around.
void check_pnm_header(const EncodedImage& file)
{
    if (file.size < 2 || file.bytes[0] != 'P' || (file.bytes[1] != '5' && file.bytes[1] != '6')) return;
    int numbers = 0, digits = 0;
    bool in_comment = false;
    for (std::size_t i = 2; i < file.size && numbers < 3; ++i) {
        const unsigned char c = file.bytes[i];
        if (in_comment) {
            in_comment = c != '\n' && c != '\r';
        } else if (c >= '0' && c <= '9') {
            if (++digits > 9) throw Error(file.name, "", "damaged image: a number in its header is too large");
        } else {
            if (digits > 0) ++numbers;
            digits = 0;
            in_comment = c == '#';
        }
    }
}

}  // namespace

Image read_stb(const EncodedImage& file)
{
    check_pnm_header(file);
    int width = 0, height = 0, channels = 0;
    Feed info(file);
    if (!stbi_info_from_callbacks(&callbacks, &info, &width, &height, &channels))
        throw Error(
            file.name, "",
            "this is not an image in a supported format (EXR, PNG, JPEG, WebP, AVIF, HDR, BMP, TGA, GIF, PSD, PNM)");
    // The factor 2 covers copies that stb_image makes during conversion.
    check_size(file, std::uint64_t(width), std::uint64_t(height), std::uint64_t(channels) * 2 * sizeof(float));

    Feed wide(file), feed(file);
    if (stbi_is_16_bit_from_callbacks(&callbacks, &wide)) {
        stbi_us* values = stbi_load_16_from_callbacks(&callbacks, &feed, &width, &height, &channels, 0);
        static const bool swapped = pnm_is_swapped();
        if (values && swapped && file.bytes[0] == 'P')
            for (std::size_t i = 0; i < std::size_t(width) * std::size_t(height) * std::size_t(channels); ++i)
                values[i] = stbi_us(values[i] << 8 | values[i] >> 8);
        return take_values(file, feed, values, width, height, channels, 65535);
    }
    stbi_uc* values = stbi_load_from_callbacks(&callbacks, &feed, &width, &height, &channels, 0);
    return take_values(file, feed, values, width, height, channels, 255);
}

}  // namespace fathom
