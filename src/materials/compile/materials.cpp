// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "compile/compiler.h"
#include "fathom/error.h"
#include "materials/closures/measured_tables.h"
#include "materials/compile/layers.h"
#include "media/compile/media.h"
#include "scene/material_table.h"
#include "scene/measured.h"
#include "scene/texture_table.h"
#include "textures/compile/images.h"

namespace fathom {

namespace {

/// Index of the record of a texture's space; no_index if it is world space.
std::uint32_t compile_space(Compiler& c, const Transform& world_from_texture)
{
    if (world_from_texture.m == Transform().m) return no_index;
    const Transform inverse = world_from_texture.inverse();
    TextureSpaceRecord space;
    for (std::size_t row = 0; row < 3; ++row)
        for (std::size_t k = 0; k < 4; ++k) space.rows[row][k] = float(inverse.m[row][k]);
    c.tables.texture_spaces.push_back(space);
    return std::uint32_t(c.tables.texture_spaces.size() - 1);
}

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
    t.mapping = std::uint32_t(texture.mapping);
    t.space = compile_space(c, texture.world_from_texture);
    t.scale = texture.scale;
    t.turbulence_weight = texture.turbulence_weight;
    t.gain = texture.gain;
    const Vec3f direction = to_float(normalize(texture.direction));
    t.direction = {direction.x, direction.y, direction.z};
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
        case MaterialKind::mix:
        case MaterialKind::two_sided:
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
        case MaterialKind::hair:
            return ClosureKind::hair;
        case MaterialKind::disney:
            return closure_of_disney(m);
        case MaterialKind::measured:
            return ClosureKind::measured;
        case MaterialKind::principled:
            break;
    }
    return closure_of_layers(m);
}

bool is_solid(const Material& m, ClosureKind closure)
{
    // Sheets of glass with attenuation enclose a medium though they are thin.
    if (m.interior.thin) return m.kind == MaterialKind::glass && m.interior.attenuation_distance > 0;
    return closure == ClosureKind::glass || closure == ClosureKind::layered_transmitting ||
           closure == ClosureKind::disney_transmitting;
}

bool is_open_boundary(const MaterialRecord& t)
{
    const bool is_clear = t.base_texture == no_index && t.base_color == Rgb{1, 1, 1};
    return t.closure == ClosureKind::glass && !(t.flags & MaterialRecord::thin) && t.ior == 1 && is_clear;
}

void set_number(const FloatInput& from, float& value, std::uint32_t& texture, std::uint32_t& channel)
{
    value = from.value;
    texture = texture_id(from.texture);
    channel = std::uint32_t(from.channel);
}

/// Hair keeps its parameters in members that other closures use for something else: see MaterialRecord.
void compile_hair(const Material& m, MaterialRecord& t)
{
    set_number(m.hair.beta_m, t.roughness, t.roughness_texture, t.roughness_channel);
    set_number(m.hair.beta_n, t.metallic, t.metallic_texture, t.metallic_channel);
    t.fuzz = float(m.hair.scale_tilt);
    t.ior = m.hair.ior;
    t.flags |= MaterialRecord::needs_tangent;
    Color absorbed = m.hair.absorption.value;
    int texture = m.hair.absorption.texture;
    const auto is_there = [&] { return absorbed.r > 0 || absorbed.g > 0 || absorbed.b > 0; };
    if (!is_there()) {
        // d'Eon et al. 2011, "An Energy-Conserving Hair Reflectance Model", 6.1.
        const float e = m.hair.eumelanin, p = m.hair.pheomelanin;
        absorbed = {0.419f * e + 0.187f * p, 0.697f * e + 0.4f * p, 1.37f * e + 1.05f * p};
        texture = -1;
    }
    if (!is_there()) return;
    t.flags |= MaterialRecord::absorption;
    t.base_color = spectrum(absorbed);
    t.base_texture = texture_id(texture);
}

