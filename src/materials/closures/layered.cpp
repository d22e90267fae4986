// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include "materials/compile/fresnel.h"
#include "materials/compile/inputs.h"
#include "materials/compile/layers.h"

namespace fathom {

namespace {

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

/// render_scale: factor from scene units to those of render space, applied to lengths
LayersRecord compile_layers(const Material& m, double render_scale)
{
    LayersRecord t;
    t.features = layer_features(m);
    t.specular = number(m.specular), t.anisotropy = number(m.anisotropy), t.transmission = number(m.transmission);
    t.diffuse_transmission = number(m.diffuse_transmission), t.diffuse_roughness = number(m.diffuse_roughness);
    t.coat = number(m.coat), t.coat_roughness = number(m.coat_roughness);
    t.sheen_roughness = number(m.sheen_roughness), t.subsurface = number(m.subsurface);
    t.thin_film = number(m.thin_film), t.thin_film_thickness = number(m.thin_film_thickness);
    t.specular_color = color(m.specular_color), t.edge_color = color(m.edge_color);
    t.transmission_color = color(m.transmission_color);
    t.diffuse_transmission_color = color(m.diffuse_transmission_color);
    t.coat_color = color(m.coat_color), t.sheen_color = color(m.sheen_color);
    t.subsurface_color = color(m.subsurface_color), t.subsurface_radius_scale = color(m.subsurface_radius_scale);
    t.subsurface_radius = number(m.subsurface_radius);
    t.subsurface_radius.value = float(double(m.subsurface_radius.value) * render_scale);
    t.conductor_eta = spectrum(m.conductor_eta), t.conductor_k = spectrum(m.conductor_k);
    t.anisotropy_cos = float(std::cos(m.anisotropy_rotation)),
    t.anisotropy_sin = float(std::sin(m.anisotropy_rotation));
    t.anisotropy_texture = texture_id(m.anisotropy_texture);
    t.dispersion = m.dispersion;
    t.coat_f0 = float(fresnel(1, m.coat_ior)), t.coat_inner = float(inner_reflectance(m.coat_ior));
    t.coat_darkening = m.coat_darkening;
    t.coat_normal_texture = texture_id(m.coat_normal_texture), t.coat_normal_scale = m.coat_normal_scale;
    t.thin_film_ior = m.thin_film_ior;
    if (is_textured(t.specular, t.anisotropy, t.transmission, t.diffuse_transmission, t.diffuse_roughness, t.coat,
                    t.coat_roughness, t.sheen_roughness, t.thin_film, t.thin_film_thickness, t.specular_color,
                    t.edge_color, t.transmission_color, t.diffuse_transmission_color, t.coat_color, t.sheen_color,
                    t.subsurface, t.subsurface_color, t.subsurface_radius, t.subsurface_radius_scale))
        t.features |= LayersRecord::textured;
    return t;
}

}  // namespace

std::uint32_t layer_features(const Material& m)
{
    std::uint32_t features = 0;
    const auto add = [&](bool has, LayersRecord::Features feature) { features |= has ? std::uint32_t(feature) : 0u; };
    const bool is_coated = is_positive(m.coat), transmits = is_positive(m.transmission);
    add(is_positive(m.sheen_color), LayersRecord::with_sheen);
    add(is_positive(m.sheen_color) && m.sheen_reciprocal, LayersRecord::sheen_reciprocal);
    add(is_coated, LayersRecord::with_coat);
    add(is_positive(m.thin_film) && is_positive(m.thin_film_thickness), LayersRecord::with_thin_film);
    add(transmits, LayersRecord::with_transmission);
    add(is_positive(m.diffuse_transmission), LayersRecord::with_diffuse_transmission);
    add(is_positive(m.diffuse_transmission) && m.diffuse_transmission_added, LayersRecord::diffuse_transmission_added);
    add(is_positive(m.subsurface) && !m.thin, LayersRecord::with_subsurface);
    add(is_positive(m.diffuse_roughness), LayersRecord::rough_diffuse);
    add(is_positive(m.anisotropy) || m.two_roughnesses, LayersRecord::anisotropic);
    add(m.two_roughnesses, LayersRecord::two_roughnesses);
    add(is_positive(m.metallic) && max_of(m.conductor_k) > 0, LayersRecord::with_conductor);
    add(m.energy_compensation, LayersRecord::energy_compensation);
    add(is_coated && m.coat_normal_texture >= 0, LayersRecord::coat_normal_mapped);
    add(transmits && m.dispersion > 0, LayersRecord::disperses);
    return features;
}

std::uint32_t add_layers(Compiler& c, const Material& m, MaterialRecord& t)
{
    c.tables.layers.push_back(compile_layers(m, c.space.scale));
    const std::uint32_t features = c.tables.layers.back().features;
    const bool has_directions = (features & (LayersRecord::anisotropic | LayersRecord::coat_normal_mapped)) != 0;
    t.features.add(MaterialFeature::needs_tangent, has_directions);
    t.features.add(MaterialFeature::needs_uv, (features & LayersRecord::textured) != 0);
    t.features.add(MaterialFeature::subsurface, (features & LayersRecord::with_subsurface) != 0);
    return std::uint32_t(c.tables.layers.size() - 1);
}

}  // namespace fathom
