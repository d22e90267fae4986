#pragma once
#include <cstdint>
#include <map>
#include <utility>

#include "compile/compiler.h"
#include "fathom/image.h"

namespace fathom {

/// The texels of image files, among the tables. Each file is read once for each way to decode it; one that can't be read
/// is grey, with a warning.
class ImageStore {
public:
    explicit ImageStore(Compiler& c);

    struct Texels {
        TexelFormat format = TexelFormat::float4;
        std::uint64_t place = 0;  ///< as TextureTable::texels
        int width = 0, height = 0;
    };
    /// In the narrowest format that holds every value exactly: four bytes a texel for pictures of 8 bits.
    Texels texture(int image, ColorSpace space);
    /// In four floats a texel, which environments are looked up in.
    Texels environment(int image);

private:
    Texels read(int image, ColorSpace space, bool may_pack);
    bool pack(const Image& image, TexelFormat format);
    std::uint64_t append_floats(const Image& image, bool decode);
    void check_memory(double bytes) const;

    Compiler& c_;
    std::map<std::pair<int, ColorSpace>, Texels> textures_;
};

}  // namespace fathom
