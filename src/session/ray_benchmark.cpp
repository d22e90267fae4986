#include "fathom/ray_benchmark.h"

#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <atomic>
#include <chrono>

#include "compile/scene_data.h"
#include "fathom/error.h"
#include "session/ray_sets.h"

namespace fathom {

namespace {

/// As many rays as the path loop has at a time.
constexpr std::size_t chunk = 512;

struct Answers {
    std::vector<float> t, u, v;
    std::vector<std::uint32_t> primitive, instance, blocked;

    explicit Answers(std::size_t n)
        : t(n + RaySet::padding), u(t.size()), v(t.size()), primitive(t.size()), instance(t.size()), blocked(t.size())
    {
    }
    HitArraysOut arrays(std::size_t first)
    {
        return {&t[first], &u[first], &v[first], &primitive[first], &instance[first]};
    }
};

RayView ray_view(const Scene::Data& scene, int width, int height)
{
    const CameraTable camera = scene.camera_table(width, height);
    const auto vector = [](const float* v) { return Vec3d{v[0], v[1], v[2]}; };
    return {vector(camera.position),
            vector(camera.right),
            vector(camera.up),
            vector(camera.forward),
            normalize(scene.camera.up),
            camera.half_width,
            camera.half_height,
            camera.orthographic != 0,
            width,
            height};
}

class Caster {
public:
    Caster(const Scene::Data& scene, int threads) : scene_(scene), arena_(threads)
    {
        // Each ray at a time of its own, where that matters.
        const SceneTables& tables = *scene.tables;
        moving_ = tables.shutter_close > tables.shutter_open;
    }

    /// Casts all of them; adds to the visits.
    void cast(const RaySet& set, Answers& answers, BvhVisits& visits)
    {
        std::atomic<std::uint64_t> nodes{0}, primitives{0};
        if (moving_ && times_.size() < set.t_max.size()) make_times(set.t_max.size());
        arena_.execute([&] {
            tbb::parallel_for(std::size_t(0), (set.count() + chunk - 1) / chunk, [&](std::size_t i) {
                const std::size_t first = i * chunk;
                RayArrays rays = set.arrays(first, std::min(chunk, set.count() - first));
                if (moving_) rays.time = &times_[first];
                BvhVisits own;
                if (set.shadow)
                    scene_.kernel->occluded(rays, &answers.blocked[first], set.coherent, own);
                else
                    scene_.kernel->closest(rays, answers.arrays(first), set.coherent, own);
                nodes += own.nodes, primitives += own.primitives;
            });
        });
        visits.nodes += nodes, visits.primitives += primitives;
    }

    std::vector<RayPoint> hit_points(const RaySet& set)
    {
        Answers answers(set.count());
        BvhVisits visits;
        cast(set, answers, visits);
        std::vector<float> numbers[6];
        for (auto& n : numbers) n.resize(set.t_max.size());
        float* const points[] = {numbers[0].data(), numbers[1].data(), numbers[2].data()};
        float* const normals[] = {numbers[3].data(), numbers[4].data(), numbers[5].data()};
        RayArrays rays = set.arrays(0, set.count());
        if (moving_) rays.time = times_.data();
        scene_.kernel->surface(rays, answers.arrays(0), points, normals);
        std::vector<RayPoint> result;
        for (std::size_t i = 0; i < set.count(); ++i)
            if (answers.primitive[i] != no_index)
                result.push_back(
                    {{points[0][i], points[1][i], points[2][i]}, {normals[0][i], normals[1][i], normals[2][i]}});
        return result;
    }

private:
    void make_times(std::size_t n)
    {
        const SceneTables& tables = *scene_.tables;
        const float length = tables.shutter_close - tables.shutter_open;
        std::uint32_t x = 1;
        while (times_.size() < n)
            times_.push_back(tables.shutter_open + length * float((x = x * 747796405u + 2891336453u) >> 8) * 0x1p-24f);
    }

    const Scene::Data& scene_;
    tbb::task_arena arena_;
    bool moving_ = false;
    std::vector<float> times_;
};

RayRate measure(Caster& caster, const RaySet& set, int runs)
{
    Answers answers(set.count());
    BvhVisits visits;
    std::vector<double> seconds;
    for (int i = 0; i <= runs; ++i) {
        visits = {};
        const auto start = std::chrono::steady_clock::now();
        caster.cast(set, answers, visits);
        // The first warms the caches.
        if (i > 0) seconds.push_back(std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
    }
    std::sort(seconds.begin(), seconds.end());
    const double n = double(set.count());
    return {set.kind, set.count(), n * 1e-6 / seconds[seconds.size() / 2], double(visits.nodes) / n,
            double(visits.primitives) / n};
}

}  // namespace

RayBenchmark benchmark_rays(const Scene& scene, const RayBenchmarkSettings& settings)
{
    if (settings.width < 1 || settings.height < 1 || settings.width > 65535 || settings.height > 65535)
        throw Error("", "", "the picture must have 1x1 to 65535x65535 pixels");
    if (settings.runs < 1 || settings.rays < 1) throw Error("", "", "at least one ray and one run are needed");
    const Scene::Data& data = scene.data();
    const int threads = settings.threads > 0 ? settings.threads : tbb::this_task_arena::max_concurrency();
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism,
                                    std::size_t(std::max(threads, tbb::this_task_arena::max_concurrency())));
    const BvhStatistics& tree = data.kernel->need_tree();
    RayBenchmark result;
    result.primitives = tree.leaf_primitives;
    result.tree_bytes = tree.bytes;
    result.peak_bytes = tree.peak_bytes;
    result.build_s = tree.build_s;

    Caster caster(data, threads);
    const std::size_t pixels = std::size_t(settings.width) * std::size_t(settings.height);
    for (const RaySet& set : make_ray_sets(
             ray_view(data, settings.width, settings.height), tree.diagonal,
             [&](const RaySet& rays) { return caster.hit_points(rays); },
             std::max<std::size_t>(1, pixels / settings.rays)))
        if (set.count() > 0) result.rates.push_back(measure(caster, set, settings.runs));
    return result;
}

}  // namespace fathom
