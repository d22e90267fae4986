// SPDX-License-Identifier: Apache-2.0
/// Opacity, blends and emission. In Mitsuba, opacity affects scattering only: an emitter emits its full radiance to the
/// front, however transparent its BSDF is.
#include <utility>

#include "formats/common/alpha_blend.h"
#include "formats/mitsuba/reader.h"

namespace fathom::mitsuba {

namespace {

/// A thin sheet that transmits light unchanged but can emit.
Material transparent_sheet()
{
    Material m;
    m.kind = MaterialKind::glass;
    m.interior.thin = true;
    m.ior = 1;
    m.roughness = {0, -1, 0};
    m.base_color = {{1, 1, 1}, -1};
    m.microfacets.energy_compensation = false;
    return m;
}

bool is_opaque(const Material& m)
{
    return m.opacity.mode == AlphaMode::opaque;
}

}  // namespace

/// Mixes the material with a clear sheet by its alpha, so that alpha doesn't scale its emission.
Material Reader::mix_with_clear_sheet(Material m)
{
    Material mixture;
    mixture.kind = MaterialKind::mix;
    mixture.mixture.factor = m.opacity.alpha;
    mixture.mixture.material_a = add_material(transparent_sheet());
    m.opacity.alpha = {1, -1, 3}, m.opacity.mode = AlphaMode::opaque;
    mixture.mixture.material_b = add_material(std::move(m));
    return mixture;
}

Material Reader::with_emission(Material m, ColorInput emission)
{
    // For a small alpha, few rays would hit an emitter whose radiance is scaled up by 1 / alpha.
    constexpr float min_alpha = 0.1f;
    if (is_null_interface(m)) {
        m = transparent_sheet();
    } else if (!is_opaque(m) && m.opacity.alpha.texture < 0 && m.opacity.alpha.value >= min_alpha) {
        const float by = 1 / std::min(m.opacity.alpha.value, 1.f);
        emission.value = {emission.value.r * by, emission.value.g * by, emission.value.b * by};
    } else if (!is_opaque(m)) {
        m = mix_with_clear_sheet(std::move(m));
    }
    m.emission.radiance = emission;
    return m;
}

/// Combines the opacities of a mixture's two materials, of which at least one is transparent.
Material Reader::combine_opacity(Material mixture)
{
    Material &a = scene_.materials[std::size_t(mixture.mixture.material_a)],
             &b = scene_.materials[std::size_t(mixture.mixture.material_b)];
    const auto alpha_of = [](const Material& m) { return is_opaque(m) ? FloatInput{1, -1, 0} : m.opacity.alpha; };
    const FloatInput alpha_a = alpha_of(a), alpha_b = alpha_of(b);
    const bool is_alike = alpha_a.texture == alpha_b.texture && alpha_a.value == alpha_b.value &&
                          (alpha_a.texture < 0 || alpha_a.channel == alpha_b.channel);
    mixture.opacity.mode = AlphaMode::blend;
    if (is_alike) {
        mixture.opacity.alpha = alpha_a;
        return mixture;
    }
    if (alpha_a.texture < 0 && alpha_b.texture < 0 && mixture.mixture.factor.texture < 0) {
        const float weight = mixture.mixture.factor.value, of_b = weight * alpha_b.value;
        mixture.opacity.alpha = {(1 - weight) * alpha_a.value + of_b, -1, 0};
        mixture.mixture.factor.value = mixture.opacity.alpha.value > 0 ? of_b / mixture.opacity.alpha.value : weight;
        return mixture;
    }
    mixture.opacity.mode = AlphaMode::opaque;
    for (int* part : {&mixture.mixture.material_a, &mixture.mixture.material_b})
        if (const Material m = scene_.materials[std::size_t(*part)]; !is_opaque(m))
            *part = add_material(mix_with_clear_sheet(m));
    return mixture;
}

}  // namespace fathom::mitsuba
