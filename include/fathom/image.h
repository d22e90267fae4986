// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "fathom/api.h"
#include "fathom/vector.h"

namespace fathom {

/// Primaries and white point of an RGB color space, as CIE 1931 x and y.
struct Chromaticities {
    Vec2f red, green, blue, white;  ///< Chromaticities of the three primaries and of white.
};

/// An image: layers of named float channels of equal size. Pixels are stored row by row from the top left.
struct Image {
    /// Channels that belong together.
    struct Layer {
        std::string name;  ///< Name of the layer: empty for the image itself; "albedo", "normal", "denoised", ...
        std::vector<std::string> channels;  ///< Names of the channels, such as "R", "G", "B", "A".
        std::vector<float> pixels;          ///< Pixel values: width * height * channels.size(), interleaved.

        /// Returns whether the layer holds colors: its channels are R, G, B or A, and its values not those of noise
        /// ("variance" and "error"), which can't be converted between color spaces.
        bool is_color() const
        {
            return name != "variance" && name != "error" &&
                   std::all_of(channels.begin(), channels.end(),
                               [](const std::string& c) { return c == "R" || c == "G" || c == "B" || c == "A"; });
        }
    };
    /// A channel of integers that a float would round. Only EXR files keep it.
    struct UintChannel {
        std::string name;                   ///< Name of the channel.
        std::vector<std::uint32_t> values;  ///< Pixel values: width * height.
    };
    int width = 0, height = 0;  ///< Size in pixels.
    /// Set by read_image(): true if values are linear (EXR, HDR, PFM), false if they are encoded, usually as sRGB.
    bool is_linear = false;
    /// Set by read_image(): the color space that an EXR or HDR file states. Empty means Rec.709.
    std::optional<Chromaticities> chromaticities;
    std::vector<Layer> layers;                      ///< Layers; the first one is the image itself.
    std::vector<UintChannel> uint_channels;         ///< Integer channels.
    std::map<std::string, std::string> attributes;  ///< Text by name, such as settings and seed. Only EXR keeps it.

