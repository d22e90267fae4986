/// Million rays per second through a mesh that stands still, and through the same mesh while it moves by 5 % of its size: each
/// vertex along its own line, or all of it as an instance that is shifted and turned by 3 degrees. The same rays for all,
/// in turns in one process.
///
///     build/test/bin/moving-x86-64-v4 --generate terrain-1 --generate foliage-1
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <stdexcept>

#include "math/lanes.h"
#include "ray_sets.h"

namespace fathom::bench {
namespace {

struct Size {
    double diagonal = 0;
    Vec3f center;
};

Size size_of(const SceneTables& tables)
{
    Vec3f low = tables.positions[0], high = low;
    for (const Vec3f& p : tables.positions) {
        low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
        high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
    }
    const double x = high.x - low.x, y = high.y - low.y, z = high.z - low.z;
    return {std::sqrt(x * x + y * y + z * z), {(low.x + high.x) / 2, (low.y + high.y) / 2, (low.z + high.z) / 2}};
}

SceneTables with_moving_vertices(SceneTables tables)
{
    const Size size = size_of(tables);
    const std::size_t n = tables.positions.size();
    const float way = float(0.05 * size.diagonal), wave = float(20 / size.diagonal);
    for (std::size_t i = 0; i < n; ++i) {
        const Vec3f p = tables.positions[i];
        const float a = p.x * wave, b = p.y * wave + p.z * wave;
        tables.positions.push_back({p.x + way * std::cos(a) * std::cos(b), p.y + way * std::sin(a) * std::cos(b),
                                    p.z + way * std::sin(b)});
    }
    tables.shapes[0].moving_vertices = std::uint32_t(n);
    tables.vertex_times = {0, 1};
    tables.shutter_close = 1;
    return tables;
}

SceneTables placed(SceneTables tables, bool moving)
{
    const Size size = size_of(tables);
    tables.shapes[0].flags |= ShapeTable::placed;
    tables.world_triangles = 0;
    InstanceTable instance;
    instance.object_from_render = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};
    if (moving) {
        const double half = 3 * 3.14159265358979 / 360;
        PoseTable from, to;
        from.rotation[3] = 1;
        for (int i : {0, 3, 5}) from.stretch[i] = to.stretch[i] = 1;
        to.time = 1;
        to.translation[0] = to.translation[2] = float(0.05 * size.diagonal / std::sqrt(2.0));
        to.rotation[1] = float(std::sin(half)), to.rotation[3] = float(std::cos(half));
        from.turns = float(half / 6.28318530717958);
        from.inverse_sine = float(1 / std::sin(half));
        tables.poses = {from, to};
        instance.poses = 2;
        tables.shutter_close = 1;
    }
    tables.instances = {instance};
    return tables;
}

double median(std::vector<double> x)
{
    std::sort(x.begin(), x.end());
    return x[x.size() / 2];
}

struct Case {
    const char* name;
    SceneTables tables;
    Bvh bvh;
};

void measure(const Mesh& mesh, std::size_t parts, int runs)
{
    std::vector<std::unique_ptr<Case>> cases;
    const auto add = [&](const char* name, SceneTables tables) {
        cases.push_back(std::make_unique<Case>(Case{name, std::move(tables), {}}));
        cases.back()->bvh.build(cases.back()->tables);
    };
    add("still", mesh.tables);
    add("moving vertices", with_moving_vertices(mesh.tables));
    add("placed, still", placed(mesh.tables, false));
    add("placed, moving", placed(mesh.tables, true));
    for (const RaySet& set : make_ray_sets(mesh, cases[0]->bvh, parts)) {
        std::vector<float> times(set.t_max.size()), t(times.size()), u(times.size()), v(times.size());
        std::vector<std::uint32_t> primitive(times.size()), instance(times.size()), blocked(times.size());
        std::uint32_t x = 1;
        for (float& time : times) time = float((x = x * 747796405u + 2891336453u) >> 8) * 0x1p-24f;
        std::vector<std::vector<double>> rates(cases.size());
        for (int i = 0; i < runs; ++i)
            for (std::size_t c = 0; c < cases.size(); ++c) {
                const double start = now(1);
                for (std::size_t first = 0; first < set.count(); first += 1024) {
                    RayArrays rays = set.arrays(first, std::min<std::size_t>(1024, set.count() - first));
                    rays.time = &times[first];
                    if (set.shadow)
                        cases[c]->bvh.occluded(rays, &blocked[first], set.coherent);
                    else
                        cases[c]->bvh.closest(rays, {&t[first], &u[first], &v[first], &primitive[first], &instance[first]},
                                              set.coherent);
                }
                rates[c].push_back(double(set.count()) * 1e-6 / (now(1) - start));
            }
        for (std::size_t c = 0; c < cases.size(); ++c) {
            std::vector<double> ratio;
            for (int i = 0; i < runs; ++i) ratio.push_back(rates[c][std::size_t(i)] / rates[0][std::size_t(i)]);
            std::printf("{\"mesh\": \"%s\", \"kind\": \"%s\", \"isa\": \"%s\", \"case\": \"%s\", \"mrays_s\": %.3f, "
                        "\"times_still\": %.3f, \"bytes\": %zu}\n",
                        mesh.name.c_str(), set.kind.c_str(), lanes_name, cases[c]->name, median(rates[c]), median(ratio),
                        cases[c]->bvh.statistics().bytes);
        }
        std::fflush(stdout);
    }
}

int run_all(int argc, char** argv)
{
    std::size_t parts = 16;
    int runs = 5;
    std::vector<std::pair<std::string, bool>> meshes;
    for (int i = 1; i + 1 < argc; i += 2) {
        const std::string arg = argv[i], value = argv[i + 1];
        if (arg == "--mesh" || arg == "--generate")
            meshes.emplace_back(value, arg == "--generate");
        else if (arg == "--parts")
            parts = std::stoul(value);
        else if (arg == "--runs")
            runs = std::stoi(value);
        else
            throw std::runtime_error(arg + ": known are --mesh FILE.ply, --generate NAME, --parts N, --runs N");
    }
    for (const auto& [name, generated] : meshes) measure(generated ? generate(name) : read_ply(name), parts, runs);
    return 0;
}

}  // namespace
}  // namespace fathom::bench

int main(int argc, char** argv)
{
    try {
        return fathom::bench::run_all(argc, argv);
    } catch (const std::exception& e) {
        std::fprintf(stderr, "moving: %s\n", e.what());
        return 2;
    }
}
