// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Options and measurements of the comparison with Embree, which traces the same rays in turns.
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "embree_caster.h"

namespace fathom::bench {

/// Command line options of the program `rays`.
struct Options {
    struct Source {
        std::string name;
        bool generated;
    };
    std::vector<Source> meshes;
    int threads = 1, runs = 5;
    std::size_t parts = 1;
    BvhQuality build = BvhQuality::standard;
    bool robust = true, details = false, with_embree = true;
    bool motion = false, instances = false, trees = false;
    std::string kind;   ///< kind of rays; empty: all
    std::string write;  ///< folder to write the meshes to instead of measuring
};

/// Median of a set of numbers.
double median(std::vector<double> x);
/// Time that f takes.
double seconds(int threads, const std::function<void()>& f);

/// The BVHs of a scene: Fathom's and Embree's.
struct Scene {
    const char* name;
    const Bvh& bvh;
    const EmbreeCaster* embree;  ///< null: measures Fathom only
    /// Embree 3.13.5 does not return from some shadow rays into instances with the coherent hint.
    bool hint_hangs = false;
};

/// Million rays per second, by scene and run.
struct Rates {
    std::vector<std::vector<double>> ours, embree;
};

/// Traces a ray set through all scenes in turns, by Embree with its fastest call for each (without Embree, Fathom's
/// rates count twice). Warns if more than one ray in ten thousand differs.
Rates compare(const std::string& mesh, const RaySet& set, const std::vector<Scene>& scenes, const Options& options);

/// Builds a BVH on the given number of threads; build_embree returns null if only Fathom is measured.
Bvh build(const GeometryTables& tables, const Options& options);
std::unique_ptr<EmbreeCaster> build_embree(const GeometryTables& tables, const Options& options);

/// Median of the ratios of corresponding runs.
double median_ratio(const std::vector<double>& a, const std::vector<double>& b);

/// Measures the mesh at rest, with moving vertices, instanced, and in a moving instance.
void measure_motion(const Mesh& mesh, const Options& options);
/// Measures ten thousand instances of the mesh.
void measure_instances(const Mesh& mesh, const Options& options);
/// Measures BVH construction alone.
void measure_trees(const Mesh& mesh, const Options& options);

}  // namespace fathom::bench
