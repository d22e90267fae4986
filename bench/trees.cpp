// SPDX-License-Identifier: Apache-2.0
/// BVH construction alone, by Fathom and Embree in turns: wall clock time (for one thread: processor time) and
/// processor time, which other load affects less. Their ratio is the mean number of active threads.
#include <tbb/global_control.h>

#include <algorithm>
#include <cstdio>

#include "comparison.h"
#include "math/lanes.h"

namespace fathom::bench {
namespace {

struct Times {
    std::vector<double> wall, cpu;
};

void print(const char* who, const Times& times)
{
    std::printf(", \"%s_s\": %.4f, \"%s_cpu_s\": %.4f", who, median(times.wall), who, median(times.cpu));
}

}  // namespace

void measure_trees(const Mesh& mesh, const Options& options)
{
    tbb::global_control limit(tbb::global_control::max_allowed_parallelism, std::size_t(options.threads));
    Times ours, embree;
    double cost = 0;
    for (int i = 0; i < options.runs; ++i) {
        Bvh bvh;
        const double start = now(options.threads), cpu_start = now(1);
        bvh.build(mesh.tables, options.build);
        ours.wall.push_back(now(options.threads) - start);
        ours.cpu.push_back(now(1) - cpu_start);
        cost = bvh.statistics().cost;
        if (const auto theirs = build_embree(mesh.tables, options)) {
            embree.wall.push_back(theirs->build_s());
            embree.cpu.push_back(theirs->build_cpu_s());
        }
    }
    std::printf("{\"mesh\": \"%s\", \"isa\": \"%s\", \"threads\": %d, \"triangles\": %zu, \"cost\": %.3f",
                mesh.name.c_str(), lanes_name, options.threads, std::size_t(mesh.tables.triangle_count()), cost);
    print("ours", ours);
    if (options.with_embree) {
        print("embree", embree);
        std::printf(", \"ratio\": %.3f, \"cpu_ratio\": %.3f", median_ratio(embree.wall, ours.wall),
                    median_ratio(embree.cpu, ours.cpu));
    }
    std::printf("}\n");
    std::fflush(stdout);
}

}  // namespace fathom::bench
