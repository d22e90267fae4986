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

}  // namespace

std::uint32_t layer_features(const Material& m)
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
