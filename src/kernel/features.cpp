// SPDX-License-Identifier: Apache-2.0
#include "kernel/features.h"

#include <algorithm>

#include "kernel/quad_columns.h"
#include "lights/kinds/records.h"
#include "materials/closures/closures.h"

namespace fathom {
inline namespace FATHOM_LANES {

namespace {

/// Materials of a scene's surfaces, each once.
class UsedMaterials {
public:
    explicit UsedMaterials(const SceneTables& tables) : tables_(tables), is_used_(tables.materials.size())
    {
        for (const ShapeRecord& shape : tables.shapes) add(shape.material);
    }

    /// Materials of shapes, and the constituents of mixtures.
    const std::vector<const MaterialRecord*>& all() const { return all_; }
    /// Whether some material satisfies f, mixtures included.
    template <class F>
    bool any(F&& f) const
    {
        return std::any_of(all_.begin(), all_.end(), [&](const MaterialRecord* m) { return f(*m); });
    }
    /// Whether some material that is not a mixture satisfies f.
    template <class F>
    bool any_constituent(F&& f) const
    {
        return any([&](const MaterialRecord& m) { return m.mixture == no_index && f(m); });
    }
    bool any_constituent_has(MaterialFeature feature) const
    {
        return any_constituent([&](const MaterialRecord& m) { return m.features.has(feature); });
    }
    /// Whether f holds for a medium of some material that is not a mixture.
    template <class F>
    bool any_medium(F&& f) const
    {
        return any_constituent([&](const MaterialRecord& m) {
            return f(tables_.media[m.medium]) || f(tables_.media[m.subsurface_medium]);
        });
    }

private:
    void add(std::uint32_t material)
    {
        if (is_used_[material]) return;
        is_used_[material] = true;
        const MaterialRecord& m = tables_.materials[material];
        all_.push_back(&m);
        if (m.mixture == no_index) return;
        add(tables_.mixtures[m.mixture].first);
        add(tables_.mixtures[m.mixture].second);
    }

    const SceneTables& tables_;
    std::vector<bool> is_used_;
    std::vector<const MaterialRecord*> all_;
};

/// Whether some shape's material satisfies f. Constituents of mixtures are not tested.
template <class F>
bool any_shape(const SceneTables& tables, F&& f)
{
    return std::any_of(tables.shapes.begin(), tables.shapes.end(),
                       [&](const ShapeRecord& shape) { return f(tables.materials[shape.material]); });
}
bool has_open_media(const SceneTables& tables)
{
    return any_shape(tables, [&](const MaterialRecord& m) {
        return m.features.has(MaterialFeature::index_matched_boundary) || tables.media[m.medium].is_index_matched;
    });
}
bool has_panes(const SceneTables& tables)
{
    return any_shape(tables, [](const MaterialRecord& m) { return m.features.has(MaterialFeature::pane); });
}

/// Number of solids that have a medium, counting instances.
std::size_t count_solids(const SceneTables& tables)
{
    const auto is_solid = [&](const ShapeRecord& shape) { return tables.materials[shape.material].medium != 0; };
    std::size_t count = 0;
    for (const ShapeRecord& shape : tables.shapes)
        count += is_solid(shape) && !(shape.flags & ShapeRecord::only_instanced);
    for (const InstanceRecord& instance : tables.instances) count += is_solid(tables.shapes[instance.shape]);
    return count;
}

void add_surface_features(const SceneTables& tables, const UsedMaterials& used, Features& f)
{
    constexpr std::size_t many_vertices = 1 << 17;
    f.add(Feature::motion, tables.moving);
    f.add(Feature::large_meshes, tables.positions.size() > many_vertices);
    f.add(Feature::textures, !tables.textures.empty());
    f.add(Feature::tangents, used.any_constituent_has(MaterialFeature::needs_tangent));
    const bool has_hair = used.any_constituent([](const MaterialRecord& m) { return m.closure == ClosureKind::hair; });
    f.add(Feature::texture_coordinates, f.has(Feature::textures) || has_hair || f.has(Feature::tangents));
    f.add(Feature::bump_maps, used.any_constituent_has(MaterialFeature::bumped));
    f.add(Feature::map_tangents, used.any_constituent_has(MaterialFeature::map_tangents));
    f.add(Feature::surface_derivatives, f.has(Feature::bump_maps) || f.has(Feature::map_tangents));
    f.add(Feature::mixtures, used.any([](const MaterialRecord& m) { return m.mixture != no_index; }));
    f.add(Feature::one_sided, used.any_constituent_has(MaterialFeature::one_sided));
    f.add(Feature::camera_pass_through, used.any([](const MaterialRecord& m) {
        return m.features.has_any(MaterialFeature::single_sided | MaterialFeature::hidden_from_camera);
    }));
    f.add(Feature::transmission,
          used.any_constituent([](const MaterialRecord& m) { return Closures::transmits(m.closure); }));
    f.add(Feature::exit_offsets, has_hair);
}

void add_media_features(const SceneTables& tables, bool is_flat, const UsedMaterials& used, Features& f)
{
    const auto any_positive = [](const auto& sigma) {
        return std::any_of(std::begin(sigma), std::end(sigma), [](float s) { return s > 0; });
    };
    f.add(Feature::attenuation, used.any_medium([&](const MediumRecord& m) { return any_positive(m.extinction); }));
    f.add(Feature::scattering_media,
          used.any_medium([&](const MediumRecord& m) { return any_positive(m.scattering); }));
    f.add(Feature::textured_media, used.any_medium([](const MediumRecord& m) { return m.is_textured != 0; }));
    // Edits may add open media and panes to a flat scene.
    f.add(Feature::open_media, !is_flat && has_open_media(tables));
    f.add(Feature::transmissive_shadows, !is_flat && has_transmissive_surfaces(tables));
    f.add(Feature::exit_offsets, f.has(Feature::transmissive_shadows));
    f.add(Feature::media_stacks, f.has(Feature::attenuation) || f.has(Feature::open_media) || count_solids(tables) > 1);
}

void add_light_features(const SceneTables& tables, Features& f)
{
    const auto any_light = [&](auto&& test) { return std::any_of(tables.lights.begin(), tables.lights.end(), test); };
    f.add(Feature::environment, EnvironmentKind(tables.environment.kind) != EnvironmentKind::none);
    f.add(Feature::textured_lights, any_light([](const LightRecord& light) { return light.material != no_index; }));
    f.add(Feature::moving_lights, any_light([](const LightRecord& light) { return light.motion != 0; }));
    f.add(Feature::curve_lights, any_light([](const LightRecord& light) { return light.is<CurveLightRecord>(); }));
    f.add(Feature::light_pictures, !tables.light_pictures.empty());
}

/// Whether QuadTracer can shade this material.
bool is_for_quad_tracer(const MaterialRecord& m)
{
    return m.emission_texture == no_index && (m.closure == ClosureKind::none || Closures::is_small(m.closure));
}

/// Adds the features of scenes of quads. Must run after the other features were found.
void add_quad_features(const SceneTables& tables, bool is_flat, const UsedMaterials& used, Features& f)
{
    const bool all_quads = is_flat && tables.triangles.empty() && tables.spheres.empty() && tables.disks.empty();
    const bool is_rare = f.has(Feature::motion) || f.has(Feature::camera_pass_through) || f.has(Feature::mixtures) ||
                         f.has(Feature::one_sided) || f.has(Feature::media_stacks);
    if (!all_quads || is_rare || used.any([](const MaterialRecord& m) { return !is_for_quad_tracer(m); })) return;
    f.add(Feature::only_quads);
    f.add(Feature::only_plain_quads, !used.any([](const MaterialRecord& m) { return !QuadColumns::is_plain(m); }));
}

}  // namespace

Features find_features(const SceneTables& tables, bool is_flat)
{
    const UsedMaterials used(tables);
    Features features;
    add_surface_features(tables, used, features);
    add_media_features(tables, is_flat, used, features);
    add_light_features(tables, features);
    add_quad_features(tables, is_flat, used, features);
    return features;
}

bool has_transmissive_surfaces(const SceneTables& tables)
{
    return has_open_media(tables) || has_panes(tables);
}

EnumSet<ClosureKind> find_closures(const SceneTables& tables)
{
    const UsedMaterials used(tables);
    EnumSet<ClosureKind> closures;
    for (const MaterialRecord* m : used.all())
        if (m->mixture == no_index) closures.add(m->closure, m->closure != ClosureKind::none);
    return closures;
}

}  // namespace FATHOM_LANES
}  // namespace fathom
