// SPDX-License-Identifier: Apache-2.0
#include "materials/compile/layers.h"

#include <algorithm>
#include <cmath>

namespace fathom {

namespace {

bool is_positive(const FloatInput& input)
{
    return input.value > 0;
}
float max_of(const Color& c)
{
    return std::max({c.r, c.g, c.b});
}
bool is_positive(const ColorInput& input)
{
    return max_of(input.value) > 0;
}
bool is_white(const ColorInput& input)
{
    return input.texture < 0 && input.value.r == 1 && input.value.g == 1 && input.value.b == 1;
}
bool is_one(const FloatInput& input)
{
    return input.texture < 0 && input.value == 1;
}

std::uint32_t features_of(const Material& m)
{
    std::uint32_t features = 0;
    const auto add = [&](bool has, LayersRecord::Features feature) { features |= has ? std::uint32_t(feature) : 0u; };
    const bool is_coated = is_positive(m.coat.weight), transmits = is_positive(m.transmission.weight);
    add(is_positive(m.sheen.color), LayersRecord::with_sheen);
    add(is_positive(m.sheen.color) && m.sheen.reciprocal, LayersRecord::sheen_reciprocal);
    add(is_coated, LayersRecord::with_coat);
    add(is_positive(m.thin_film.weight) && is_positive(m.thin_film.thickness), LayersRecord::with_thin_film);
    add(transmits, LayersRecord::with_transmission);
    add(is_positive(m.diffuse_transmission.weight), LayersRecord::with_diffuse_transmission);
    add(is_positive(m.diffuse_transmission.weight) && m.diffuse_transmission.added,
        LayersRecord::diffuse_transmission_added);
    add(is_positive(m.subsurface.weight) && !m.interior.thin, LayersRecord::with_subsurface);
    add(is_positive(m.diffuse_roughness), LayersRecord::rough_diffuse);
    add(is_positive(m.microfacets.anisotropy) || m.microfacets.two_roughnesses, LayersRecord::anisotropic);
    add(m.microfacets.two_roughnesses, LayersRecord::two_roughnesses);
    add(is_positive(m.metallic) && max_of(m.conductor.k) > 0, LayersRecord::with_conductor);
    add(m.microfacets.energy_compensation, LayersRecord::energy_compensation);
    add(is_coated && m.coat.normal_texture >= 0, LayersRecord::coat_normal_mapped);
    add(transmits && m.transmission.dispersion > 0, LayersRecord::disperses);
    return features;
}

/// Features that glass and principled closures have themselves; any other needs a layered closure.
constexpr std::uint32_t plain = LayersRecord::energy_compensation | LayersRecord::with_transmission;

NumberRecord number(const FloatInput& input)
{
    return {input.value, texture_id(input.texture), std::uint32_t(input.channel)};
}
ColorRecord color(const ColorInput& input)
{
    return {spectrum(input.value), texture_id(input.texture)};
}

/// Fresnel reflectance of a boundary to a medium of index ior, for unpolarized light.
double fresnel(double cosine, double ior)
{
    const double t = std::sqrt(std::max(0.0, 1 - (1 - cosine * cosine) / (ior * ior)));
    const double p = (ior * cosine - t) / (ior * cosine + t), s = (cosine - ior * t) / (cosine + ior * t);
    return (p * p + s * s) / 2;
}

/// Internal reflectance of a boundary for diffuse light: 1 - (1 - mean) / ior^2 by reciprocity, where mean is the
/// external reflectance for diffuse light.
double inner_reflectance(double ior)
{
    constexpr int steps = 256;
    double mean = 0;
    for (int i = 0; i < steps; ++i) {
        const double cosine = (i + 0.5) / steps;
        mean += 2 * fresnel(cosine, ior) * cosine / steps;
    }
    return 1 - (1 - mean) / (ior * ior);
}

bool is_textured(const auto&... inputs)
{
    return ((inputs.texture != no_index) || ...);
}

}  // namespace

double internal_absorption(double ior, double optical_thickness)
{
    if (!(optical_thickness > 0)) return 0;
    constexpr int steps = 2048;
    double all = 0, left = 0;
    for (int i = 0; i < steps; ++i) {
        const double cosine = (i + 0.5) / steps, sine2 = (1 - cosine * cosine) * ior * ior;
        const double sent_back = sine2 < 1 ? fresnel(std::sqrt(1 - sine2), ior) : 1;
        all += sent_back * cosine;
        left += sent_back * cosine * std::exp(-2 * optical_thickness / cosine);
    }
    return 1 - left / all;
}

ClosureKind closure_of_layers(const Material& m)
{
    const std::uint32_t features = features_of(m);
    const bool is_plain = (features & ~plain) == 0 && is_one(m.specular.weight) && is_white(m.specular.color) &&
                          is_white(m.conductor.edge_color);
    const bool is_metal = is_positive(m.metallic);
    if (is_plain && is_one(m.transmission.weight) && !is_metal) return ClosureKind::glass;
    if (features &
        (LayersRecord::with_transmission | LayersRecord::with_diffuse_transmission | LayersRecord::with_subsurface))
        return ClosureKind::layered_transmitting;
    return is_plain ? ClosureKind::principled : ClosureKind::layered;
}

LayersRecord compile_layers(const Material& m, double render_scale)
{
    LayersRecord t;
    t.features = features_of(m);
    t.specular = number(m.specular.weight), t.anisotropy = number(m.microfacets.anisotropy),
    t.transmission = number(m.transmission.weight);
    t.diffuse_transmission = number(m.diffuse_transmission.weight), t.diffuse_roughness = number(m.diffuse_roughness);
    t.coat = number(m.coat.weight), t.coat_roughness = number(m.coat.roughness);
    t.sheen_roughness = number(m.sheen.roughness), t.subsurface = number(m.subsurface.weight);
    t.thin_film = number(m.thin_film.weight), t.thin_film_thickness = number(m.thin_film.thickness);
    t.specular_color = color(m.specular.color), t.edge_color = color(m.conductor.edge_color);
    t.transmission_color = color(m.transmission.color);
    t.diffuse_transmission_color = color(m.diffuse_transmission.color);
    t.coat_color = color(m.coat.color), t.sheen_color = color(m.sheen.color);
    t.subsurface_color = color(m.subsurface.color), t.subsurface_radius_scale = color(m.subsurface.radius_scale);
    t.subsurface_radius = number(m.subsurface.radius);
    t.subsurface_radius.value = float(double(m.subsurface.radius.value) * render_scale);
    t.conductor_eta = spectrum(m.conductor.eta), t.conductor_k = spectrum(m.conductor.k);
    t.anisotropy_cos = float(std::cos(m.microfacets.anisotropy_rotation)),
    t.anisotropy_sin = float(std::sin(m.microfacets.anisotropy_rotation));
    t.anisotropy_texture = texture_id(m.microfacets.anisotropy_texture);
    t.dispersion = m.transmission.dispersion;
    t.coat_f0 = float(fresnel(1, m.coat.ior)), t.coat_inner = float(inner_reflectance(m.coat.ior));
    t.coat_darkening = m.coat.darkening;
    t.coat_normal_texture = texture_id(m.coat.normal_texture), t.coat_normal_scale = m.coat.normal_scale;
    t.thin_film_ior = m.thin_film.ior;
    if (is_textured(t.specular, t.anisotropy, t.transmission, t.diffuse_transmission, t.diffuse_roughness, t.coat,
                    t.coat_roughness, t.sheen_roughness, t.thin_film, t.thin_film_thickness, t.specular_color,
                    t.edge_color, t.transmission_color, t.diffuse_transmission_color, t.coat_color, t.sheen_color,
                    t.subsurface, t.subsurface_color, t.subsurface_radius, t.subsurface_radius_scale))
        t.features |= LayersRecord::textured;
    return t;
}

ClosureKind closure_of_disney(const Material& m)
{
    const bool passes =
        is_positive(m.transmission.weight) || (m.interior.thin && is_positive(m.diffuse_transmission.weight));
    return passes ? ClosureKind::disney_transmitting : ClosureKind::disney;
}

DisneyRecord compile_disney(const Material& m)
{
    DisneyRecord t;
    t.anisotropy = number(m.microfacets.anisotropy), t.flatness = number(m.disney.flatness),
    t.specular_tint = number(m.disney.specular_tint);
    t.sheen = number(m.disney.sheen), t.sheen_tint = number(m.disney.sheen_tint);
    t.coat = number(m.coat.weight), t.coat_gloss = number(m.disney.coat_gloss);
    t.transmission = number(m.transmission.weight), t.diffuse_transmission = number(m.diffuse_transmission.weight);
    if (is_positive(m.microfacets.anisotropy)) t.features |= DisneyRecord::anisotropic;
    if (is_textured(t.anisotropy, t.flatness, t.specular_tint, t.sheen, t.sheen_tint, t.coat, t.coat_gloss,
                    t.transmission, t.diffuse_transmission))
        t.features |= DisneyRecord::textured;
    return t;
}

}  // namespace fathom
