// SPDX-License-Identifier: Apache-2.0
#include "compile/compiler.h"
#include "materials/compile/inputs.h"
#include "materials/compile/measured.h"
#include "media/compile/media.h"
#include "scene/material_table.h"
#include "textures/compile/textures.h"

namespace fathom {

namespace {

void compile_closure(Compiler& c, const Material& m, MaterialRecord& t)
{
    using enum MaterialKind;
    if (m.kind == none || m.kind == unlit || m.kind == mix || m.kind == two_sided) return;
    t.closure = closure_of(m.kind);
    for (const auto& [kind, compile] : closure_steps)
        if (kind == m.kind) return compile(c, m, t);
    compile_rough(c, m, t);
}

void compile_emission(const Material& m, MaterialRecord& t)
{
    const bool is_unlit = m.kind == MaterialKind::unlit;
    const ColorInput& emission = is_unlit ? m.base_color : m.emission.radiance;
    t.emission = spectrum(emission.value);
    t.emission_texture = texture_id(emission.texture);
    t.features.add(MaterialFeature::unlit, is_unlit);
    t.features.add(MaterialFeature::emits, is_positive(emission));
    t.features.add(MaterialFeature::two_sided_emission, m.emission.two_sided || is_unlit);
    t.features.add(MaterialFeature::needs_uv, emission.texture >= 0);
}

/// Sets the alpha parameters. Rays pass invisible lights, whatever their alpha.
void compile_alpha(const Material& m, MaterialRecord& t)
{
    const NumberRecord alpha = number(m.opacity.alpha);
    t.alpha_mode = std::uint32_t(m.visibility.invisible_light ? AlphaMode::blend : m.opacity.mode);
    t.alpha = m.visibility.invisible_light ? 0 : alpha.value;
    t.alpha_texture = m.visibility.invisible_light ? no_index : alpha.texture;
    t.alpha_channel = alpha.channel;
    t.alpha_cutoff = m.opacity.cutoff;
    t.features.add(MaterialFeature::invisible_light, m.visibility.invisible_light);
}

void compile_maps(const Compiler& c, const Material& m, MaterialRecord& t)
{
    t.normal_texture = texture_id(m.normal_map.texture);
    t.normal_scale = m.normal_map.scale;
    if (m.normal_map.texture >= 0) t.features |= MaterialFeature::normal_mapped | MaterialFeature::needs_tangent;
    if (m.bump.texture < 0) return;
    t.features.add(MaterialFeature::bumped);
    t.bump = number(m.bump);
    t.bump.value = float(m.bump.value * c.space.scale);
}

/// Whether tangents that follow a map's texture coordinates may differ from those of the mesh's first set.
bool has_other_tangents(const Compiler& c, int texture)
{
    if (texture < 0) return false;
    const TextureRecord& t = c.tables.textures[std::size_t(texture)];
    const bool keeps_directions = t.uv_map[1] == 0 && t.uv_map[3] == 0 && t.uv_map[0] > 0 && t.uv_map[4] > 0;
    return TextureMapping(t.mapping) == TextureMapping::uv && (t.uv_set != 0 || !keeps_directions);
}

/// Sets whether tangents follow the texture coordinates of maps. Must run after all steps that set features.
void compile_tangents(const Compiler& c, const Material& m, MaterialRecord& t)
{
    const bool differ = has_other_tangents(c, m.normal_map.texture) || has_other_tangents(c, m.coat.normal_texture) ||
                        has_other_tangents(c, m.microfacets.anisotropy_texture);
    t.features.add(MaterialFeature::map_tangents,
                   m.map_tangents && t.features.has(MaterialFeature::needs_tangent) && differ);
}

bool is_solid(const Material& m, ClosureKind closure)
{
    // Sheets of glass with attenuation enclose a medium although they are thin.
    if (m.interior.thin) return m.kind == MaterialKind::glass && m.interior.attenuation_distance > 0;
    return closure == ClosureKind::glass || closure == ClosureKind::layered_transmitting ||
           closure == ClosureKind::disney_transmitting;
}

/// Sets the media of the solid. The closure must be set already.
void compile_media(Compiler& c, const Material& m, MaterialRecord& t)
{
    if (!is_solid(m, t.closure)) return;
    if (m.kind == MaterialKind::principled && m.subsurface.weight.value > 0)
        t.subsurface_medium = subsurface_medium(c, m);
    const bool only_subsurface =
        t.subsurface_medium != 0 && !(m.transmission.weight.value > 0) && !(m.diffuse_transmission.weight.value > 0);
    const bool is_index_matched = t.features.has_any(MaterialFeature::index_matched_boundary | MaterialFeature::thin);
    t.medium = only_subsurface ? t.subsurface_medium : volume_medium(c, m, is_index_matched);
}

/// Sets the features of front and back. The closure and the media must be set already.
void compile_sides(const Material& m, MaterialRecord& t)
{
    t.features.add(MaterialFeature::single_sided, m.visibility.camera_backface_culling && !is_solid(m, t.closure));
    t.features.add(MaterialFeature::hidden_from_camera, m.visibility.hidden_from_camera);
    t.features.add(MaterialFeature::one_sided,
                   m.visibility.black_back && t.closure != ClosureKind::none && !t.has_inside());
}

MaterialRecord compile_material(Compiler& c, const Material& m)
{
    MaterialRecord t;
    set_base_color(m.base_color, t);
    t.features.add(MaterialFeature::thin, m.interior.thin);
    compile_closure(c, m, t);
    compile_emission(m, t);
    compile_alpha(m, t);
    compile_maps(c, m, t);
    compile_tangents(c, m, t);
    compile_media(c, m, t);
    compile_sides(m, t);
    t.features.add(MaterialFeature::vertex_colored, m.use_vertex_color);
    t.features.add(MaterialFeature::textured, t.base_texture != no_index || m.use_vertex_color);
    return t;
}

/// Gives a mixture those features and media of its parts on which geometry compilation depends.
void propagate_mixture_flags(Compiler& c, std::size_t index)
{
    const Material& m = c.scene.materials[index];
    using enum MaterialFeature;
    constexpr MaterialFeatures inherited =
        textured | normal_mapped | bumped | vertex_colored | needs_tangent | needs_uv;
    if (m.kind != MaterialKind::mix && m.kind != MaterialKind::two_sided) return;
    if (c.tables.materials[index].mixture != no_index) return;
    MixtureRecord mixture;
    mixture.first = std::uint32_t(m.mixture.material_a), mixture.second = std::uint32_t(m.mixture.material_b);
    mixture.by_side = m.kind == MaterialKind::two_sided;
    if (m.kind == MaterialKind::mix) mixture.factor = number(m.mixture.factor);
    MaterialRecord& t = c.tables.materials[index];
    t.mixture = std::uint32_t(c.tables.mixtures.size());
    c.tables.mixtures.push_back(mixture);
    t.features.add(textured, mixture.factor.texture != no_index);
    for (const std::uint32_t part : {mixture.first, mixture.second}) {
        propagate_mixture_flags(c, part);
        const MaterialRecord& p = c.tables.materials[part];
        t.features |= p.features & inherited;
        if (t.medium == 0) t.medium = p.medium;
        if (t.subsurface_medium == 0) t.subsurface_medium = p.subsurface_medium;
    }
}

}  // namespace

void compile_rough(Compiler&, const Material& m, MaterialRecord& t)
{
    RoughRecord record;
    set_number(m.roughness, record.roughness, record.roughness_texture, t);
    t.set_parameters(record);
}

void compile_material_records(Compiler& c)
{
    c.tables.materials.clear();
    c.tables.layers.clear();
    c.tables.disney.clear();
    c.tables.mixtures.clear();
    c.tables.media.resize(1);
    // Parameters that the kind does not have are reset, so that they don't affect the scene's fingerprint.
    for (const Material& material : c.scene.materials)
        c.tables.materials.push_back(compile_material(c, parameters_of_kind(material, material_parameters())));
    for (std::size_t i = 0; i < c.scene.materials.size(); ++i) propagate_mixture_flags(c, i);
    // The last record is the default material, for shapes without a material.
    c.tables.materials.push_back(compile_material(c, Material{}));
}

void compile_materials(Compiler& c)
{
    ImageStore images(c);
    compile_textures(c, images);
    compile_measured_tables(c);
    compile_material_records(c);
    images.set_environment(c);
    images.set_lights(c);
}

}  // namespace fathom