    /// Returns the layer of that name, or null if there is none.
    const Layer* find(const std::string& name) const
    {
        for (const Layer& layer : layers)
            if (layer.name == name) return &layer;
        return nullptr;
    }
};

/// Tone curve that maps exposed radiance to display values from 0 to 1, which are then encoded as sRGB (IEC 61966-2-1).
enum class Tonemap {
    srgb,             ///< No curve; values above 1 are clipped.
    filmic,           ///< K. Narkowicz 2016, fit of the ACES filmic curve, for each channel.
    agx,              ///< AgX by T. Sobotka with the curve of B. Wrensch: film-like; bright colors turn white.
    khronos_neutral,  ///< Khronos PBR Neutral: keeps the colors of surfaces and compresses highlights.
    aces,             ///< S. Hill's fit of ACES, with the exposure multiplied by 1 / 0.6.
};
/// Names of each Tonemap in options and scene files, indexed by its value.
inline constexpr const char* tonemap_names[] = {"srgb", "filmic", "agx", "khronos-neutral", "aces"};

class OcioView;  // defined in fathom/ocio.h

/// Conversion of linear radiance to the display values of PNG, JPEG, WebP and AVIF.
struct DisplayTransform {
    double exposure_ev = 0;           ///< Exposure in stops; radiance is multiplied by 2^exposure_ev first.
    Tonemap tonemap = Tonemap::srgb;  ///< Tone curve.
    /// OpenColorIO view that replaces the tone curve and the sRGB encoding; null: none.
    std::shared_ptr<const OcioView> ocio = {};
    /// Color temperature in kelvin, min_white_kelvin to max_white_kelvin, that is shown as white; empty: no white
    /// balance.
    std::optional<double> white_kelvin = {};
};

/// Primaries of the colors in an EXR file: linear Rec.709, or ACEScg (AP1 with the ACES white point).
enum class Primaries { rec709, acescg };
/// Names of each Primaries in options, indexed by its value.
inline constexpr const char* primaries_names[] = {"rec709", "acescg"};

/// Settings of write_image(). Each format uses those that apply to it.
struct WriteOptions {
    std::string format = {};                      ///< Format of the file, such as "png"; empty: by its extension.
    DisplayTransform display;                     ///< PNG, JPEG, WebP, AVIF: conversion to display values.
    int png_bits = 8;                             ///< Bits per channel of PNG, 8 or 16.
    Primaries exr_primaries = Primaries::rec709;  ///< Primaries that EXR colors are converted to.
    /// Writes the color layers of EXR files as half if all values fit. Ids, distances and variances are always float.
    bool exr_half = false;
    int jpeg_quality = 95;                 ///< Quality of JPEG, 1 to 100.
    std::optional<int> webp_quality = {};  ///< Quality of WebP, 1 to 100; empty: lossless.
    int avif_quality = 95;                 ///< Quality of AVIF, 1 to 100; 100 is lossless.
};

/// Checks that an image can be written, which is useful before a long render.
///
/// file           Name of the image file to be written. The check creates and removes a temporary file beside it.
/// width, height  Size of the image in pixels; 0 if unknown.
/// format         Format of the file, such as "png"; empty: by its extension.
///
/// Throws Error if the format is unknown, the format can't hold an image of this size, or no file can be created in
/// the folder.
FATHOM_API void check_output(const std::filesystem::path& file, int width = 0, int height = 0,
                             const std::string& format = {});

/// Writes an image in the format given by the options or the extension: .exr, .png, .jpg or .jpeg, .webp, .avif or
/// .hdr. EXR contains everything; the other formats contain the first layer. `/dev/stdout` is the standard output.
///
/// Colors with A are premultiplied in `image` and in EXR. They are not premultiplied in PNG, WebP and AVIF, and blended
/// with black in JPEG and HDR. The file is written atomically: to a temporary file, which is synced and then renamed.
/// Throws Error if that fails, or if the layers don't have the size of the image; an earlier file then remains.
FATHOM_API void write_image(const std::filesystem::path& file, const Image& image, const WriteOptions& options);

/// Returns the bytes of a PNG file of the first layer, for documents that contain their images. Throws Error if the
/// layers don't have the size of the image, or PNG can't hold it.
FATHOM_API std::vector<unsigned char> encode_png_image(const Image& image, const WriteOptions& options);

/// Converts a layer to 8-bit sRGB pixels for a window.
///
/// layer          Linear colors, premultiplied if there is a channel A. Red, green and blue are found by the names R, G
///                and B; otherwise they are the first three channels, or the first one for all if there are fewer.
/// width, height  Size of the layer in pixels.
/// display        Exposure and tone mapping.
///
/// Returns width * height * 4 bytes: R, G, B, A, not premultiplied. NaN becomes black.
FATHOM_API std::vector<unsigned char> to_display(const Image::Layer& layer, int width, int height,
                                                 const DisplayTransform& display);

/// Reads an image: EXR, PNG, JPEG, WebP, AVIF, HDR, PFM, KTX2, and the formats of stb_image. The format is recognized
/// by content.
///
/// file          Name of the file.
/// memory_limit  Maximum number of bytes of the decoded image. Callers that read several images at once divide the
///               available memory among them.
///
/// Integers are scaled to 0 to 1 and keep their encoding (see Image::is_linear). The layer has the channels R G B A,
/// R G B, Y A or Y (gray). An EXR has the layers of the file, the image first, cut to its display window. Throws Error
/// if the file is missing, damaged or truncated, or needs more memory than is available.
FATHOM_API Image read_image(const std::filesystem::path& file, std::uint64_t memory_limit = ~std::uint64_t(0));
/// Reads an image from the `size` bytes of an encoded file in memory, as read_image() above does. `name` is the name of
/// the image in error messages.
FATHOM_API Image read_image(const std::string& name, const void* bytes, std::size_t size,
                            std::uint64_t memory_limit = ~std::uint64_t(0));

/// Returns width and height of an image file in pixels, without decoding it. Returns nothing if the file is missing,
/// damaged, or not an image.
FATHOM_API std::optional<std::array<std::uint64_t, 2>> image_size(const std::filesystem::path& file);
/// Returns width and height of an encoded image of `size` bytes in memory, or nothing if it is damaged or not an image.
FATHOM_API std::optional<std::array<std::uint64_t, 2>> image_size(const std::string& name, const void* bytes,
                                                                  std::size_t size);

/// Returns names and versions of the libraries that read and write images, such as "libpng 1.6.39".
FATHOM_API std::vector<std::string> image_libraries();

}  // namespace fathom
