// SPDX-License-Identifier: Apache-2.0
/// One ray through the center of each pixel, for ground truth: the first surface, and all objects behind each other.
#include <algorithm>

#include "geometry/surface/surface.h"
#include "integrate/alpha.h"
#include "kernel/camera.h"
#include "kernel/kernel.h"
#include "kernel/pool.h"
#include "materials/read/material.h"

namespace fathom {
inline namespace FATHOM_LANES {

namespace {

/// Camera without a lens, whose shutter opens only for the middle of its interval.
CameraRecord central_camera(CameraRecord camera)
{
    camera.lens_radius = 0;
    camera.shutter_open = camera.shutter_close = 0.5f * (camera.shutter_open + camera.shutter_close);
    return camera;
}

class PixelCenterTracer {
public:
    PixelCenterTracer(const LaneScene& scene, const CameraRecord& camera, SurfacePoint* points,
                      std::vector<ObjectOnRay>* objects)
        : scene_(scene),
          surfaces_(scene),
          materials_(scene),
          camera_(central_camera(camera)),
          time_(camera_.shutter_open),
          points_(points),
          objects_(objects)
    {
    }

    /// Traces the pixels [first, first + count) of `pixels`; count is at most pool_capacity.
    void run(const std::vector<std::uint32_t>& pixels, std::size_t first, std::size_t count, int width, int height)
    {
        for (std::size_t i = 0; i < count; i += lanes) generate(pixels, first, i, width, height);
        std::size_t active = count;
        // The limit bounds the work where very many surfaces lie behind each other.
        for (int layer = 0; layer < 4096 && active > 0; ++layer) {
            trace(active);
            active = take_hits(active);
        }
    }

private:
    void generate(const std::vector<std::uint32_t>& pixels, std::size_t first, std::size_t i, int width, int height)
    {
        std::uint32_t xy[lanes];
        for (std::size_t lane = 0; lane < lanes; ++lane)
            xy[lane] = pixels[std::min(first + i + lane, pixels.size() - 1)];
        const UInt word = load(xy);
        const Float x = (to_float(word & UInt(0xffffu)) + Float(0.5f)) * Float(1.0f / float(width));
        const Float y = (to_float(word >> 16) + Float(0.5f)) * Float(1.0f / float(height));
        const CameraRay ray = camera_ray(camera_, x, y, {Float(0.5f), Float(0.5f)}, Float(0));
        origin_.store(i, ray.o);
        direction_.store(i, ray.d);
        way_.store(i, Float(0));
        pixel_.store(i, UInt(std::uint32_t(first + i)) + iota());
        last_object_.store(i, UInt(no_index));
    }

    void trace(std::size_t count)
    {
        if (scene_.is_flat) {
            for (std::size_t i = 0; i < count; i += lanes) {
                const Hit hit = scene_.flat.closest(
                    scene_.tables, {origin_.load(i), direction_.load(i), Float(infinity), Float(time_)});
                hits_.t.store(i, hit.t), hits_.u.store(i, hit.u), hits_.v.store(i, hit.v);
                hits_.primitive.store(i, hit.primitive), hits_.instance.store(i, UInt(no_index));
            }
            return;
        }
        for (std::size_t i = 0; i < count; i += lanes) times_.store(i, Float(time_));
        const RayArrays rays{origin_.x.data,
                             origin_.y.data,
                             origin_.z.data,
                             direction_.x.data,
                             direction_.y.data,
                             direction_.z.data,
                             nullptr,
                             scene_.has(Feature::motion) ? times_.data : nullptr,
                             count,
                             &is_half_opaque};
        scene_.bvh.closest(rays, {hits_.t.data, hits_.u.data, hits_.v.data, hits_.primitive.data, hits_.instance.data},
                           true);
    }

    /// Records the surfaces of the first `count` rays. Keeps those that go on behind their surface, and returns their
    /// number.
    std::size_t take_hits(std::size_t count)
    {
        std::size_t kept = 0;
        for (std::size_t i = 0; i < count; i += lanes) {
            const Mask met = first_lanes(count - i) & (hits_.primitive.load(i) != UInt(no_index));
            if (none(met)) continue;
            const SurfaceHit hit{origin_.load(i), direction_.load(i), hits_.t.load(i),         hits_.u.load(i),
                                 hits_.v.load(i), Float(time_),       hits_.primitive.load(i), hits_.instance.load(i)};
            const Surface s = surfaces_.read(hit, met);
            const Mask passed = passes(hit, s, met), seen = met & !passed;
            const UInt object = surfaces_.object_of(hit, s.shape, met);
            if (any(seen)) record(i, hit, s, object, seen);
            kept = keep(i, kept, hit, s, select(seen, object, last_object_.load(i)), objects_ ? met : passed);
        }
        return kept;
    }

    /// Surfaces that camera rays pass: hidden ones, backs of single-sided ones, and boundaries of media of index 1.
    Mask passes(const SurfaceHit& hit, const Surface& s, Mask m) const
    {
        const LaneFeatures features = materials_.features(s.material, m);
        return m & (features.has(MaterialFeature::hidden_from_camera) |
                    features.has(MaterialFeature::index_matched_boundary) |
                    (features.has(MaterialFeature::single_sided) & (dot(hit.d, s.ng) > Float(0))));
    }

    /// Continues the rays of `m` behind their surfaces; see CameraPassThrough.
    std::size_t keep(std::size_t i, std::size_t kept, const SurfaceHit& hit, const Surface& s, UInt object, Mask m)
    {
        if (none(m)) return kept;
        // Rays advance by rounding's share of their length at least, so that each one ends.
        const Float step = s.offset / max(abs(dot(hit.d, s.ng)), Float(0x1p-10f));
        const Float way = hit.t + max(step, hit.t * Float(0x1p-21f));
        const Float before = way_.load(i);
        const UInt pixel = pixel_.load(i);
        origin_.append(kept, fma(hit.d, way, hit.o), m);
        direction_.append(kept, hit.d, m);
        way_.append(kept, before + way, m);
        pixel_.append(kept, pixel, m);
        last_object_.append(kept, object, m);
        return kept + std::size_t(fathom::count(m));
    }

    void record(std::size_t i, const SurfaceHit& hit, const Surface& s, UInt object, Mask m)
    {
        std::uint32_t objects[lanes];
        store(objects, object);
        if (objects_)
            for_each_active(m, [&](int lane) {
                if (objects[lane] != last_object_[i + std::size_t(lane)])
                    objects_->push_back({objects[lane], pixel_[i + std::size_t(lane)]});
            });
        const Mask first = m & (last_object_.load(i) == UInt(no_index));
        if (any(first)) record_first(i, hit, s, objects, first);
    }

    void record_first(std::size_t i, const SurfaceHit& hit, const Surface& s, const std::uint32_t* objects, Mask m)
    {
        Vec3 place = s.p;
        const Mask placed = m & (hit.instance != UInt(no_index));
        if (any(placed))
            place =
                select(placed, object_from_render(scene_.tables, hit.instance, Float(time_), placed).point(s.p), place);
        const Vec3 n = flip_sign(s.ns, -dot(hit.d, s.ng));
        const Float numbers[] = {way_.load(i) + hit.t, s.p.x, s.p.y, s.p.z, n.x, n.y, n.z, place.x, place.y, place.z};
        float number[std::size(numbers)][lanes];
        for (std::size_t k = 0; k < std::size(numbers); ++k) store(number[k], numbers[k]);
        std::uint32_t materials[lanes];
        store(materials, s.material);
        for_each_active(m, [&](int lane) {
            const std::size_t at = i + std::size_t(lane);
            const auto vector = [&](int k) { return Vec3f{number[k][lane], number[k + 1][lane], number[k + 2][lane]}; };
            points_[pixel_[at]] = {number[0][lane], vector(1),      vector(4),           vector(7),
                                   hits_.u[at],     hits_.v[at],    hits_.primitive[at], hits_.instance[at],
                                   objects[lane],   materials[lane]};
        });
    }

    const LaneScene& scene_;
    const SurfaceReader surfaces_;
    const MaterialReader materials_;
    const CameraRecord camera_;
    const float time_;
    SurfacePoint* const points_;
    std::vector<ObjectOnRay>* const objects_;
    VectorColumn origin_, direction_;
    Column<float> way_, times_;                  ///< way_: distance of the origin from the camera
    Column<std::uint32_t> pixel_, last_object_;  ///< index in the job; the object that the ray has met last
    HitColumns hits_;
};

}  // namespace

}  // namespace FATHOM_LANES

void trace_pixel_centers(const KernelScene& scene, const CameraRecord& camera, int width, int height,
                         const std::vector<std::uint32_t>& pixels, SurfacePoint* points,
                         std::vector<ObjectOnRay>* objects)
{
    const auto tracer =
        std::make_unique<PixelCenterTracer>(static_cast<const LaneScene&>(scene), camera, points, objects);
    for (std::size_t first = 0; first < pixels.size(); first += pool_capacity)
        tracer->run(pixels, first, std::min(pool_capacity, pixels.size() - first), width, height);
}

}  // namespace fathom
