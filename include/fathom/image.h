#pragma once
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "fathom/export.h"

namespace fathom {

/// Named float channels of equal size, row by row from the top left.
struct Image {
    struct Layer {
        std::string name;                   ///< "" for the picture itself; "albedo", "normal", ...
        std::vector<std::string> channels;  ///< "R", "G", "B", "A", "X", "Y", "Z", ...
        std::vector<float> pixels;          ///< width * height * channels.size(), interleaved
    };
    int width = 0, height = 0;
    std::vector<Layer> layers;
    std::map<std::string, std::string> attributes;  ///< settings, seed, timings: kept by EXR

    const Layer* find(const std::string& name) const
    {
        for (const Layer& layer : layers)
            if (layer.name == name) return &layer;
        return nullptr;
    }
};

enum class Tonemap { srgb, filmic };

/// How linear radiance becomes the values of PNG and JPEG.
struct DisplayTransform {
    double exposure_ev = 0;
    Tonemap tonemap = Tonemap::srgb;
};

struct WriteOptions {
    DisplayTransform display;
    int png_bits = 8;          ///< 8 or 16
    bool exr_half = false;     ///< half instead of float
    int jpeg_quality = 95;
};

/// Throws Error if the extension names no format that can be written, before anything is rendered.
FATHOM_API void check_output(const std::filesystem::path& file);

/// Writes EXR (all layers), PNG, JPEG or HDR (first layer) by extension: beside its place, then renamed into it. Throws Error;
/// an earlier file then still stands.
FATHOM_API void write_image(const std::filesystem::path& file, const Image& image, const WriteOptions& options);

/// 8-bit sRGB RGBA of the layer, for PNG, JPEG and windows.
FATHOM_API std::vector<unsigned char> to_display(const Image::Layer& layer, int width, int height, const DisplayTransform& display);

/// Reads EXR, PNG, JPEG, WebP, HDR and what stb_image knows; 8- and 16-bit values become 0 to 1 and stay encoded as they are.
FATHOM_API Image read_image(const std::filesystem::path& file);
FATHOM_API Image read_image(const std::string& name, const void* bytes, std::size_t size);

}  // namespace fathom
