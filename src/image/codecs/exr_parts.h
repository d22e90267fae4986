// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <ImfHeader.h>
#include <ImfIO.h>
#include <ImfPixelType.h>
#include <half.h>

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "image/codecs/codecs.h"

/// Parts shared by the OpenEXR code of images (exr.cpp) and of film files.
namespace fathom {

/// Offset of the end of the EXR headers in these bytes; nothing if they are cut short or contain inconsistent lengths.
/// OpenEXR would allocate as much memory as an attribute's length claims.
std::optional<std::size_t> exr_headers_end(const unsigned char* bytes, std::size_t size);

/// An input stream of OpenEXR over a file in memory.
class ExrMemoryInput : public Imf::IStream {
public:
    explicit ExrMemoryInput(const EncodedImage& file) : Imf::IStream(file.name.c_str()), file_(file) {}

    bool read(char destination[], int size) override;
    std::uint64_t tellg() override { return position_; }
    void seekg(std::uint64_t position) override;

private:
    const EncodedImage& file_;
    std::size_t position_ = 0;
};

/// The name of a layer's channel in files, such as `albedo.R`.
std::string full_name(const std::string& layer, const std::string& channel);

/// Headers of all parts. Throws Error if there is none.
std::vector<Imf::Header> read_exr_headers(const EncodedImage& file);
/// Header of the first part.
Imf::Header read_exr_header(const EncodedImage& file);

/// Number of threads of OpenEXR's pool that read or write an image.
int exr_threads();

/// An image prepared for OpenEXR: the header with attributes and channels, and pointers to the channels' values. They
/// point into the image, which must outlive this object, or into converted copies that this object owns.
class ExrChannels {
public:
    ExrChannels(const Image& image, const WriteOptions& options);
    ExrChannels(const ExrChannels&) = delete;
    ExrChannels& operator=(const ExrChannels&) = delete;

    struct Channel {
        std::string name;
        Imf::PixelType type;
        const char* first;   ///< value of the first pixel
        std::size_t stride;  ///< bytes between the values of adjacent pixels
    };
    Imf::Header header;
    std::vector<Channel> channels;

private:
    void add(const std::string& name, Imf::PixelType type, const void* first, std::size_t stride);

    std::vector<Image::Layer> converted_;
    std::vector<std::vector<half>> halves_;
};

}  // namespace fathom
