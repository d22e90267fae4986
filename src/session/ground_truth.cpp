// SPDX-License-Identifier: Apache-2.0
#include "fathom/ground_truth.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include "fathom/error.h"
#include "kernel/kernel.h"
#include "session/image_place.h"
#include "session/job.h"
#include "session/objects_of_shapes.h"
#include "session/thread_arena.h"

namespace fathom {

namespace {

constexpr float nowhere = std::numeric_limits<float>::infinity();
/// Rows of the image per task.
constexpr int rows_per_task = 8;

/// World and camera as the kernel sees them, in double precision.
class CenterView {
public:
    explicit CenterView(const RenderJob& job)
        : record_(job.data().camera_record),
          origin_(job.scene().data().tables->origin),
          scale_(1 / job.scene().data().tables->render_scale),
          width_(job.settings().width),
          height_(job.settings().height),
          position_(axis(record_.position)),
          right_(axis(record_.right)),
          up_(axis(record_.up)),
          forward_(axis(record_.forward))
    {
    }

    float meters(double length) const { return float(length * scale_); }
    Vec3d world(const Vec3f& p) const { return to_double(p) * scale_ + origin_; }
    Vec3d render_point(Vec3d world) const { return (world - origin_) * (1 / scale_); }
    Vec3f in_camera(const Vec3f& n) const
    {
        const Vec3d v = to_double(n);
        return {float(dot(v, right_)), float(dot(v, up_)), float(-dot(v, forward_))};
    }
    double depth(const Vec3f& p, double distance) const
    {
        return record_.spherical ? distance : dot(to_double(p) - position_, forward_);
    }
    bool is_equal_area() const { return record_.equal_area; }
    float time() const { return 0.5f * (record_.shutter_open + record_.shutter_close); }

    /// image_place() of a point of render space.
    std::array<double, 2> pixel(const Vec3d& p) const { return image_place(record_, width_, height_, p); }
    /// Flow along a row of an equirectangular image takes the shorter way around.
    double shorter_way(double dx) const { return record_.spherical ? dx - width_ * std::round(dx / width_) : dx; }

private:
    static Vec3d axis(const float* a) { return {a[0], a[1], a[2]}; }

