// SPDX-License-Identifier: Apache-2.0
/// Conversion of BSDFs of Mitsuba 0.6 that later versions dropped.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "formats/mitsuba/reader.h"

namespace fathom::mitsuba {

namespace {

float greatest(Color c)
{
    return std::max({c.r, c.g, c.b});
}

}  // namespace

ColorInput Reader::scaled_input(const ColorInput& color, float by)
{
    if (color.texture < 0) return {{color.value.r * by, color.value.g * by, color.value.b * by}, -1};
    Texture product;
    product.kind = TextureKind::scale;
    product.color_a = color;
    product.color_b = {{by, by, by}, -1};
    scene_.textures.push_back(product);
    return {{1, 1, 1}, int(scene_.textures.size()) - 1};
}

/// Converts 'phong' and 'ward' to a mixture of a diffuse and a glossy material, weighted by the specular reflectance.
/// The lobe of 'phong' becomes a Beckmann distribution of equal width: cos(2x)^n is about exp(-2 n x^2).
Material Reader::phong(Object& bsdf)
{
    const ColorInput diffuse = color(bsdf, "diffuse_reflectance", {0.5f, 0.5f, 0.5f}),
                     specular = color(bsdf, "specular_reflectance", {0.2f, 0.2f, 0.2f});
    Material body, gloss = mirror();
    body.visibility.black_back = gloss.visibility.black_back = !two_sided_;
    if (bsdf.type() == "phong") {
        FloatInput exponent = number_or_texture(bsdf, "exponent", 30);
        if (exponent.texture >= 0) {
            report(bsdf.element(), "a texture as 'exponent' is not supported: 30 is used");
            exponent = {30, -1, 0};
        }
        gloss.microfacets.beckmann = true, gloss.microfacets.energy_compensation = false,
        gloss.microfacets.separable_masking = true;
        const double alpha = std::sqrt(2 / (4 * std::max(0.0, double(exponent.value)) + 2));
        gloss.roughness = {float(std::sqrt(alpha)), -1, 0};
    } else {
        read_roughness(bsdf, gloss);
        bsdf.ignore({"variant"});
    }
    const float share = specular.texture >= 0 ? 0.5f : std::min(greatest(specular.value), 1.f);
    body.base_color = share < 1 ? scaled_input(diffuse, 1 / (1 - share)) : diffuse;
    if (body.base_color.texture < 0)
        for (float* c : {&body.base_color.value.r, &body.base_color.value.g, &body.base_color.value.b})
            *c = std::min(*c, 1.f);
    if (share <= 0) return body;
    tint(gloss, scaled_input(specular, 1 / share));
    if (share >= 1 || (diffuse.texture < 0 && greatest(diffuse.value) <= 0 && specular.texture < 0)) {
        if (share < 1) tint(gloss, specular);
        return gloss;
    }
    report(bsdf.element(), "is approximated by a mix of a diffuse material and rough metal");
    Material both;
    both.kind = MaterialKind::mix;
    both.mixture.factor = {share, -1, 0};
    both.mixture.material_a = add_material(std::move(body)), both.mixture.material_b = add_material(std::move(gloss));
    return both;
}

Material Reader::rough_diffuse(Object& bsdf)
{
    Material m = diffuse(bsdf);
    // Mitsuba's slopes have a standard deviation of alpha / sqrt(2).
    m.roughness = number_or_texture(bsdf, "alpha", 0.2f);
    m.roughness.value *= 0.70710678f;
    bsdf.ignore({"use_fast_approx"});
    return m;
}

/// A purely transmissive diffuse material.
Material Reader::diffuse_transmitter(Object& bsdf)
{
    Material m;
    m.kind = MaterialKind::principled;
    m.metallic = {0, -1, 0};
    m.specular.weight = {0, -1, 0};
    m.roughness = {1, -1, 0};
    m.base_color = {{1, 1, 1}, -1};
    m.diffuse_transmission.weight = {1, -1, 0};
    m.diffuse_transmission.color = color(bsdf, "transmittance", {0.5f, 0.5f, 0.5f});
    return m;
}

/// Nests a mixture of any number of BSDFs as binary mixtures: the first BSDF against all others, and so on.
Material Reader::mixture(Object& bsdf)
{
    const std::vector<const Element*> nested = bsdf.children("bsdf");
    const std::vector<double> weights = numbers_of(bsdf.element(), bsdf.text("weights", ""));
    if (nested.empty() || weights.size() != nested.size())
        bsdf.element().fail(fmt::format("a 'mixturebsdf' must have as many 'weights' as bsdfs, found {} and {}",
                                        weights.size(), nested.size()));
    double total = weights.back();
    int rest = material(*nested.back());
    for (std::size_t i = nested.size() - 1; i-- > 0;) {
        if (!(weights[i] >= 0)) bsdf.element().fail("the 'weights' of bsdfs must be at least 0");
        Material both;
        both.kind = MaterialKind::mix;
        both.mixture.material_a = material(*nested[i]), both.mixture.material_b = rest;
        both.mixture.factor = {total + weights[i] > 0 ? float(total / (total + weights[i])) : 0.f, -1, 0};
        total += weights[i];
        if (i == 0) return both;
        rest = add_material(std::move(both));
    }
    return scene_.materials[std::size_t(rest)];
}

}  // namespace fathom::mitsuba
