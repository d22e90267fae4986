// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <compare>
#include <cstdint>
#include <map>
#include <string>

#include "compile/compiler.h"
#include "fathom/image.h"
#include "image/projections/cube_map.h"

namespace fathom {

/// A way to decode an image. Each distinct ImageUse is decoded once.
struct ImageUse {
    int image;
    ColorSpace space;
    float height_scale;  ///< see Texture::height_scale
    enum class Purpose {
        texture,
        environment,
        light
    } purpose;  ///< images of textures may be packed; others stay floats

    friend auto operator<=>(const ImageUse&, const ImageUse&) = default;
};

/// Name of an image file for messages.
std::string name_of(const SceneDescription& scene, int image);

/// Decoded texels of image files, stored in the scene's tables. Each distinct ImageUse is decoded once; a file that
/// can't be read becomes gray, with a warning.
///
/// All threads decode, one file each. Beside the tables' own storage a thread holds the bytes of one file and, unless
/// those are used directly, its values as floats (up to 16 bytes per texel). Images that stay floats exist twice until
/// the last one is in the tables. A file that fails or exceeds a thread's share of the memory is decoded again by fewer
/// threads, finally by one: results, warnings and errors are those of one thread.
class ImageStore {
public:
    /// Decodes all images that the scene's textures, environment and lights use. Throws Error if memory is short.
    explicit ImageStore(Compiler& c);

    /// Location and size of a texture's texels.
    struct Texels {
        TexelFormat format = TexelFormat::float4;
        std::uint64_t place = 0;  ///< see TextureRecord::texels
        int width = 0, height = 0;
    };
    /// Texels of a texture, in the smallest format that holds every value exactly: 4 bytes per texel for 8-bit images.
    Texels texture(const Texture& texture) const;
    /// Moves the environment's image into its record, if it has one. Call it at most once.
    void set_environment(Compiler& c);
    /// Moves the images of lights into the light tables, and adds IES profiles. Call it at most once.
    void set_lights(Compiler& c);

private:
    std::map<ImageUse, Texels> texels_;
    std::map<int, CubeFace> environment_;  ///< by image index; texels are floats
    std::map<LightImages::Use, CubeFace> lights_;
};

}  // namespace fathom