    const CameraRecord& record_;
    const Vec3d origin_;
    const double scale_;
    const double width_, height_;
    const Vec3d position_, right_, up_, forward_;
};

/// Calls work(first row, pixels of the rows) for all rows of the image, on the threads of the job.
template <class Work>
void for_rows(const RenderJob& job, const Work& work)
{
    const int width = job.settings().width, height = job.settings().height;
    ThreadArena arena(job.settings().threads);
    arena.execute([&] {
        tbb::parallel_for(0, (height + rows_per_task - 1) / rows_per_task, [&](int task) {
            const int begin = task * rows_per_task, end = std::min(height, begin + rows_per_task);
            std::vector<std::uint32_t> pixels;
            for (int y = begin; y < end; ++y)
                for (int x = 0; x < width; ++x) pixels.push_back(std::uint32_t(y) << 16 | std::uint32_t(x));
            work(begin, pixels);
        });
    });
}

void trace(const RenderJob& job, const std::vector<std::uint32_t>& pixels, std::vector<SurfacePoint>& points,
           std::vector<ObjectOnRay>* objects)
{
    points.assign(pixels.size(), {});
    trace_pixel_centers(*job.scene().data().kernel, job.data().camera_record, job.settings().width,
                        job.settings().height, pixels, points.data(), objects);
}

GroundTruth empty_truth(int width, int height)
{
    GroundTruth truth;
    truth.width = width, truth.height = height;
    const std::size_t n = std::size_t(width) * std::size_t(height);
    truth.depth.resize(n, nowhere), truth.distance.resize(n, nowhere);
    truth.normal.resize(n), truth.camera_normal.resize(n), truth.position.resize(n);
    truth.instance.resize(n), truth.material.resize(n), truth.points.resize(n);
    return truth;
}

/// Throws Error unless primitives and instances of both scenes are those of the same shapes.
void check_same_shapes(const SceneTables& a, const SceneTables& b)
{
    if (a.primitive_count() != b.primitive_count() || a.triangle_count() != b.triangle_count() ||
        a.instances.size() != b.instances.size() || a.shape_of_primitive != b.shape_of_primitive)
        throw Error("", "", "optical flow needs the same shapes in both images; shapes have appeared or vanished");
}

std::vector<SurfacePoint> kernel_points(const GroundTruth& truth, std::size_t first, std::size_t count)
{
    std::vector<SurfacePoint> points(count);
    for (std::size_t i = 0; i < count; ++i) {
        const GroundTruth::Point& p = truth.points[first + i];
        points[i].place = p.place;
        points[i].u = p.u, points[i].v = p.v;
        points[i].primitive = p.primitive, points[i].instance = p.instance;
    }
    return points;
}

/// Adds a pixel to a mask whose pixels come in ascending order.
void add_to_mask(std::vector<std::uint32_t>& mask, std::uint32_t pixel)
{
    if (mask.empty() || mask.back() != pixel) mask.push_back(pixel);
}

}  // namespace

GroundTruth trace_ground_truth(const RenderJob& job, const std::vector<SceneObject>& objects)
{
    const int width = job.settings().width;
    GroundTruth truth = empty_truth(width, job.settings().height);
    const std::vector<std::uint32_t> of_shape = objects_of_shapes(objects);
    const CenterView view(job);
    for_rows(job, [&](int row, const std::vector<std::uint32_t>& pixels) {
        std::vector<SurfacePoint> points;
        trace(job, pixels, points, nullptr);
        std::size_t i = std::size_t(row) * std::size_t(width);
        for (const SurfacePoint& p : points) {
            const std::size_t at = i++;
            truth.points[at] = {p.place, p.u, p.v, p.primitive, p.instance};
            if (p.primitive == no_index) continue;
            truth.distance[at] = view.meters(p.distance);
            truth.depth[at] = view.meters(view.depth(p.position, p.distance));
            truth.position[at] = to_float(view.world(p.position));
            truth.normal[at] = p.normal;
            truth.camera_normal[at] = view.in_camera(p.normal);
            truth.instance[at] = instance_of(of_shape, p.object, objects.size());
            truth.material[at] = p.material + 1;
        }
    });
    return truth;
}

PinholeCamera pinhole_camera(const RenderJob& job)
{
    const CameraRecord& record = job.data().camera_record;
    if (record.orthographic || record.spherical)
        throw Error("", fmt::format("camera '{}'", job.camera().name), "only a perspective camera has a focal length");
    const int width = job.settings().width, height = job.settings().height;
    PinholeCamera camera;
    camera.fx = width / (2.0 * record.half_width), camera.fy = height / (2.0 * record.half_height);
    camera.cx = 0.5 * width * (1 - double(record.shift_right) / record.half_width);
    camera.cy = 0.5 * height * (1 + double(record.shift_up) / record.half_height);
    // The record's axes are rounded to floats; matrices of rotations should be orthonormal in double precision.
    const Vec3d back = normalize(job.camera().position - job.camera().look_at);
    const Vec3d rounded{record.right[0], record.right[1], record.right[2]};
    const Vec3d right = normalize(rounded - back * dot(rounded, back)), up = cross(back, right);
    const Vec3d p = job.camera().position;
    camera.world_from_camera.m = {
        {{right.x, up.x, back.x, p.x}, {right.y, up.y, back.y, p.y}, {right.z, up.z, back.z, p.z}}};
    return camera;
}

std::vector<ObjectMask> trace_masks(const RenderJob& job, const std::vector<SceneObject>& objects)
{
    if (objects.empty()) return {};
    const int width = job.settings().width, height = job.settings().height;
    const std::vector<std::uint32_t> of_shape = objects_of_shapes(objects);
    // Rows keep their own lists, so that the order of the threads doesn't matter.
    struct Found {
        std::uint32_t instance, pixel;
        bool visible;
    };
    std::vector<std::vector<Found>> found(std::size_t(height / rows_per_task + 1));
    for_rows(job, [&](int row, const std::vector<std::uint32_t>& pixels) {
        std::vector<SurfacePoint> points;
        std::vector<ObjectOnRay> rays;
        trace(job, pixels, points, &rays);
        const std::uint32_t first = std::uint32_t(row) * std::uint32_t(width);
        std::vector<Found>& list = found[std::size_t(row / rows_per_task)];
        for (const ObjectOnRay& r : rays)
            list.push_back(
                {instance_of(of_shape, r.object, objects.size()), first + r.pixel, r.object == points[r.pixel].object});
        std::sort(list.begin(), list.end(), [](const Found& a, const Found& b) { return a.pixel < b.pixel; });
    });
    std::vector<ObjectMask> masks(objects.size());
    for (const std::vector<Found>& list : found)
        for (const Found& f : list) {
            ObjectMask& mask = masks[f.instance - 1];
            add_to_mask(mask.whole, f.pixel);
            if (f.visible) add_to_mask(mask.visible, f.pixel);
        }
    for (std::size_t i = 0; i < masks.size(); ++i) masks[i].instance = std::uint32_t(i + 1);
    std::erase_if(masks, [](const ObjectMask& mask) { return mask.whole.empty(); });
    return masks;
}

std::vector<Vec2f> optical_flow(const GroundTruth& truth, const RenderJob& job, const RenderJob& other)
{
    constexpr float nan = std::numeric_limits<float>::quiet_NaN();
    const SceneTables& there = *other.scene().data().tables;
    check_same_shapes(*job.scene().data().tables, there);
    const CenterView from(job), to(other);
    if (from.is_equal_area() || to.is_equal_area())
        throw Error("", "", "optical flow is not defined for equal-area cameras, whose images are not continuous");
    std::vector<Vec2f> flow(truth.points.size(), {nan, nan});
    for_rows(job, [&](int row, const std::vector<std::uint32_t>& pixels) {
        const std::size_t first = std::size_t(row) * std::size_t(truth.width);
        const std::vector<SurfacePoint> points = kernel_points(truth, first, pixels.size());
        std::vector<Vec3f> moved(points.size());
        move_surface_points(there, to.time(), points.data(), points.size(), moved.data());
        for (std::size_t i = 0; i < points.size(); ++i) {
            const SurfacePoint& p = points[i];
            if (p.primitive == no_index) continue;
            const bool stands = p.instance == no_index && p.primitive >= there.first_quad();
            const Vec3d place = stands ? to.render_point(from.world(p.place)) : to_double(moved[i]);
            const auto [x, y] = to.pixel(place);
            const double dx = to.shorter_way(x - (int(pixels[i] & 0xffff) + 0.5)),
                         dy = y - (int(pixels[i] >> 16) + 0.5);
            flow[first + i] = {float(dx), float(dy)};
        }
    });
    return flow;
}

}  // namespace fathom