/// The tables of measured surfaces are shared by materials: compile_measured_tables adds them.
void compile_measured(const Compiler& c, const Material& m, MaterialRecord& t)
{
    const MeasuredBrdf& brdf = c.scene.measured[std::size_t(m.measured)];
    t.measured = std::uint32_t(m.measured);
    t.base_color = spectrum(reflectance_of(brdf));  // shown in albedo layers
    if (!brdf.is_isotropic()) t.flags |= MaterialRecord::needs_tangent;
}

/// Adds the values of all measured surfaces to the tables.
void compile_measured_tables(Compiler& c)
{
    double count = 0;
    for (const MeasuredBrdf& brdf : c.scene.measured) count += measured_value_count(brdf);
    constexpr double most = 0x7fffffff;  // largest index that lanes of 32 bits address with a signed gather
    if (count > most) throw Error(c.scene.file, "", "its measured materials have more than 2,147,483,647 values");
    c.tables.measured_values.reserve(std::size_t(count));
    for (const MeasuredBrdf& brdf : c.scene.measured)
        c.tables.measured.push_back(add_measured(brdf, c.tables.measured_values));
}

/// Whether the surface is smooth thin glass, which shadow rays pass. Surfaces with normal or bump maps are excluded: a
/// map would bend only the reflection, and is rare on such glass.
bool is_pane(const Material& m, const MaterialRecord& t)
{
    return t.closure == ClosureKind::glass && m.interior.thin && t.roughness == 0 && t.roughness_texture == no_index &&
           t.normal_texture == no_index && !(t.flags & MaterialRecord::bumped);
}

/// Whether tangents of a map's texture coordinates may differ from those of the mesh's first set.
bool has_other_tangents(const Compiler& c, int texture)
{
    if (texture < 0) return false;
    const TextureRecord& t = c.tables.textures[std::size_t(texture)];
    const bool keeps_directions = t.uv_map[1] == 0 && t.uv_map[3] == 0 && t.uv_map[0] > 0 && t.uv_map[4] > 0;
    return TextureMapping(t.mapping) == TextureMapping::uv && (t.uv_set != 0 || !keeps_directions);
}

/// Sets the color that multiplies reflections of glass and plastic.
void set_tint(const ColorInput& color, MaterialRecord& t)
{
    if (color.texture < 0 && color.value == Color{1, 1, 1}) return;
    t.flags |= MaterialRecord::tinted;
    if (color.texture >= 0) t.flags |= MaterialRecord::needs_uv;
    t.specular_tint = spectrum(color.value);
    t.specular_tint_texture = texture_id(color.texture);
}

void make_invisible(MaterialRecord& t)
{
    t.flags |= MaterialRecord::invisible_light;
    t.alpha_mode = std::uint32_t(AlphaMode::blend);
    t.alpha = 0;
    t.alpha_texture = no_index;
}

