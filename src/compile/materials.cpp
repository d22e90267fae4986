#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "compile/compiler.h"
#include "compile/images.h"
#include "compile/layers.h"
#include "compile/media.h"
#include "fathom/error.h"
#include "scene/material_table.h"
#include "scene/texture_table.h"

namespace fathom {

namespace {

TextureRecord compile_texture(Compiler& c, ImageStore& images, const Texture& texture)
{
    TextureRecord t;
    t.kind = std::uint32_t(texture.kind);
    if (texture.kind == TextureKind::image && texture.image >= 0) {
        const ImageStore::Texels texels = images.texture(texture);
        t.format = std::uint32_t(texels.format);
        t.texels = texels.place;
        t.width = texels.width;
        t.height = texels.height;
    }
    t.wrap_u = std::uint32_t(texture.wrap_u);
    t.wrap_v = std::uint32_t(texture.wrap_v);
    t.nearest = texture.nearest;
    t.uv_set = std::uint32_t(texture.uv_set);
    // KHR_texture_transform: translation * rotation * scale, the rotation turning v towards u.
    const float cosine = std::cos(texture.uv_rotation), sine = std::sin(texture.uv_rotation);
    t.uv_map = {cosine * texture.uv_scale.x, sine * texture.uv_scale.y,   texture.uv_offset.x,
                -sine * texture.uv_scale.x,  cosine * texture.uv_scale.y, texture.uv_offset.y};
    // Textures in space are given in world units.
    t.scale = texture.scale;
    t.turbulence_weight = texture.turbulence_weight;
    t.octaves = std::uint32_t(std::clamp(texture.octaves, 1, 16));
    const Color a = texture.color_a.value, b = texture.color_b.value;
    t.color_a = {a.r, a.g, a.b, 1};
    t.color_b = {b.r, b.g, b.b, 1};
    t.texture_a = texture_id(texture.color_a.texture);
    t.texture_b = texture_id(texture.color_b.texture);
    t.factor = texture.factor.value;
    t.factor_texture = texture_id(texture.factor.texture);
    t.factor_channel = std::uint32_t(texture.factor.channel);
    t.first_stop = std::uint32_t(c.tables.ramp_stops.size());
    t.stop_count = std::uint32_t(texture.stops.size());
    for (const RampStop& stop : texture.stops) c.tables.ramp_stops.push_back({stop.position, spectrum(stop.color)});
    return t;
}

ClosureKind closure_of(const Material& m)
{
    switch (m.kind) {
        case MaterialKind::none:
        case MaterialKind::unlit:
            return ClosureKind::none;
        case MaterialKind::diffuse:
            return ClosureKind::diffuse;
        case MaterialKind::metal:
            return ClosureKind::metal;
        case MaterialKind::fuzz_metal:
            return ClosureKind::fuzz_metal;
        case MaterialKind::glass:
            return ClosureKind::glass;
        case MaterialKind::plastic:
            return ClosureKind::plastic;
        case MaterialKind::principled:
            break;
    }
    return closure_of_layers(m);
}

bool is_solid(const Material& m, ClosureKind closure)
{
    return !m.thin && (closure == ClosureKind::glass || closure == ClosureKind::layered_transmitting);
}

MaterialRecord compile_material(Compiler& c, const Material& m)
{
    MaterialRecord t;
    t.closure = closure_of(m);
    t.base_color = spectrum(m.base_color.value);
    t.base_texture = texture_id(m.base_color.texture);
    if (t.closure == ClosureKind::glass) {
        t.base_color = spectrum(m.transmission_color.value);
        t.base_texture = texture_id(m.transmission_color.texture);
    }
    if (m.thin) t.flags |= MaterialRecord::thin;
    if (m.thin && m.kind == MaterialKind::glass) t.flags |= MaterialRecord::sheet;
    t.emission = spectrum(m.emission.value);
    t.emission_texture = texture_id(m.emission.texture);
    if (m.kind == MaterialKind::unlit) {
        t.emission = t.base_color;
        t.emission_texture = t.base_texture;
        t.flags |= MaterialRecord::unlit;
    }
    t.roughness = m.roughness.value;
    t.roughness_texture = texture_id(m.roughness.texture);
    t.roughness_channel = std::uint32_t(m.roughness.channel);
    t.metallic = m.metallic.value;
    t.metallic_texture = texture_id(m.metallic.texture);
    t.metallic_channel = std::uint32_t(m.metallic.channel);
    t.ior = m.ior;
    t.fuzz = m.fuzz;
    t.normal_texture = texture_id(m.normal_texture);
    t.normal_scale = m.normal_scale;
    t.alpha = m.alpha.value;
    t.alpha_texture = texture_id(m.alpha.texture);
    t.alpha_channel = std::uint32_t(m.alpha.channel);
    t.alpha_cutoff = m.alpha_cutoff;
    t.alpha_mode = std::uint32_t(m.alpha_mode);
    if (is_solid(m, t.closure)) {
        if (m.kind == MaterialKind::principled && m.subsurface.value > 0) t.subsurface_medium = subsurface_medium(c, m);
        const bool only_subsurface =
            t.subsurface_medium != 0 && !(m.transmission.value > 0) && !(m.diffuse_transmission.value > 0);
        t.medium = only_subsurface ? t.subsurface_medium : volume_medium(c, m);
    }
    if (m.single_sided && !is_solid(m, t.closure)) t.flags |= MaterialRecord::single_sided;
    if (m.energy_compensation) t.flags |= MaterialRecord::compensated;
    if (m.nonlinear) t.flags |= MaterialRecord::nonlinear;
    if (m.use_vertex_color) t.flags |= MaterialRecord::vertex_colored;
    if (t.base_texture != no_index || t.roughness_texture != no_index || t.metallic_texture != no_index ||
        m.use_vertex_color)
        t.flags |= MaterialRecord::textured;
    if (t.normal_texture != no_index) t.flags |= MaterialRecord::normal_mapped | MaterialRecord::wants_tangent;
    if (std::max({t.emission[0], t.emission[1], t.emission[2]}) > 0) t.flags |= MaterialRecord::emits;
    if (m.emission_two_sided || m.kind == MaterialKind::unlit) t.flags |= MaterialRecord::two_sided_emission;
    if (t.closure == ClosureKind::layered || t.closure == ClosureKind::layered_transmitting) {
        t.layers = std::uint32_t(c.tables.layers.size());
        c.tables.layers.push_back(compile_layers(m, c.space.scale));
        if (c.tables.layers.back().features & (LayersRecord::anisotropic | LayersRecord::coat_normal_mapped))
            t.flags |= MaterialRecord::wants_tangent;
    }
    return t;
}

}  // namespace

void compile_material_records(Compiler& c)
{
    c.tables.materials.clear();
    c.tables.layers.clear();
    c.tables.media.resize(1);
    for (const Material& material : c.scene.materials)
        c.tables.materials.push_back(compile_material(c, own_parameters(material, material_parameters())));
    // The last one stands for shapes without a material.
    c.tables.materials.push_back(compile_material(c, Material{}));
}

void compile_materials(Compiler& c)
{
    ImageStore images(c);
    // What a kind doesn't have must not tell two scenes apart.
    for (const Texture& texture : c.scene.textures)
        c.tables.textures.push_back(compile_texture(c, images, own_parameters(texture, texture_parameters())));
    compile_material_records(c);
    images.set_environment(c);
    images.set_lights(c);
}

}  // namespace fathom
