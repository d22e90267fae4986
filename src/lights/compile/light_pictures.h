#pragma once
#include <cstdint>
#include <map>
#include <utility>

#include "fathom/description.h"
#include "lights/records.h"

namespace fathom {

struct Compiler;

/// What the pictures of lights were decoded to. It outlives them: lights are compiled again, pictures are not.
struct LightImages {
    struct Image {
        std::uint32_t first = 0;  ///< texel of LightTables::picture_texels
        int width = 1, height = 1;
        bool is_profile = false;                 ///< of an IES file: rows and columns are angles
        double first_angle = 0, last_angle = 0;  ///< of a profile's rows, radians
    };
    using Use = std::pair<int, ColorSpace>;
    std::map<Use, Image> by_use;
};

/// Whether the light's intensity is multiplied by a picture.
bool is_pictured(const Light& light);
/// Whether a light shows an image that is an IES file, no picture.
bool is_profile(const SceneDescription& scene, int image);

/// The texels of a picture of lights, four floats each, behind those that are there; what is below 0 or no number is 0.
/// Throws Error if they are more than lanes can number.
void add_light_image(Compiler& c, const LightImages::Use& use, int width, int height, const LargeVector<float>& texels);
/// The same of an IES file, at angles as far apart as it takes to have all of the file's.
void add_light_profile(Compiler& c, const LightImages::Use& use);

/// A light's picture, as its record and the light tree want it.
struct PicturedIntensity {
    std::uint32_t picture = 0;  ///< its number among LightTables::light_pictures, where it was added
    double factor = 1;          ///< of the light's intensity
    /// Of the product of intensity and picture, over the directions in which there is a picture: the root of the mean
    /// of squares of luminance, which a sampling density should be proportional to.
    double typical = 0;
    double outer = 4;  ///< 1 - cos of the angle from the axis beyond which there is no picture; 2 and more: all round
};
/// Throws Error where the picture can't be that of such a light.
PicturedIntensity add_light_picture(Compiler& c, const Light& light);

}  // namespace fathom
