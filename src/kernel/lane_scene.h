// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "fathom/description.h"
#include "geometry/bvh/bvh.h"
#include "geometry/flat/flat.h"
#include "kernel/kernel.h"
#include "kernel/quad_columns.h"
#include "materials/closures/closures.h"
#include "math/gather_member.h"
#include "sampling/filter.h"

namespace fathom {
inline namespace FATHOM_LANES {

/// The kernel's scene: the compiled tables, the acceleration structure, and precomputed flags and columns.
struct LaneScene final : KernelScene {
    std::shared_ptr<const SceneTables> tables_owner;
    const SceneTables& tables;
    /// Scenes of a few dozen primitives are traced as a flat list (`flat`), larger ones by the BVH (`bvh`).
    bool is_flat = false;
    FlatScene flat;
    Bvh bvh;
    /// Per shape: the sort bucket of its material in the low bits, flags in the high bits.
    std::vector<std::uint32_t> shape_info;
    static constexpr std::uint32_t emits = 1u << 31, is_mixture = 1u << 30;
    /// Shadow rays and paths may pass the surface undeflected (passes_shadow_rays) without counting a bounce
    /// (passes_without_bounce).
    static constexpr std::uint32_t passes_shadow_rays = 1u << 29, passes_without_bounce = 1u << 28;
    /// Per material: its sort bucket, for the constituents of mixtures.
    std::vector<std::uint32_t> material_bucket;
    /// Sort key of paths before shading: first the ClosureKind, then the material modulo 32.
    static constexpr std::uint32_t bucket_mask = 0x1ff, kind_shift = 5;
    static constexpr std::uint32_t buckets = std::uint32_t(closure_kind_count) << kind_shift;
    static_assert(buckets <= bucket_mask + 1);
    static constexpr std::uint32_t samples_light = bucket_mask + 1;  ///< bucket flag of paths that sample a light
    /// Per primitive of a flat scene: the shape_info of its shape; padded for lookup().
    std::vector<std::uint32_t> primitive_info;
    QuadColumns quads;
    std::uint32_t kinds = 0;        ///< bit per ClosureKind that occurs and scatters
    bool is_large = false;          ///< vertices exceed the caches close to a core
    bool textured = false;          ///< the scene has textures
    bool has_fibers = false;        ///< some material is a hair closure, which needs the texture coordinate v as offset
                                    ///< across the fiber
    bool needs_uv = false;          ///< texture coordinates are needed: for textures, hair or tangents
    bool has_exit_offset = false;   ///< light sampling points may differ from ray origins: see PathPool::exit_offset
    bool wants_tangents = false;    ///< tangents of surfaces are needed
    bool has_bumps = false;         ///< some material is bump-mapped
    bool has_map_tangents = false;  ///< some material has MaterialRecord::map_tangents
    bool wants_uv_slopes = false;   ///< has_bumps or has_map_tangents: Surface::ways is filled in
    bool varied_lights = false;     ///< some lights vary over their surface: see LightRecord::material
    bool moving_lights = false;     ///< some lights move: see LightRecord::motion
    bool curve_lights = false;      ///< some lights are curve segments
    bool pictured_lights = false;   ///< some lights are LightRecordKind::pictured
    bool refracts = false;          ///< some material transmits light
    bool one_sided = false;         ///< some surfaces are black on their back
    bool camera_passes_surfaces = false;  ///< camera rays pass some surfaces: see CameraPassThrough
    bool has_absorption = false;          ///< some medium absorbs or scatters
    bool scatters_inside = false;         ///< some medium scatters
    bool textured_media = false;          ///< some media have textured coefficients, which paths carry along
    bool open_media = false;  ///< some media are index-matched (MediumRecord::is_open) or have open boundaries
    bool transmissive_shadows = false;  ///< shadow rays pass some surfaces: open boundaries or panes
    bool tracks_media = false;          ///< paths keep a stack of media: some absorb or are open, or solids may overlap
    bool has_mixtures = false;          ///< some material is a mixture
    bool needs_environment_radiance = false;  ///< rays that leave the scene see radiance
    bool only_quads = false;        ///< flat, static, quads only, without rare features: QuadTracer renders it
    bool only_plain_quads = false;  ///< only_quads, and all quads are plain: see QuadColumns
    FilterTable filters[3];         ///< Gaussian, Blackman-Harris, tent

    LaneScene(std::shared_ptr<const SceneTables> t, BvhQuality level);
    std::size_t memory_bytes() const override;
    bool has_tree() const override { return !is_flat; }
    void update(const std::vector<std::uint32_t>& shapes) override;

    /// Whether some material of this ClosureKind scatters.
    bool has_closure(std::uint32_t kind) const { return kinds >> kind & 1; }
    /// shape_info of the shape that was hit; 0 outside the mask.
    UInt shape_info_of(UInt primitive, UInt instance, Mask m) const;

private:
    bool has_alpha() const;
    void read_tables();
    void read_shapes();
    void read_material(const MaterialRecord& material);
};

inline UInt LaneScene::shape_info_of(UInt primitive, UInt instance, Mask m) const
{
    if (is_flat) return lookup_or_gather(primitive_info.data(), int(tables.shape_of_primitive.size()), primitive, m);
    UInt shape = gather(tables.shape_of_primitive.data(), primitive, m);
    if (!tables.instances.empty()) {
        const Mask placed = m & (instance != UInt(no_index));
        shape = select(placed, gather(tables.instances, &InstanceRecord::shape, instance, placed), shape);
    }
    return gather(shape_info.data(), shape, m);
}

}  // namespace FATHOM_LANES
}  // namespace fathom
