// SPDX-License-Identifier: Apache-2.0
/// Million rays per second by kind of ray, by Fathom and by Embree, on the same rays in one process. See bench/rays.sh.
#include <tbb/global_control.h>

#include <algorithm>
#include <cstdio>
#include <stdexcept>

#include "comparison.h"
#include "math/lanes.h"

namespace fathom::bench {
namespace {

void measure(const Mesh& mesh, const Options& options)
{
    const double triangles = mesh.tables.triangle_count();
    tbb::global_control limit(tbb::global_control::max_allowed_parallelism, std::size_t(options.threads));
    Bvh bvh;
    std::vector<double> build;
    for (int i = 0; i < (triangles < 2e6 ? 3 : 1); ++i)
        build.push_back(seconds(options.threads, [&] { bvh.build(mesh.tables, options.build); }));
    const auto embree = build_embree(mesh.tables, options);
    const BvhStatistics& s = bvh.statistics();
    if (options.details)
        std::fprintf(stderr, "%s: cost %.2f, %zu nodes of %.1f children, %zu leaves of %.1f\n", mesh.name.c_str(),
                     s.cost, s.nodes, double(s.children) / double(std::max<std::size_t>(1, s.nodes)), s.leaves,
                     double(s.leaf_primitives) / double(std::max<std::size_t>(1, s.leaves)));
    for (const RaySet& set : make_ray_sets(mesh, bvh, options.parts)) {
        if (!options.kind.empty() && set.kind != options.kind) continue;
        const Rates rates = compare(mesh.name, set, {{"still", bvh, embree.get()}}, options);
        std::printf(
            "{\"mesh\": \"%s\", \"kind\": \"%s\", \"isa\": \"%s\", \"threads\": %d, \"ours\": %.3f, \"embree\": %.3f, "
            "\"ratio\": %.3f}\n",
            mesh.name.c_str(), set.kind.c_str(), lanes_name, options.threads, median(rates.ours[0]),
            median(rates.embree[0]), median_ratio(rates.ours[0], rates.embree[0]));
        std::fflush(stdout);
    }
    std::printf(
        "{\"mesh\": \"%s\", \"isa\": \"%s\", \"threads\": %d, \"triangles\": %.0f, \"build_mtris_s\": {\"ours\": %.2f, "
        "\"embree\": %.2f}, "
        "\"bytes_per_triangle\": {\"ours\": %.1f, \"embree\": %.1f}, \"peak_bytes_per_triangle\": {\"ours\": %.1f, "
        "\"embree\": %.1f}}\n",
        mesh.name.c_str(), lanes_name, options.threads, triangles, triangles * 1e-6 / median(build),
        embree ? triangles * 1e-6 / embree->build_s() : 0, double(s.bytes) / triangles,
        embree ? double(embree->bytes()) / triangles : 0, double(s.peak_bytes) / triangles,
        embree ? double(embree->peak_bytes()) / triangles : 0);
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
            const std::string_view levels[] = {"fast", "standard", "high", "compact"};  // in the order of BvhQuality
            const auto found = std::find(std::begin(levels), std::end(levels), level);
            if (found == std::end(levels)) throw std::runtime_error("--build: known are fast, standard, high, compact");
            options.build = BvhQuality(found - std::begin(levels));
        } else if (arg == "--not-robust")
            options.robust = false;
        else if (arg == "--ours-only")
            options.with_embree = false;
        else if (arg == "--details")
            options.details = true;
        else if (arg == "--kind")
            options.kind = value();
        else if (arg == "--write")
            options.write = value();
        else if (arg == "--motion")
            options.motion = true;
        else if (arg == "--instances")
            options.instances = true;
        else if (arg == "--trees")
            options.trees = true;
        else
            throw std::runtime_error(
                arg +
                ": known are --mesh FILE.ply, --generate NAME, --threads N, --runs N, --parts N, "
                "--build fast|default|high|compact, --not-robust, --ours-only, --details, --motion, "
                "--instances, --trees, --kind NAME, --write FOLDER");
    }
    const auto measure_mesh = options.trees       ? measure_trees
                              : options.instances ? measure_instances
                              : options.motion    ? measure_motion
                                                  : measure;
    for (const Options::Source& source : options.meshes) {
        const Mesh mesh = source.generated ? generate(source.name) : read_ply(source.name);
        if (options.write.empty())
            measure_mesh(mesh, options);
        else
            write_ply(mesh, options.write + "/" + mesh.name + ".ply");
    }
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
