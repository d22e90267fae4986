// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <map>
#include <utility>

#include "fathom/description.h"
#include "lights/records.h"

namespace fathom {

struct Compiler;

/// Decoded images of lights. They outlive compilation of lights: edits compile lights again, but not their images.
struct LightImages {
    struct Image {
        std::uint32_t first = 0;  ///< index of the image's first texel in LightTables::picture_texels
        int width = 1, height = 1;
        bool is_profile = false;  ///< whether the image is an IES profile, whose rows and columns are angles
        double first_angle = 0, last_angle = 0;  ///< angles of a profile's first and last row, radians
    };
    using Use = std::pair<int, ColorSpace>;
    std::map<Use, Image> by_use;
};

/// Whether an image multiplies the light's intensity.
bool is_pictured(const Light& light);
/// Whether an image file is an IES profile.
bool is_profile(const SceneDescription& scene, int image);

/// Appends the texels of an image, four floats each, to the table; negative values and NaN become 0. Throws Error if
/// the table exceeds what lanes can index.
void add_light_image(Compiler& c, const LightImages::Use& use, int width, int height, const LargeVector<float>& texels);
/// Appends an IES profile, resampled at steps that contain all angles of the file.
void add_light_profile(Compiler& c, const LightImages::Use& use);

/// Properties of a light's image for its record and the light tree.
struct PicturedIntensity {
    std::uint32_t picture = 0;  ///< index of the record added to LightTables::light_pictures
    double factor = 1;          ///< factor of the light's intensity
    /// Root mean square luminance of intensity times image over the image's directions, to which sampling densities are
    /// made proportional.
    double typical = 0;
    double outer = 4;  ///< 1 - cos of the angle from the axis that contains the image; 2 or more: all directions
};
/// Adds the record of a light's image. Throws Error if the kind of light doesn't accept the image.
PicturedIntensity add_light_picture(Compiler& c, const Light& light);

}  // namespace fathom
