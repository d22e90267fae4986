#pragma once
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

/// Where the primaries and white of colours are, in x and y of CIE 1931.
struct Chromaticities {
    Vec2f red, green, blue, white;
};

/// Named float channels of equal size, row by row from the top left.
struct Image {
    struct Layer {
        std::string name;                   ///< "" for the picture itself; "albedo", "normal", ...
        std::vector<std::string> channels;  ///< "R", "G", "B", "A", "X", "Y", "Z", ...
        std::vector<float> pixels;          ///< width * height * channels.size(), interleaved
    };
    /// Integers that a float would round; kept by EXR only.
    struct UintChannel {
        std::string name;
        std::vector<std::uint32_t> values;  ///< width * height
    };
    int width = 0, height = 0;
    bool is_linear = false;  ///< of a picture that was read: its values are radiance (EXR, HDR, PFM), not encoded
    /// Primaries that an EXR or HDR file states for its colors; without them the colors are Rec.709.
    std::optional<Chromaticities> chromaticities;
    std::vector<Layer> layers;
    std::vector<UintChannel> uint_channels;
    std::map<std::string, std::string> attributes;  ///< settings, seed, timings: kept by EXR

    const Layer* find(const std::string& name) const
    {
        for (const Layer& layer : layers)
            if (layer.name == name) return &layer;
        return nullptr;
    }
};

/// How radiance becomes what a display shows, which is encoded as sRGB (IEC 61966-2-1) afterwards.
enum class Tonemap {
    srgb,             ///< as it is, up to 1
    filmic,           ///< Narkowicz's fit of the ACES curve (ACES Filmic Tone Mapping Curve, 2016), channel by channel
    agx,              ///< Sobotka's AgX with Wrensch's curve: film-like, bright colours go to white
    khronos_neutral,  ///< the PBR Neutral Tone Mapper of Khronos: colours of surfaces are kept, highlights compressed
    aces,             ///< Hill's fit of ACES, at 1 / 0.6 the exposure
};
/// What options and scene files call them.
inline constexpr const char* tonemap_names[] = {"srgb", "filmic", "agx", "khronos-neutral", "aces"};

class OcioView;  // fathom/ocio.h

/// How linear radiance becomes the values of PNG, JPEG, WebP and AVIF.
struct DisplayTransform {
    double exposure_ev = 0;
    Tonemap tonemap = Tonemap::srgb;
    std::shared_ptr<const OcioView> ocio = {};  ///< instead of the tone map, and of what encodes as sRGB
    std::optional<double> white_kelvin = {};    ///< 1000 to 25000: light of this temperature is shown as white
};

/// What red, green and blue of an EXR are.
enum class Primaries { rec709, acescg };
/// What options call them.
inline constexpr const char* primaries_names[] = {"rec709", "acescg"};

struct WriteOptions {
    DisplayTransform display;
    int png_bits = 8;  ///< 8 or 16
    Primaries exr_primaries = Primaries::rec709;
    bool exr_half = false;  ///< half for the layers of colours that fit; ids, distances and variances stay float
    int jpeg_quality = 95;
    std::optional<int> webp_quality = {};  ///< 1 to 100; none: lossless
    int avif_quality = 95;                 ///< 1 to 100, which is lossless
};

/// Throws Error, before anything is rendered, if the extension names no format that can be written, if the format can't
/// hold a picture of this size (where one is given), or if no file can be made in that folder.
FATHOM_API void check_output(const std::filesystem::path& file, int width = 0, int height = 0);

/// Writes EXR (everything), PNG, JPEG, WebP, AVIF or HDR (first layer) by extension: beside its place, then renamed
/// into it. Throws Error; an earlier file then still stands. Colours with A are premultiplied in `image` and in EXR,
/// straight in PNG, WebP and AVIF, over black in JPEG and HDR.
FATHOM_API void write_image(const std::filesystem::path& file, const Image& image, const WriteOptions& options);

/// 8-bit sRGB RGBA of the layer, straight alpha, for windows: R, G, B by name, else the first three channels, else the
/// first one as grey. NaN is black.
FATHOM_API std::vector<unsigned char> to_display(const Image::Layer& layer, int width, int height,
                                                 const DisplayTransform& display);

/// Reads EXR, PNG, JPEG, WebP, AVIF, HDR, PFM and what stb_image knows, told by content; 8- to 16-bit values become 0
/// to 1 and stay encoded. Layers have the channels R G B A, R G B, Y A or Y (gray); an EXR's are those of the file, the
/// image first, in its display window. Throws Error if the file is missing, damaged, cut short, or larger than the
/// memory at hand or the limit, which is for those who read several at once.
FATHOM_API Image read_image(const std::filesystem::path& file, std::uint64_t memory_limit = ~std::uint64_t(0));
/// The same for a file in memory; `name` is for messages.
FATHOM_API Image read_image(const std::string& name, const void* bytes, std::size_t size,
                            std::uint64_t memory_limit = ~std::uint64_t(0));

/// Width and height, by the head of the file alone; nothing where it is missing, no picture, or damaged.
FATHOM_API std::optional<std::array<std::uint64_t, 2>> image_size(const std::filesystem::path& file);
FATHOM_API std::optional<std::array<std::uint64_t, 2>> image_size(const std::string& name, const void* bytes,
                                                                  std::size_t size);

/// Names and versions of the libraries that read and write pictures.
FATHOM_API std::vector<std::string> image_libraries();

}  // namespace fathom
