#pragma once
/// Lights as the kernel reads them.
#include <array>
#include <cstdint>
#include <vector>

#include "fathom/render.h"
#include "math/memory.h"
#include "math/no_index.h"
#include "shading/rgb.h"

namespace fathom {

enum class LightRecordKind : std::uint32_t {
    rectangle,
    parallelogram,
    triangle,
    sphere,
    disk,
    point,
    spot,
    directional,
    environment
};

/// One light, or one emissive primitive. Read by lanes as an array of 32 floats.
struct LightRecord {
    std::uint32_t kind = 0;
    float pmf = 0;           ///< probability to be chosen
    float position[3] = {};  ///< corner, centre, or place
    float edge_u[3] = {};    ///< rectangle: unit along u; spot, directional: direction that light travels
    float edge_v[3] = {};    ///< rectangle: unit along v
    float normal[3] = {};
    float length_u = 0, length_v = 0;
    float area = 0;
    float radius = 0;               ///< rectangle: its diagonal
    float radiance[channels] = {};  ///< or intensity, or irradiance
    float outer = 0;                ///< spot: 1 - cos of the half angle beyond which nothing arrives
    float falloff = 0;              ///< from there inwards, in the same measure, the light grows to its full intensity
    std::uint32_t two_sided = 0;
    std::uint32_t material = no_index;  ///< whose emission texture or alpha scales radiance, if it has one
    std::uint32_t primitive = no_index;
    std::uint32_t instance = no_index;  ///< that places the primitive, if one does
    float motion_or_center[3] = {};     ///< sphere: its motion in a second; rectangle: its centre
    float unused[2] = {};
};
static_assert(sizeof(LightRecord) == 32 * sizeof(float));

struct EnvironmentRecord {
    std::uint32_t kind = 0;  ///< EnvironmentKind
    std::uint32_t light = no_index;
    Rgb color{}, bottom{}, top{};
    std::array<float, 9> environment_from_render{1, 0, 0, 0, 1, 0, 0, 0, 1};
    LargeVector<float> texels;  ///< of an image: four floats each
    int width = 0, height = 0;
    double mean_luminance = 0;  ///< of an image that lights are sampled from; else 0
    /// Image: cumulative distributions for sampling, rows then columns: (height + 1) and height * (width + 1) floats.
    LargeVector<float> marginal, conditional;
    LargeVector<std::uint32_t> marginal_guide, conditional_guides;  ///< see make_guides
};

struct LightTables {
    std::vector<LightRecord> lights;
    std::vector<float> light_cdf;  ///< lights + 1 values, 0 to 1
    EnvironmentRecord environment;
};

}  // namespace fathom
