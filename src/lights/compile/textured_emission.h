// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <optional>
#include <unordered_map>
#include <vector>

#include "geometry/records.h"
#include "materials/records.h"

namespace fathom {

/// Mean luminance of an emission texture on triangles, for the power of their lights. Most of the texture of many
/// models is black: without this, most light samples would be spent on triangles that emit nothing.
class TexturedEmission {
public:
    /// Reads all texels of the texture, if it is an image.
    TexturedEmission(const ShadingTables& tables, const TextureRecord& texture);

    /// Mean luminance over the blocks of texels around a triangle, which is 0 only if the whole triangle is black.
    /// Empty if it is unknown: for textures other than images that are mapped by texture coordinates.
    ///
    /// texture: with the texels of the constructor's, but perhaps other coordinates
    std::optional<double> over(const TextureRecord& texture, const GeometryTables& geometry, const ShapeRecord& shape,
                               std::uint32_t triangle) const;

private:
    /// Largest number of blocks along a side of the image.
    static constexpr int most_blocks = 512;
    /// Unit of the sums; a texel that is not black counts as one unit at least.
    static constexpr double unit = 0x1p20;
    /// Texels count as at most this bright, so that sums of 2^26 texels do not overflow.
    static constexpr double brightest = 0x1p16;

    void add_row_of_blocks(const ShadingTables& tables, const TextureRecord& image, int row);
    /// Mean over the blocks that contain these texels. x1, y1: last column and row.
    double mean(int x0, int x1, int y0, int y1) const;

    int width_, height_;  ///< in texels
    int block_;           ///< width and height of a block in texels
    int columns_, rows_;  ///< in blocks
    /// Sums of the luminance of all texels above and to the left of a corner of a block: (columns_ + 1) * (rows_ + 1)
    /// integers, since differences of rounded sums could not tell black from nearly black.
    std::vector<std::uint64_t> sums_;
};

/// By index of the texture. Images do not change in a compiled scene, so they are read once.
using TexturedEmissions = std::unordered_map<std::uint32_t, TexturedEmission>;

}  // namespace fathom