MaterialRecord compile_material(Compiler& c, const Material& m)
{
    MaterialRecord t;
    t.closure = closure_of(m);
    t.base_color = spectrum(m.base_color.value);
    t.base_texture = texture_id(m.base_color.texture);
    if (t.closure == ClosureKind::glass) {
        t.base_color = spectrum(m.transmission.color.value);
        t.base_texture = texture_id(m.transmission.color.texture);
    }
    if (m.kind == MaterialKind::glass || m.kind == MaterialKind::plastic) set_tint(m.specular.color, t);
    if (m.interior.thin) t.flags |= MaterialRecord::thin;
    if (m.interior.thin && m.kind == MaterialKind::glass) t.flags |= MaterialRecord::sheet;
    t.emission = spectrum(m.emission.radiance.value);
    t.emission_texture = texture_id(m.emission.radiance.texture);
    if (m.kind == MaterialKind::unlit) {
        t.emission = t.base_color;
        t.emission_texture = t.base_texture;
        t.flags |= MaterialRecord::unlit;
    }
    set_number(m.roughness, t.roughness, t.roughness_texture, t.roughness_channel);
    set_number(m.metallic, t.metallic, t.metallic_texture, t.metallic_channel);
    t.ior = m.ior;
    t.fuzz = m.fuzz;
    if (m.kind == MaterialKind::hair) compile_hair(m, t);
    if (m.kind == MaterialKind::measured) compile_measured(c, m, t);
    if (m.kind == MaterialKind::plastic) {
        t.fuzz = m.plastic.optical_thickness;
        t.metallic = float(internal_absorption(std::max(m.ior, 1.001f), m.plastic.optical_thickness));
        if (m.plastic.inner_reflectance >= 0) t.metallic = -std::max(m.plastic.inner_reflectance, 1e-6f);
    }
    t.normal_texture = texture_id(m.normal_map.texture);
    t.normal_scale = m.normal_map.scale;
    if (m.bump.texture >= 0) {
        t.flags |= MaterialRecord::bumped;
        t.bump = {float(m.bump.value * c.space.scale), texture_id(m.bump.texture), std::uint32_t(m.bump.channel)};
    }
    t.alpha = m.opacity.alpha.value;
    t.alpha_texture = texture_id(m.opacity.alpha.texture);
    t.alpha_channel = std::uint32_t(m.opacity.alpha.channel);
    t.alpha_cutoff = m.opacity.cutoff;
    t.alpha_mode = std::uint32_t(m.opacity.mode);
    if (is_pane(m, t)) t.flags |= MaterialRecord::pane;
    if (is_solid(m, t.closure)) {
        if (m.kind == MaterialKind::principled && m.subsurface.weight.value > 0)
            t.subsurface_medium = subsurface_medium(c, m);
        const bool only_subsurface = t.subsurface_medium != 0 && !(m.transmission.weight.value > 0) &&
                                     !(m.diffuse_transmission.weight.value > 0);
        if (is_open_boundary(t)) t.flags |= MaterialRecord::index_matched_boundary;
        const bool is_index_matched = (t.flags & (MaterialRecord::index_matched_boundary | MaterialRecord::thin)) != 0;
        t.medium = only_subsurface ? t.subsurface_medium : volume_medium(c, m, is_index_matched);
    }
    if (m.visibility.camera_backface_culling && !is_solid(m, t.closure)) t.flags |= MaterialRecord::single_sided;
    if (m.visibility.hidden_from_camera) t.flags |= MaterialRecord::hidden_from_camera;
    if (m.visibility.invisible_light) make_invisible(t);
    if (m.visibility.black_back && t.closure != ClosureKind::none && !t.has_inside())
        t.flags |= MaterialRecord::one_sided;
    if (m.microfacets.beckmann) t.flags |= MaterialRecord::beckmann;
    if (m.microfacets.separable_masking) t.flags |= MaterialRecord::separable;
    if (m.microfacets.energy_compensation) t.flags |= MaterialRecord::compensated;
    if (m.plastic.nonlinear) t.flags |= MaterialRecord::nonlinear;
    if (m.use_vertex_color) t.flags |= MaterialRecord::vertex_colored;
    if (t.base_texture != no_index || t.roughness_texture != no_index || t.metallic_texture != no_index ||
        m.use_vertex_color)
        t.flags |= MaterialRecord::textured;
    if (t.emission_texture != no_index || t.closure == ClosureKind::hair) t.flags |= MaterialRecord::needs_uv;
    if (t.normal_texture != no_index) t.flags |= MaterialRecord::normal_mapped | MaterialRecord::needs_tangent;
    if (std::max({t.emission[0], t.emission[1], t.emission[2]}) > 0) t.flags |= MaterialRecord::emits;
    if (m.emission.two_sided || m.kind == MaterialKind::unlit) t.flags |= MaterialRecord::two_sided_emission;
    if (t.closure == ClosureKind::layered || t.closure == ClosureKind::layered_transmitting) {
        t.layers = std::uint32_t(c.tables.layers.size());
        c.tables.layers.push_back(compile_layers(m, c.space.scale));
        const std::uint32_t features = c.tables.layers.back().features;
        if (features & (LayersRecord::anisotropic | LayersRecord::coat_normal_mapped))
            t.flags |= MaterialRecord::needs_tangent;
        if (features & LayersRecord::textured) t.flags |= MaterialRecord::needs_uv;
    }
    if (m.map_tangents && (t.flags & MaterialRecord::needs_tangent) != 0 &&
        (has_other_tangents(c, m.normal_map.texture) || has_other_tangents(c, m.coat.normal_texture) ||
         has_other_tangents(c, m.microfacets.anisotropy_texture)))
        t.flags |= MaterialRecord::map_tangents;
    if (m.kind == MaterialKind::disney) {
        t.disney = std::uint32_t(c.tables.disney.size());
        c.tables.disney.push_back(compile_disney(m));
        const std::uint32_t features = c.tables.disney.back().features;
        if (features & DisneyRecord::anisotropic) t.flags |= MaterialRecord::needs_tangent;
        if (features & DisneyRecord::textured) t.flags |= MaterialRecord::needs_uv;
    }
    return t;
}

