#pragma once
/// What the comparisons with Embree share: options, and both casting the same rays in turns.
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "embree_caster.h"

namespace fathom::bench {

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
    bool motion = false, instances = false, trees = false;
    std::string kind;   ///< of rays; empty: all
    std::string write;  ///< a folder to write the meshes to, instead
};

double median(std::vector<double> x);
/// That f takes.
double seconds(int threads, const std::function<void()>& f);

/// The same scene, ours and theirs.
struct Scene {
    const char* name;
    const Bvh& bvh;
    const EmbreeCaster* embree;  ///< null: only ours is measured
    /// Embree 3.13.5 does not return from some shadow rays into instances if they have the coherent hint.
    bool hint_hangs = false;
};

/// Million rays/s: by scene, then run by run.
struct Rates {
    std::vector<std::vector<double>> ours, embree;
};

/// Casts the rays into all of the scenes in turns, by Embree in the way that is fastest for each (without it,
/// ours count twice). Warns where more than one in ten thousand differ.
Rates compare(const std::string& mesh, const RaySet& set, const std::vector<Scene>& scenes, const Options& options);

/// Both built on as many threads as the options say; Embree's null where only ours is to be measured.
Bvh build(const GeometryTables& tables, const Options& options);
std::unique_ptr<EmbreeCaster> build_embree(const GeometryTables& tables, const Options& options);

/// Of quotients run by run.
double median_ratio(const std::vector<double>& a, const std::vector<double>& b);

/// The mesh at rest against itself with moving vertices, placed, and placed and moving.
void measure_motion(const Mesh& mesh, const Options& options);
/// The mesh in ten thousand places.
void measure_instances(const Mesh& mesh, const Options& options);
/// Building alone.
void measure_trees(const Mesh& mesh, const Options& options);

}  // namespace fathom::bench
