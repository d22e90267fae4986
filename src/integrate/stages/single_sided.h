// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "kernel/kernel.h"
#include "kernel/pool.h"
#include "materials/read/material.h"

namespace fathom {
inline namespace FATHOM_LANES {

/// Lets camera rays pass the backs of single-sided surfaces, as backface culling does, so that a room is visible
/// through its outer wall. Surfaces hidden from cameras are passed from both sides. All other rays hit these surfaces,
/// so light sampling and BSDF sampling agree.
class CameraPassThrough {
public:
    CameraPassThrough(const LaneScene& scene, KernelCounters& counters)
        : scene_(scene), surfaces_(scene), materials_(scene), counters_(counters)
    {
    }
    /// Replaces the hits of camera paths [begin, end) on surfaces that they pass by the next hit behind. Distances stay
    /// relative to the origins of the paths.
    void pass_surfaces(const PathPool& p, HitColumns& hits, std::size_t begin, std::size_t end)
    {
        // The limit bounds the work where very many see-through surfaces lie behind each other.
        for (int i = 0; i < 256; ++i) {
            const std::size_t size = list_passed(p, hits, begin, end);
            if (size == 0) return;
            counters_.count_rays(RayKind::camera, size);
            trace(size);
            for (std::size_t k = 0; k < size; ++k) {
                const std::size_t to = paths_[k];
                hits.t[to] = way_[k] + found_.t[k];
                hits.u[to] = found_.u[k], hits.v[to] = found_.v[k];
                hits.primitive[to] = found_.primitive[k];
                if (!scene_.is_flat) hits.instance[to] = found_.instance[k];
            }
        }
    }

private:
    /// Lists rays that start behind the surfaces to pass; returns their number.
    std::size_t list_passed(const PathPool& p, const HitColumns& hits, std::size_t begin, std::size_t end)
    {
        std::size_t size = 0;
        for (std::size_t i = begin; i < end; i += lanes) {
            const UInt primitive = hits.primitive.load(i);
            const Mask hit = first_lanes(end - i) & (primitive != UInt(no_index));
            if (none(hit)) continue;
            const UInt instance = scene_.is_flat ? UInt(no_index) : hits.instance.load(i);
            const UInt material = surfaces_.material_of(surfaces_.shape_of(primitive, instance, hit), hit);
            const LaneFeatures features = materials_.features(material, hit);
            const Mask hidden = hit & features.has(MaterialFeature::hidden_from_camera);
            const Mask single = hidden | (hit & features.has(MaterialFeature::single_sided));
            if (none(single)) continue;
            const Vec3 o = p.origin.load(i), d = p.direction.load(i);
            const Float time = scene_.has(Feature::motion) ? p.time.load(i) : Float(0);
            const Surface s = surfaces_.read(
                {o, d, hits.t.load(i), hits.u.load(i), hits.v.load(i), time, primitive, instance}, single);
            const Mask passed = hidden | (single & (dot(d, s.ng) > Float(0)));
            if (none(passed)) continue;
            // The ray continues on itself, at the surface's offset behind it. From a point beside it, the next surface
            // would seem to lie beside its place, by more than that surface's own offset, and paths would leak through.
            const Float way = hits.t.load(i) + s.offset / max(abs(dot(d, s.ng)), Float(0x1p-10f));
            origin_.append(size, fma(d, way, o), passed);
            direction_.append(size, d, passed);
            time_.append(size, time, passed);
            way_.append(size, way, passed);
            paths_.append(size, iota() + UInt(std::uint32_t(i)), passed);
            size += std::size_t(count(passed));
        }
        return size;
    }
    void trace(std::size_t size)
    {
        if (!scene_.is_flat) {
            const RayArrays rays{origin_.x.data,
                                 origin_.y.data,
                                 origin_.z.data,
                                 direction_.x.data,
                                 direction_.y.data,
                                 direction_.z.data,
                                 nullptr,
                                 scene_.has(Feature::motion) ? time_.data : nullptr,
                                 size};
            scene_.bvh.closest(
                rays, {found_.t.data, found_.u.data, found_.v.data, found_.primitive.data, found_.instance.data}, true);
            return;
        }
        for (std::size_t i = 0; i < size; i += lanes) {
            const Hit hit = scene_.flat.closest(scene_.tables,
                                                {origin_.load(i), direction_.load(i), Float(infinity), time_.load(i)});
            found_.t.store(i, hit.t), found_.u.store(i, hit.u), found_.v.store(i, hit.v);
            found_.primitive.store(i, hit.primitive);
        }
    }

    const LaneScene& scene_;
    const SurfaceReader surfaces_;
    const MaterialReader materials_;
    KernelCounters& counters_;
    VectorColumn origin_, direction_;
    Column<float> time_, way_;
    Column<std::uint32_t> paths_;
    HitColumns found_;
};

}  // namespace FATHOM_LANES
}  // namespace fathom
