// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <utility>

#include "kernel/lane_scene.h"
#include "kernel/pool.h"

namespace fathom {
inline namespace FATHOM_LANES {

/// Appends the numbers of the lanes of m, counted from `first`, to a list.
inline void append_indices(Mask m, std::size_t first, Column<std::uint32_t>& numbers, std::size_t& size)
{
    if (none(m)) return;
    numbers.append(size, iota() + UInt(std::uint32_t(first)), m);
    size += std::size_t(count(m));
}

/// Removes the paths that shading marked as dead; the last paths of the pool fill their places. Calls end(dead, k) for
/// each, where dead[k] is the index of the path. Returns the number of paths left.
template <class End>
std::size_t remove_dead_paths(PathPool& p, PathColumns columns, std::size_t active, Column<std::uint32_t>& dead,
                              const End& end)
{
    std::size_t size = 0;
    for (std::size_t i = 0; i < active; i += lanes)
        append_indices(first_lanes(active - i) & ((p.state.load(i) & UInt(PathPool::dead)) != UInt(0u)), i, dead, size);
    while (size > 0) {
        const std::size_t i = dead[--size];
        end(dead, size);
        if (i == --active) continue;
        PathPool::for_each_live_column(p, p, columns, [&](auto& column, auto&) { column[i] = column[active]; });
        p.bsdf_pdf[i] = p.bsdf_pdf[active];
        p.exit_offset[i] = p.exit_offset[active];
    }
    return active;
}

/// Compacts a pool after its paths were traced and sorts it by closure kind and material, so that shading runs the same
/// code on full lanes.
class PoolSorter {
public:
    explicit PoolSorter(const LaneScene& scene) : scene_(scene) {}

    /// Sets the buckets of the paths from number i on (LaneScene::shape_info): 0 for paths that do not continue.
    void set_bucket(std::size_t i, UInt bucket) { buckets_.store(i, bucket); }

    /// Copies the paths that continue into the pool `to`, and their hits. Returns their number.
    std::size_t run(PathPool& from, PathPool& to, PathColumns columns, HitColumns& hits, std::size_t active)
    {
        // Without textures, sorting by material gains nothing.
        return scene_.has(Feature::textures) ? pack_by_material(from, to, columns, hits, active)
                                             : pack_by_kind(from, to, columns, hits, active);
    }

    /// Hits of the sorted paths.
    const HitColumns& hits() const { return hits_; }
    /// End of each ClosureKind in the sorted pool.
    const std::size_t* kind_end() const { return kind_end_; }
    std::size_t size() const { return kind_end_[closure_kind_count - 1]; }

private:
    /// Compacts the paths, one closure kind after another. Returns their number.
    std::size_t pack_by_kind(PathPool& from_pool, PathPool& to_pool, PathColumns columns, HitColumns& hits,
                             std::size_t active)
    {
        std::size_t packed = 0;
        for (std::uint32_t kind = 0; kind < closure_kind_count; ++kind) {
            const auto pack = [&](std::uint32_t mask, std::uint32_t wanted) {
                for (std::size_t i = 0; i < active; i += lanes) {
                    const Mask m = (buckets_.load(i) & UInt(mask)) == UInt(wanted);
                    if (none(m)) continue;
                    const auto append = [&](const auto& from, auto& to) { to.append(packed, from.load(i), m); };
                    PathPool::for_each_live_column(from_pool, to_pool, columns, append);
                    HitColumns::for_all(hits, hits_, !scene_.is_flat, scene_.has(Feature::mixtures), append);
                    packed += std::size_t(count(m));
                }
            };
            if (scene_.closures.has(ClosureKind(kind))) {
                const std::uint32_t any_material = ~((1u << LaneScene::kind_shift) - 1);
                if (columns.has(PathColumn::nee_probability))
                    pack(any_material, kind << LaneScene::kind_shift | LaneScene::samples_light);
                pack(any_material, kind << LaneScene::kind_shift);
            }
            kind_end_[kind] = packed;
        }
        return packed;
    }

    /// pack_by_kind() with the paths of a kind sorted by material: a counting sort over buckets. Returns their number.
    std::size_t pack_by_material(PathPool& from_pool, PathPool& to_pool, PathColumns columns, HitColumns& hits,
                                 std::size_t active)
    {
        std::uint32_t place[2 * LaneScene::samples_light] = {};
        for (std::size_t i = 0; i < active; ++i) ++place[buckets_[i]];
        // Bucket 0 holds the paths that do not continue; it gets no place.
        std::uint32_t packed = 0;
        for (std::uint32_t kind = 0; kind < closure_kind_count; ++kind) {
            const auto give_places = [&](std::uint32_t mark) {
                const std::uint32_t begin = kind << LaneScene::kind_shift | mark;
                for (std::uint32_t bucket = begin; bucket < begin + (1u << LaneScene::kind_shift); ++bucket)
                    packed += std::exchange(place[bucket], packed);
            };
            if (scene_.closures.has(ClosureKind(kind))) {
                if (columns.has(PathColumn::nee_probability)) give_places(LaneScene::samples_light);
                give_places(0);
            }
            kind_end_[kind] = packed;
        }
        for (std::size_t i = 0; i < active; ++i)
            if (buckets_[i] != 0) order_[place[buckets_[i]]++] = std::uint32_t(i);
        // Scalar copies are used because SIMD gathers take as long or longer, even where the hardware has them.
        const auto permute = [&](const auto& from, auto& to) {
            for (std::size_t i = 0; i < packed; ++i) to[i] = from[order_[i]];
        };
        PathPool::for_each_live_column(from_pool, to_pool, columns, permute);
        HitColumns::for_all(hits, hits_, !scene_.is_flat, scene_.has(Feature::mixtures), permute);
        return packed;
    }

    const LaneScene& scene_;
    std::size_t kind_end_[closure_kind_count] = {};
    HitColumns hits_;
    Column<std::uint32_t> buckets_, order_;
};

}  // namespace FATHOM_LANES
}  // namespace fathom
