/// Million rays per second by kind of ray, ours and Embree's, on the same rays in one process. See bench/rays.sh.
#include <tbb/global_control.h>

#include <algorithm>
#include <cstdio>
#include <cstring>
#include <functional>
#include <stdexcept>
#include <thread>

#include "embree_caster.h"
#include "math/lanes.h"

namespace fathom::bench {
namespace {

struct Options {
    struct Source {
        std::string name;
        bool generated;
    };
    std::vector<Source> meshes;
    int threads = 1, runs = 5;
    std::size_t parts = 1;
    TreeBuild build = TreeBuild::standard;
    bool robust = true, details = false, with_embree = true;
};

double seconds(int threads, const std::function<void()>& f)
{
    const double start = now(threads);
    f();
    return now(threads) - start;
}

double median(std::vector<double> x)
{
    std::sort(x.begin(), x.end());
    return x[x.size() / 2];
}

/// Casts a whole set, chunk by chunk; the seconds that took.
template <class Cast>
double run(const RaySet& set, int threads, const Cast& cast)
{
    constexpr std::size_t chunk = 1024;
    std::atomic<std::size_t> next{0};
    const auto work = [&] {
        for (std::size_t first; (first = next.fetch_add(chunk)) < set.count();)
            cast(first, std::min(chunk, set.count() - first));
    };
    return seconds(threads, [&] {
        std::vector<std::thread> others;
        for (int i = 1; i < threads; ++i) others.emplace_back(work);
        work();
        for (std::thread& t : others) t.join();
    });
}

/// Rays whose answers differ by more than rounding.
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

void compare(const Mesh& mesh, const RaySet& set, const Bvh& bvh, const EmbreeCaster& embree, const Options& options)
{
    Results ours(set.count()), theirs(set.count());
    const auto run_ours = [&] {
        return run(set, options.threads, [&](std::size_t first, std::size_t n) {
            if (set.shadow)
                bvh.occluded(set.arrays(first, n), &ours.blocked[first], set.coherent);
            else
                bvh.closest(set.arrays(first, n), ours.arrays(first), set.coherent);
        });
    };
    const auto run_theirs = [&](EmbreeCaster::Call call, bool coherent) {
        return run(set, options.threads,
                   [&](std::size_t first, std::size_t n) { embree.cast(set, first, n, call, coherent, theirs); });
    };
    // Their best way for these rays, then both in turns.
    double best = 1e300;
    auto call = EmbreeCaster::single;
    bool coherent = false;
    const char* const names[] = {"1", "8", "16", "stream"};
    for (int c = 0; c < EmbreeCaster::call_count && options.with_embree; ++c)
        for (bool hint : {false, true}) {
            if (hint && !set.coherent) continue;
            double s = 1e300;
            for (int i = 0; i < 2; ++i) s = std::min(s, run_theirs(EmbreeCaster::Call(c), hint));
            if (options.details)
                std::fprintf(stderr, "  embree %s%s: %.2f\n", names[c], hint ? " coherent" : "",
                             double(set.count()) / s * 1e-6);
            if (s < best) best = s, call = EmbreeCaster::Call(c), coherent = hint;
        }
    run_ours();
    std::vector<double> a, b, ratio;
    for (int i = 0; i < options.runs; ++i) {
        a.push_back(run_ours());
        b.push_back(options.with_embree ? run_theirs(call, coherent) : a.back());
        ratio.push_back(b.back() / a.back());
    }
    const std::size_t n = options.with_embree ? differences(set, ours, theirs) : 0;
    if (n * 10'000 > set.count())
        std::fprintf(stderr, "%s, %s: %zu of %zu rays differ\n", mesh.name.c_str(), set.kind.c_str(), n, set.count());
    const double rays = double(set.count()) * 1e-6;
    std::printf(
        "{\"mesh\": \"%s\", \"kind\": \"%s\", \"isa\": \"%s\", \"threads\": %d, \"ours\": %.3f, \"embree\": %.3f, "
        "\"ratio\": %.3f}\n",
        mesh.name.c_str(), set.kind.c_str(), lanes_name, options.threads, rays / median(a), rays / median(b),
        median(ratio));
    std::fflush(stdout);
    if (options.details) std::fprintf(stderr, "%s, %s: embree %s\n", mesh.name.c_str(), set.kind.c_str(), names[call]);
}

void measure(const Mesh& mesh, const Options& options)
{
    const double triangles = mesh.tables.triangle_count();
    tbb::global_control limit(tbb::global_control::max_allowed_parallelism, std::size_t(options.threads));
    Bvh bvh;
    std::vector<double> build;
    for (int i = 0; i < (triangles < 2e6 ? 3 : 1); ++i)
        build.push_back(seconds(options.threads, [&] { bvh.build(mesh.tables, options.build); }));
    const EmbreeCaster embree(mesh, std::string(lanes_name) == "AVX2" ? "avx2" : "", options.threads, options.robust);
    const BvhStatistics& s = bvh.statistics();
    if (options.details)
        std::fprintf(stderr, "%s: cost %.2f, %zu nodes of %.1f children, %zu leaves of %.1f\n", mesh.name.c_str(),
                     s.cost, s.nodes, double(s.children) / double(std::max<std::size_t>(1, s.nodes)), s.leaves,
                     double(s.leaf_primitives) / double(std::max<std::size_t>(1, s.leaves)));
    for (const RaySet& set : make_ray_sets(mesh, bvh, options.parts)) compare(mesh, set, bvh, embree, options);
    std::printf(
        "{\"mesh\": \"%s\", \"isa\": \"%s\", \"threads\": %d, \"triangles\": %.0f, \"build_mtris_s\": {\"ours\": %.2f, "
        "\"embree\": %.2f}, "
        "\"bytes_per_triangle\": {\"ours\": %.1f, \"embree\": %.1f}, \"peak_bytes_per_triangle\": {\"ours\": %.1f, "
        "\"embree\": %.1f}}\n",
        mesh.name.c_str(), lanes_name, options.threads, triangles, triangles * 1e-6 / median(build),
        triangles * 1e-6 / embree.build_s(), double(s.bytes) / triangles, double(embree.bytes()) / triangles,
        double(s.peak_bytes) / triangles, double(embree.peak_bytes()) / triangles);
    std::fflush(stdout);
}

int run_all(int argc, char** argv)
{
    Options options;
    for (int i = 1; i < argc; ++i) {
        const std::string arg = argv[i];
        const auto value = [&] {
            if (++i >= argc) throw std::runtime_error(arg + ": needs a value");
            return std::string(argv[i]);
        };
        if (arg == "--mesh" || arg == "--generate")
            options.meshes.push_back({value(), arg == "--generate"});
        else if (arg == "--threads")
            options.threads = std::stoi(value());
        else if (arg == "--runs")
            options.runs = std::stoi(value());
        else if (arg == "--parts")
            options.parts = std::stoul(value());
        else if (arg == "--build") {
            const std::string level = value();
            if (level != "fast" && level != "default" && level != "high")
                throw std::runtime_error("--build: known are fast, default, high");
            options.build = level == "fast" ? TreeBuild::fast : level == "high" ? TreeBuild::high : TreeBuild::standard;
        } else if (arg == "--not-robust")
            options.robust = false;
        else if (arg == "--ours-only")
            options.with_embree = false;
        else if (arg == "--details")
            options.details = true;
        else
            throw std::runtime_error(arg +
                                     ": known are --mesh FILE.ply, --generate NAME, --threads N, --runs N, --parts N, "
                                     "--build fast|default|high, --not-robust, --ours-only, --details");
    }
    for (const Options::Source& mesh : options.meshes)
        measure(mesh.generated ? generate(mesh.name) : read_ply(mesh.name), options);
    return 0;
}

}  // namespace
}  // namespace fathom::bench

int main(int argc, char** argv)
{
    try {
        return fathom::bench::run_all(argc, argv);
    } catch (const std::exception& e) {
        std::fprintf(stderr, "rays: %s\n", e.what());
        return 2;
    }
}
