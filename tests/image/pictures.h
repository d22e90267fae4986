// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <unistd.h>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "fathom/image.h"

namespace fathom::test {

/// A temporary folder, removed with its contents at the end.
class TemporaryFolder {
public:
    TemporaryFolder()
    {
        static int count = 0;
        path_ = std::filesystem::temp_directory_path() /
                ("fathom-test-" + std::to_string(getpid()) + "-" + std::to_string(count++));
        std::filesystem::create_directories(path_);
    }
    ~TemporaryFolder()
    {
        std::error_code error;
        std::filesystem::remove_all(path_, error);
    }
    const std::filesystem::path& path() const { return path_; }
    std::size_t files() const
    {
        return std::size_t(
            std::distance(std::filesystem::directory_iterator(path_), std::filesystem::directory_iterator()));
    }

private:
    std::filesystem::path path_;
};

inline std::vector<char> bytes_of(const std::filesystem::path& file)
{
    std::ifstream in(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
}

/// A layer of distinct values from 0 to `top`. Channel A, if there is one, has values from 0 to 1, and color is
/// premultiplied.
inline Image::Layer make_test_layer(const std::string& name, const std::vector<std::string>& channels, int width,
                                    int height, float top = 1)
{
    Image::Layer layer{name, channels, {}};
    std::uint32_t state = 12345;
    for (int i = 0; i < width * height; ++i) {
        std::vector<float> pixel;
        for (std::size_t c = 0; c < channels.size(); ++c) {
            state = state * 1664525u + 1013904223u;
            pixel.push_back(float(state >> 8) * 0x1p-24f * (channels[c] == "A" ? 1 : top));
        }
        if (channels.back() == "A")
            for (std::size_t c = 0; c + 1 < channels.size(); ++c) pixel[c] *= pixel.back();
        layer.pixels.insert(layer.pixels.end(), pixel.begin(), pixel.end());
    }
    return layer;
}

inline Image make_test_image(int width, int height, const std::vector<std::string>& channels = {"R", "G", "B"},
                             float top = 1)
{
    Image image;
    image.width = width;
    image.height = height;
    image.layers.push_back(make_test_layer("", channels, width, height, top));
    return image;
}

/// sRGB encoding by the formula of IEC 61966-2-1.
inline double srgb(double linear)
{
    if (!(linear > 0)) return 0;
    if (linear >= 1) return 1;
    return linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1 / 2.4) - 0.055;
}

}  // namespace fathom::test
