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

/// What OpenEXR is asked with: of pictures (exr.cpp) and of film files.
namespace fathom {

/// Where the headers of an EXR end that these bytes begin; nothing where they are cut short, or lengths in them are
/// not sound. OpenEXR believes an attribute's length and asks for as much memory.
std::optional<std::size_t> exr_headers_end(const unsigned char* bytes, std::size_t size);

/// A file in memory, for OpenEXR.
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

/// What a layer's channel is called in files.
std::string full_name(const std::string& layer, const std::string& channel);

/// The headers of all parts, at least one. Throws Error if there is none.
std::vector<Imf::Header> read_exr_headers(const EncodedImage& file);
Imf::Header read_exr_header(const EncodedImage& file);

/// How many threads of OpenEXR's pool read or write a picture.
int exr_threads();

/// A picture as an EXR has it: a header with its attributes and channels, and where these stand in memory: in the
/// picture, which must stay, or in here.
class ExrChannels {
public:
    ExrChannels(const Image& image, const WriteOptions& options);
    ExrChannels(const ExrChannels&) = delete;
    ExrChannels& operator=(const ExrChannels&) = delete;

    struct Channel {
        std::string name;
        Imf::PixelType type;
        const char* first;   ///< its value in the first pixel
        std::size_t stride;  ///< from there to the next one's, in bytes
    };
    Imf::Header header;
    std::vector<Channel> channels;

private:
    void add(const std::string& name, Imf::PixelType type, const void* first, std::size_t stride);

    std::vector<Image::Layer> converted_;
    std::vector<std::vector<half>> halves_;
};

}  // namespace fathom
