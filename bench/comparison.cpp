// SPDX-License-Identifier: Apache-2.0
#include "comparison.h"

#include <tbb/global_control.h>

#include <algorithm>
#include <atomic>
#include <cstdio>
#include <thread>

#include "math/lanes.h"

namespace fathom::bench {

double median(std::vector<double> x)
{
    std::sort(x.begin(), x.end());
    return x[x.size() / 2];
}

double seconds(int threads, const std::function<void()>& f)
{
    const double start = now(threads);
    f();
    return now(threads) - start;
}

Bvh build(const GeometryTables& tables, const Options& options)
{
    tbb::global_control limit(tbb::global_control::max_allowed_parallelism, std::size_t(options.threads));
    Bvh bvh;
    bvh.build(tables, options.build);
    return bvh;
}

std::unique_ptr<EmbreeCaster> build_embree(const GeometryTables& tables, const Options& options)
{
    if (!options.with_embree) return nullptr;
    const char* const isa = std::string(lanes_name) == "AVX2" ? "avx2" : "";  // SIMD level of this build
    return std::make_unique<EmbreeCaster>(tables, isa, options.threads, options.robust);
}

double median_ratio(const std::vector<double>& a, const std::vector<double>& b)
{
    std::vector<double> ratio;
    for (std::size_t i = 0; i < a.size(); ++i) ratio.push_back(a[i] / b[i]);
    return median(ratio);
}

namespace {

/// Casts a whole set in chunks; returns million rays per second.
template <class Cast>
double run(const RaySet& set, int threads, const Cast& cast)
{
    constexpr std::size_t chunk = 1024;
    std::atomic<std::size_t> next{0};
    const auto work = [&] {
        for (std::size_t first; (first = next.fetch_add(chunk)) < set.count();)
            cast(first, std::min(chunk, set.count() - first));
    };
    return double(set.count()) * 1e-6 / seconds(threads, [&] {
               std::vector<std::thread> others;
               for (int i = 1; i < threads; ++i) others.emplace_back(work);
               work();
               for (std::thread& t : others) t.join();
           });
}

double run_ours(const RaySet& set, const Bvh& bvh, int threads, Results& results)
{
    return run(set, threads, [&](std::size_t first, std::size_t n) {
        if (set.shadow)
            bvh.occluded(set.arrays(first, n), &results.blocked[first], set.coherent);
        else
            bvh.closest(set.arrays(first, n), results.arrays(first), set.coherent);
    });
}

struct EmbreeWay {
    EmbreeCaster::Call call = EmbreeCaster::single;
    bool coherent = false;
};

double run_embree(const RaySet& set, const EmbreeCaster& embree, EmbreeWay way, int threads, Results& results)
{
    return run(set, threads,
               [&](std::size_t first, std::size_t n) { embree.cast(set, first, n, way.call, way.coherent, results); });
}

EmbreeWay best_way(const RaySet& set, const Scene& scene, const Options& options, Results& results)
{
    static const char* const names[] = {"1", "8", "16", "stream"};
    double best = 0;
    EmbreeWay best_way;
    for (int call = 0; call < EmbreeCaster::call_count; ++call)
        for (bool hint : {false, true}) {
            if (hint && !set.coherent) continue;
            if (hint && set.shadow && scene.hint_hangs) continue;
            const EmbreeWay way{EmbreeCaster::Call(call), hint};
            double rate = 0;
            for (int i = 0; i < 2; ++i)
                rate = std::max(rate, run_embree(set, *scene.embree, way, options.threads, results));
            if (options.details)
                std::fprintf(stderr, "  %s, %s: embree %s%s: %.2f\n", set.kind.c_str(), scene.name, names[call],
                             hint ? " coherent" : "", rate);
            if (rate > best) best = rate, best_way = way;
        }
    return best_way;
}

void print_visits(const RaySet& set, const Scene& scene)
{
    BvhVisits visits;
    Results results(set.count());
    if (set.shadow)
        scene.bvh.occluded(set.arrays(0, set.count()), results.blocked.data(), set.coherent, &visits);
    else
        scene.bvh.closest(set.arrays(0, set.count()), results.arrays(0), set.coherent, &visits);
    const double rays = double(set.count());
    std::fprintf(stderr, "  %s, %s: %.2f nodes, %.2f triangles a ray\n", set.kind.c_str(), scene.name,
                 double(visits.nodes) / rays, double(visits.primitives) / rays);
}

/// Number of rays whose hits differ by more than rounding.
std::size_t differences(const RaySet& set, const Results& a, const Results& b)
{
    std::size_t n = 0;
    for (std::size_t i = 0; i < set.count(); ++i) {
        if (set.shadow)
            n += a.blocked[i] != b.blocked[i];
        else
            n += !(a.t[i] == b.t[i] || std::abs(a.t[i] - b.t[i]) <= 1e-3f * b.t[i]);
    }
    return n;
}

}  // namespace

Rates compare(const std::string& mesh, const RaySet& set, const std::vector<Scene>& scenes, const Options& options)
{
    std::vector<Results> ours(scenes.size(), Results(set.count()));
    Results theirs(set.count());
    std::vector<EmbreeWay> ways(scenes.size());
    for (std::size_t s = 0; s < scenes.size(); ++s) {
        if (options.details) print_visits(set, scenes[s]);
        if (scenes[s].embree) ways[s] = best_way(set, scenes[s], options, theirs);
        run_ours(set, scenes[s].bvh, options.threads, ours[s]);
    }
    Rates rates{std::vector<std::vector<double>>(scenes.size()), std::vector<std::vector<double>>(scenes.size())};
    for (int i = 0; i < options.runs; ++i)
        for (std::size_t s = 0; s < scenes.size(); ++s) {
            rates.ours[s].push_back(run_ours(set, scenes[s].bvh, options.threads, ours[s]));
            if (!scenes[s].embree) {
                rates.embree[s].push_back(rates.ours[s].back());
                continue;
            }
            rates.embree[s].push_back(run_embree(set, *scenes[s].embree, ways[s], options.threads, theirs));
            if (i > 0) continue;
            const std::size_t n = differences(set, ours[s], theirs);
            if (n * 10'000 > set.count())
                std::fprintf(stderr, "%s, %s, %s: %zu of %zu rays differ\n", mesh.c_str(), scenes[s].name,
                             set.kind.c_str(), n, set.count());
        }
    return rates;
}

}  // namespace fathom::bench
