// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <bit>
#include <mutex>

#include "fathom/description.h"
#include "geometry/bvh/bvh.h"
#include "geometry/flat/flat.h"
#include "kernel/features.h"
#include "kernel/kernel.h"
#include "kernel/quad_columns.h"
#include "materials/closures/closures.h"
#include "math/gather_member.h"
#include "sampling/filter.h"

namespace fathom {
inline namespace FATHOM_LANES {

/// The kernel's scene: the compiled tables, the acceleration structure, and what is derived from both.
struct LaneScene final : KernelScene {
    std::shared_ptr<const SceneTables> tables_owner;
    const SceneTables& tables;
    /// Scenes of a few dozen primitives are traced as a flat list (`flat`), larger ones by the BVH (`bvh`).
    bool is_flat = false;
    FlatScene flat;
    Bvh bvh;
    /// Indexed by shape: the sort bucket of its material in the low bits, flags in the high bits.
    std::vector<std::uint32_t> shape_info;
    static constexpr std::uint32_t emits = 1u << 31, is_mixture = 1u << 30;
    /// Shadow rays and paths may pass the surface undeflected (passes_shadow_rays) without counting a bounce
    /// (passes_without_bounce).
    static constexpr std::uint32_t passes_shadow_rays = 1u << 29, passes_without_bounce = 1u << 28;
    /// Indexed by material: its sort bucket, for the constituents of mixtures.
    std::vector<std::uint32_t> material_bucket;
    /// Sort key of paths before shading: first the ClosureKind, then the material modulo 32.
    static constexpr std::uint32_t kind_shift = 5;
    static constexpr std::uint32_t buckets = closure_kind_count << kind_shift;
    static constexpr std::uint32_t bucket_mask = std::bit_ceil(buckets) - 1;
    static constexpr std::uint32_t samples_light = bucket_mask + 1;  ///< bucket flag of paths that sample a light
    static_assert((samples_light | bucket_mask) < passes_without_bounce && closure_kind_count <= 32);
    /// Indexed by primitive of a flat scene: the shape_info of its shape; padded for lookup().
    std::vector<std::uint32_t> primitive_info;
    QuadColumns quads;
    Features features;
    EnumSet<ClosureKind> closures;  ///< kinds of the closures that scatter
    FilterTable filters[3];         ///< tables of the filters Gaussian, Blackman-Harris and tent
    /// Per light the two words of the MediumStack around it; empty until light tracing needs them.
    mutable std::vector<std::uint32_t> light_media;
    mutable std::mutex light_media_mutex;

    LaneScene(std::shared_ptr<const SceneTables> t, BvhQuality level);
    std::size_t memory_bytes() const override;
    bool has_tree() const override { return !is_flat; }
    bool has_quad_loop() const override { return features.has(Feature::only_quads); }
    void update(const std::vector<std::uint32_t>& shapes) override;
    void force_general_loop() override { features.remove(Feature::only_quads); }

    bool has(Feature feature) const { return features.has(feature); }
    /// shape_info of the shape that was hit; 0 outside the mask.
    UInt shape_info_of(UInt primitive, UInt instance, Mask m) const;
    /// The shape that was hit, in the lanes of m.
    UInt shape_of(UInt primitive, UInt instance, Mask m) const;

private:
    bool has_alpha() const;
    void read_tables();
    void read_shapes();
};

inline UInt LaneScene::shape_of(UInt primitive, UInt instance, Mask m) const
{
    const UInt shape = gather(tables.shape_of_primitive.data(), primitive, m);
    if (tables.instances.empty()) return shape;
    const Mask placed = m & (instance != UInt(no_index));
    return select(placed, gather(tables.instances, &InstanceRecord::shape, instance, placed), shape);
}

inline UInt LaneScene::shape_info_of(UInt primitive, UInt instance, Mask m) const
{
    if (is_flat) return lookup_or_gather(primitive_info.data(), int(tables.shape_of_primitive.size()), primitive, m);
    return gather(shape_info.data(), shape_of(primitive, instance, m), m);
}

}  // namespace FATHOM_LANES
}  // namespace fathom
