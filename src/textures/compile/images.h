#pragma once
#include <compare>
#include <cstdint>
#include <map>
#include <string>

#include "compile/compiler.h"
#include "fathom/image.h"
#include "image/projections/cube_map.h"

namespace fathom {

/// One way to decode one picture.
struct ImageUse {
    int image;
    ColorSpace space;
    float height_scale;                                          ///< as Texture::height_scale
    enum class Purpose { texture, environment, light } purpose;  ///< textures may be packed, others remain floats

    friend auto operator<=>(const ImageUse&, const ImageUse&) = default;
};

/// An image file, as messages name it.
std::string name_of(const SceneDescription& scene, int image);

/// The texels of image files, among the tables. Each file is read once for each way to decode it; one that can't be
/// read is grey, with a warning.
///
/// All threads decode, a file each. While they do, each of them holds, beside what the tables will keep, the bytes of
/// one file and, unless those are bytes too, its values as floats (up to 16 bytes a texel); pictures that stay floats
/// are there twice until the last is among the tables. A file that fails or is too large for a thread's share of the
/// memory is read again by fewer at once, at last alone: results, warnings and errors are those of one thread.
class ImageStore {
public:
    /// Decodes what the textures and the environment of the scene show.
    explicit ImageStore(Compiler& c);

    struct Texels {
        TexelFormat format = TexelFormat::float4;
        std::uint64_t place = 0;  ///< as TextureRecord::texels
        int width = 0, height = 0;
    };
    /// In the narrowest format that holds every value exactly: four bytes a texel for pictures of 8 bits.
    Texels texture(const Texture& texture) const;
    /// Puts the environment's picture into its record, if it has one. Once.
    void set_environment(Compiler& c);
    /// Puts the pictures of lights among their tables, with the IES files among them. Once.
    void set_lights(Compiler& c);

private:
    std::map<ImageUse, Texels> texels_;
    std::map<int, CubeFace> environment_;  ///< by image: floats
    std::map<LightImages::Use, CubeFace> lights_;
};

}  // namespace fathom
