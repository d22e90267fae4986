#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <nlohmann/json.hpp>
#include <thread>

#include "arguments.h"
#include "commands.h"
#include "fathom/ray_benchmark.h"
#include "reporter.h"
#include "scene_options.h"

namespace fathom::cli {

namespace {

using nlohmann::ordered_json;

struct BenchOptions {
    SceneOptions scene;
    RayBenchmarkSettings rays;
    bool json = false;
};

ordered_json describe(const BenchOptions& o, TreeBuild build, const RayBenchmark& b)
{
    const double primitives = double(std::max<std::size_t>(1, b.primitives));
    ordered_json json = {{"scene", o.scene.file.string()},
                         {"isa", simd_name()},
                         {"threads", o.rays.threads},
                         {"build", tree_build_names[std::size_t(build)]},
                         {"triangles", b.primitives},
                         {"build_s", b.build_s},
                         {"build_mtris_s", b.build_s > 0 ? double(b.primitives) * 1e-6 / b.build_s : 0},
                         {"bytes_per_triangle", double(b.tree_bytes) / primitives},
                         {"peak_bytes_per_triangle", double(b.peak_bytes) / primitives},
                         {"rays", ordered_json::array()}};
    for (const RayRate& rate : b.rates)
        json["rays"].push_back({{"kind", rate.kind},
                                {"rays", rate.rays},
                                {"mrays_s", rate.million_rays_per_s},
                                {"nodes_per_ray", rate.nodes_per_ray},
                                {"triangles_per_ray", rate.primitives_per_ray}});
    return json;
}

void print_text(const ordered_json& json)
{
    fmt::print("{}, {} thread{}\n", std::string(json["isa"]), int(json["threads"]), json["threads"] == 1 ? "" : "s");
    fmt::print("tree: {} triangles, built ({}) in {:.3f} s, {:.2f} million triangles/s on all cores\n",
               std::size_t(json["triangles"]), std::string(json["build"]), double(json["build_s"]),
               double(json["build_mtris_s"]));
    fmt::print("memory: {:.1f} bytes a triangle, {:.1f} while building\n\n", double(json["bytes_per_triangle"]),
               double(json["peak_bytes_per_triangle"]));
    fmt::print("{:<10} {:>9} {:>9} {:>10} {:>14}\n", "kind", "rays", "Mrays/s", "nodes/ray", "triangles/ray");
    for (const auto& rate : json["rays"])
        fmt::print("{:<10} {:>9} {:>9.3f} {:>10.2f} {:>14.2f}\n", std::string(rate["kind"]), std::size_t(rate["rays"]),
                   double(rate["mrays_s"]), double(rate["nodes_per_ray"]), double(rate["triangles_per_ray"]));
}

int run_bench_rays(BenchOptions o)
{
    if (o.rays.threads == 0) o.rays.threads = int(std::max(1u, std::thread::hardware_concurrency()));
    Reporter reporter(default_report_mode());
    Warnings warnings;
    LoadedScene loaded = load_for_render(o.scene, warnings);
    o.rays.width = loaded.size.width;
    o.rays.height = loaded.size.height;
    const Scene scene = Scene::compile(loaded.description, loaded.camera, warnings, loaded.build);
    reporter.warnings(warnings);
    loaded.description = {};
    const ordered_json json = describe(o, loaded.build, benchmark_rays(scene, o.rays));
    if (o.json)
        fmt::print("{}\n", json.dump(2, ' ', false, nlohmann::json::error_handler_t::replace));
    else
        print_text(json);
    return exit_ok;
}

}  // namespace

void add_bench(CLI::App& program, Run& run)
{
    Command bench(program, "bench", "Measure how fast this machine is");
    bench.set_footer("Example:\n  fathom bench rays scene.json\n\nExit codes: 0 done; 1 error; 2 wrong usage.");
    const auto options = std::make_shared<BenchOptions>();
    Command command(bench, "rays", "Rays per second through a scene's tree, kind by kind");
    add_scene_options(command, options->scene);
    command.add_value(
        "--rays", "N", "about so many camera rays, at most one a pixel (default: 262144)",
        [o = options.get()](const std::string& text) { o->rays.rays = parse_integer(text, 1, 1u << 30); });
    command.add_value(
        "--runs", "N", "cast them so many times; the median counts (default: 5)",
        [o = options.get()](const std::string& text) { o->rays.runs = int(parse_integer(text, 1, 1000)); });
    command.add_value(
        "--threads", "N", "threads that cast rays (default: all cores)",
        [o = options.get()](const std::string& text) { o->rays.threads = int(parse_integer(text, 1, 4096)); });
    command.add_flag("--json", options->json, "as JSON");
    command.set_footer(
        "Kinds: primary (from the camera), shadow (towards a lamp above it), bounce-1 and bounce-3 (diffuse),\n"
        "occlusion (short, all around). Nodes have 16 children; a ray visits those whose box it meets. What is\n"
        "not a triangle counts as one.\n\n"
        "Examples:\n"
        "  fathom bench rays scene.json\n"
        "  fathom bench rays model.glb --threads 1 --build high --json\n\n"
        "Exit codes: 0 done; 1 error; 2 wrong usage.");
    command.set_run(run, [options] { return run_bench_rays(*options); });
}

}  // namespace fathom::cli