/// Gives a mixture the flags and media of its parts that geometry compilation depends on.
void propagate_mixture_flags(Compiler& c, std::size_t index)
{
    const Material& m = c.scene.materials[index];
    if (m.kind != MaterialKind::mix && m.kind != MaterialKind::two_sided) return;
    if (c.tables.materials[index].mixture != no_index) return;
    MixtureRecord mixture;
    mixture.first = std::uint32_t(m.mixture.material_a), mixture.second = std::uint32_t(m.mixture.material_b);
    mixture.by_side = m.kind == MaterialKind::two_sided;
    if (m.kind == MaterialKind::mix)
        mixture.factor = {m.mixture.factor.value, texture_id(m.mixture.factor.texture),
                          std::uint32_t(m.mixture.factor.channel)};
    MaterialRecord& t = c.tables.materials[index];
    t.mixture = std::uint32_t(c.tables.mixtures.size());
    c.tables.mixtures.push_back(mixture);
    if (mixture.factor.texture != no_index) t.flags |= MaterialRecord::textured;
    for (const std::uint32_t part : {mixture.first, mixture.second}) {
        propagate_mixture_flags(c, part);
        const MaterialRecord& p = c.tables.materials[part];
        t.flags |=
            p.flags & (MaterialRecord::textured | MaterialRecord::normal_mapped | MaterialRecord::bumped |
                       MaterialRecord::vertex_colored | MaterialRecord::needs_tangent | MaterialRecord::needs_uv);
        if (t.medium == 0) t.medium = p.medium;
        if (t.subsurface_medium == 0) t.subsurface_medium = p.subsurface_medium;
    }
}

}  // namespace

void compile_material_records(Compiler& c)
{
    c.tables.materials.clear();
    c.tables.layers.clear();
    c.tables.disney.clear();
    c.tables.mixtures.clear();
    c.tables.media.resize(1);
    for (const Material& material : c.scene.materials)
        c.tables.materials.push_back(compile_material(c, parameters_of_kind(material, material_parameters())));
    for (std::size_t i = 0; i < c.scene.materials.size(); ++i) propagate_mixture_flags(c, i);
    // The last record is the material of shapes without one.
    c.tables.materials.push_back(compile_material(c, Material{}));
}

void compile_materials(Compiler& c)
{
    ImageStore images(c);
    // Parameters that the kind does not have are reset, so that they don't affect the scene's fingerprint.
    for (const Texture& texture : c.scene.textures)
        c.tables.textures.push_back(compile_texture(c, images, parameters_of_kind(texture, texture_parameters())));
    compile_measured_tables(c);
    compile_material_records(c);
    images.set_environment(c);
    images.set_lights(c);
}

}  // namespace fathom
