// SPDX-License-Identifier: Apache-2.0
/// Conversion of BSDFs that combine two others.
#include <fmt/format.h>

#include <utility>

#include "fathom/error.h"
#include "formats/common/alpha_blend.h"
#include "formats/mitsuba/reader.h"

namespace fathom::mitsuba {

namespace {

bool is_plain(const Material& m)
{
    return m.kind == MaterialKind::diffuse && m.normal_map.texture < 0 && m.bump.texture < 0 &&
           m.roughness.value == 0 && m.opacity.mode == AlphaMode::opaque;
}
/// Whether both are Lambertian without other effects: their mixture is a single material of the mean color.
bool are_plain(const Material& a, const Material& b)
{
    return is_plain(a) && is_plain(b) && a.visibility.black_back == b.visibility.black_back;
}

}  // namespace

Material Reader::read_nested(Object& bsdf)
{
    const std::vector<const Element*> nested = bsdf.children("bsdf");
    if (nested.empty()) bsdf.element().fail(fmt::format("{} needs a nested bsdf", bsdf.title()));
    return scene_.materials[std::size_t(material(*nested[0]))];
}

Material Reader::two_sided(Object& bsdf)
{
    const bool outer = std::exchange(two_sided_, true);
    Material m = read_nested(bsdf);
    const std::vector<const Element*> nested = bsdf.children("bsdf");
    if (nested.size() > 1 || has_normal_perturbation(m)) {
        Material both;
        both.kind = MaterialKind::two_sided;
        if (nested.size() == 1) {
            both.opacity.mode = std::exchange(m.opacity.mode, AlphaMode::opaque);
            both.opacity.alpha = std::exchange(m.opacity.alpha, FloatInput{1, -1, 3});
        }
        both.mixture.material_a = nested.size() > 1 ? material(*nested[0]) : add_material(m);
        if (nested.size() > 1) m = scene_.materials[std::size_t(material(*nested[1]))];
        both.mixture.material_b = has_normal_perturbation(m) || nested.size() == 1
                                      ? add_material(bumps_for_back_side(m))
                                      : material(*nested[1]);
        m = both;
    }
    two_sided_ = outer;
    return m;
}

Material Reader::blend(Object& bsdf)
{
    const std::vector<const Element*> nested = bsdf.children("bsdf");
    if (nested.size() != 2) bsdf.element().fail("a 'blendbsdf' needs two nested bsdfs");
    const FloatInput weight = number_or_texture(bsdf, "weight", 0.5f);
    Material mixture;
    mixture.kind = MaterialKind::mix;
    mixture.mixture.factor = weight;
    mixture.mixture.material_a = material(*nested[0]), mixture.mixture.material_b = material(*nested[1]);
    const Material& a = scene_.materials[std::size_t(mixture.mixture.material_a)];
    const Material& b = scene_.materials[std::size_t(mixture.mixture.material_b)];
    if (weight.texture < 0 && (weight.value <= 0 || weight.value >= 1)) return weight.value >= 1 ? b : a;
    if (is_null_interface(b)) return blend_with_transparent(scene_, a, weight, true);
    if (is_null_interface(a)) return blend_with_transparent(scene_, b, weight, false);
    if (are_plain(a, b)) {
        Material out = a;
        Texture mix;
        mix.kind = TextureKind::mix;
        mix.color_a = a.base_color, mix.color_b = b.base_color, mix.factor = weight;
        out.base_color = {{1, 1, 1}, int(scene_.textures.size())};
        scene_.textures.push_back(mix);
        return out;
    }
    const bool is_opaque = a.opacity.mode == AlphaMode::opaque && b.opacity.mode == AlphaMode::opaque;
    return is_opaque ? mixture : combine_opacity(std::move(mixture));
}

}  // namespace fathom::mitsuba
