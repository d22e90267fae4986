// SPDX-License-Identifier: Apache-2.0
#include <bit>
#include <cstdio>
#include <exception>

#include "fathom/image.h"

// Prints a hash of an image's content: size, names of layers and channels, and the bits of all values. File bytes
// depend on library versions.
namespace {

class Hash {
public:
    void add(std::uint64_t word)
    {
        state_ = (state_ ^ word) * 0x9e3779b97f4a7c15u;
        state_ ^= state_ >> 32;
    }
    void add(const std::string& text)
    {
        for (unsigned char c : text) add(c);
        add(text.size());
    }
    std::uint64_t value() const { return state_; }

private:
    std::uint64_t state_ = 0x243f6a8885a308d3u;
};

}  // namespace

int main(int argc, char** argv)
{
    if (argc != 2) {
        std::fprintf(stderr, "usage: picture_hash FILE\n");
        return 2;
    }
    try {
        const fathom::Image image = fathom::read_image(argv[1]);
        Hash hash;
        hash.add(std::uint64_t(image.width)), hash.add(std::uint64_t(image.height));
        for (const fathom::Image::Layer& layer : image.layers) {
            hash.add(layer.name);
            for (const std::string& channel : layer.channels) hash.add(channel);
            for (float v : layer.pixels) hash.add(std::bit_cast<std::uint32_t>(v));
        }
        std::printf("%016llx\n", static_cast<unsigned long long>(hash.value()));
    } catch (const std::exception& e) {
        std::fprintf(stderr, "%s\n", e.what());
        return 1;
    }
}
