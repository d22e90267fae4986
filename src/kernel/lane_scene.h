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

/// The kernel's scene: the tables, the acceleration structure, and what is worth precomputing.
struct LaneScene final : KernelScene {
    std::shared_ptr<const SceneTables> tables_owner;
    const SceneTables& tables;
    /// A scene of a few dozen primitives is traced as a flat list, a larger one by the tree.
    bool is_flat = false;
    FlatScene flat;
    Bvh bvh;
    /// Per shape: the bucket of its material, and flags on top.
    std::vector<std::uint32_t> shape_info;
    static constexpr std::uint32_t emits = 1u << 31, is_mixture = 1u << 30;
    /// Shadow rays may pass, and paths as if nothing were there; and that is no bounce.
    static constexpr std::uint32_t may_be_passed = 1u << 29, is_no_bounce = 1u << 28;
    /// Per material: its bucket; of use where a mixture has it.
    std::vector<std::uint32_t> material_bucket;
    /// Paths are sorted by bucket before they are shaded: first by ClosureKind, then by material (modulo 32).
    static constexpr std::uint32_t bucket_mask = 0x1ff, kind_shift = 5;
    static constexpr std::uint32_t buckets = std::uint32_t(closure_kind_count) << kind_shift;
    static_assert(buckets <= bucket_mask + 1);
    static constexpr std::uint32_t samples_light =
        bucket_mask + 1;  ///< the mark of buckets of paths that sample a light
    /// Per primitive, if the scene is flat: shape_info of its shape; padded for lookup().
    std::vector<std::uint32_t> primitive_info;
    QuadColumns quads;
    std::uint32_t kinds = 0;        ///< bit per ClosureKind that occurs and scatters
    bool is_large = false;          ///< vertices are far more than caches hold near a core
    bool textured = false;          ///< there are textures
    bool has_fibers = false;        ///< some material is of fibres, to which uv say where across they are met
    bool wants_uv = false;          ///< either of both, or tangents
    bool has_way_out = false;       ///< lights were seen from elsewhere than where rays begin: PathPool::exit_offset
    bool wants_tangents = false;    ///< tangents of surfaces matter somewhere
    bool has_bumps = false;         ///< some material bends normals by the slope of a texture
    bool has_map_tangents = false;  ///< some material has MaterialRecord::map_tangents
    bool wants_uv_slopes = false;   ///< either of both: Surface::ways are known
    bool varied_lights = false;     ///< some are not alike all over, see LightRecord::material
    bool moving_lights = false;     ///< some are elsewhere at other times, see LightRecord::motion
    bool curve_lights = false;      ///< some are segments of curves
    bool pictured_lights = false;   ///< some are LightRecordKind::pictured
    bool refracts = false;          ///< some material lets light pass
    bool one_sided = false;         ///< some surfaces reflect nothing on their back
    bool looks_through = false;     ///< cameras look through some surfaces, or through their backs
    bool has_absorption = false;    ///< some medium absorbs or scatters
    bool scatters_inside = false;   ///< some medium scatters
    bool textured_media = false;    ///< as textures say, which paths bring along
    bool open_media = false;        ///< some are open, or have boundaries that are: see MediumRecord
    bool transmissive_shadows = false;  ///< shadow rays pass some surfaces: boundaries of those, and panes
    bool tracks_media = false;          ///< paths must know what they are in: that, or solids may overlap
    bool has_mixtures = false;          ///< some material is one of two
    bool sees_environment = false;      ///< rays that leave the scene bring something
    bool only_quads = false;            ///< flat, without motion and what is rare: QuadTracer renders it
    bool only_plain_quads = false;      ///< the same, and all quads are plain: see QuadColumns
    FilterTable filters[3];             ///< Gaussian, Blackman-Harris, tent

    LaneScene(std::shared_ptr<const SceneTables> t, TreeBuild level);
    std::size_t memory_bytes() const override;
    bool has_tree() const override { return !is_flat; }
    void update(const std::vector<std::uint32_t>& shapes) override;

    /// Whether some material of this ClosureKind scatters.
    bool has_closure(std::uint32_t kind) const { return kinds >> kind & 1; }
    /// shape_info of what was hit; 0 outside the mask.
    UInt info_of(UInt primitive, UInt instance, Mask m) const;

private:
    bool has_alpha() const;
    void read_tables();
    void read_shapes();
    void read_material(const MaterialRecord& material);
};

inline UInt LaneScene::info_of(UInt primitive, UInt instance, Mask m) const
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
