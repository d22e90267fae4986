// SPDX-License-Identifier: Apache-2.0
// Time to read a scene file, and memory that reading takes beyond the scene; a first read warms the file cache.
//   files FILE [TIMES [THREADS]]
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "fathom/error.h"
#include "fathom/load.h"
#include "fathom/threads.h"

namespace fathom {

namespace {

/// Bytes of a line of /proc/self/status.
double status(const std::string& key)
{
    std::ifstream file("/proc/self/status");
    for (std::string word; file >> word;)
        if (word == key + ':') {
            double kilobytes = 0;
            file >> kilobytes;
            return 1024 * kilobytes;
        }
    return 0;
}

double size_of(const SceneDescription& scene)
{
    const auto bytes = [](const auto& values) { return double(values.size() * sizeof(values[0])); };
    double sum = 0;
    for (const Mesh& m : scene.meshes)
        sum += bytes(m.positions) + bytes(m.normals) + bytes(m.uvs[0]) + bytes(m.uvs[1]) + bytes(m.tangents) +
               bytes(m.colors) + bytes(m.indices);
    for (const Points& p : scene.points) sum += bytes(p.centers) + bytes(p.radii);
    return sum;
}

/// Wall clock time, and processor time, which other load affects less.
struct Seconds {
    double clock = 0, processors = 0;
};

Seconds seconds_to_load(const std::filesystem::path& file, SceneDescription& scene)
{
    const auto start = std::chrono::steady_clock::now();
    const std::clock_t before = std::clock();
    Warnings warnings;
    scene = load_scene(file, {}, warnings);
    return {std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count(),
            double(std::clock() - before) / CLOCKS_PER_SEC};
}

double median(const std::vector<Seconds>& runs, double Seconds::* which)
{
    std::vector<double> values;
    for (const Seconds& run : runs) values.push_back(run.*which);
    std::sort(values.begin(), values.end());
    return values[values.size() / 2];
}

int run(const std::filesystem::path& file, int times, int threads)
{
    const ThreadLimit limit(threads);
    const double file_bytes = double(std::filesystem::file_size(file)), before = status("VmRSS");
    SceneDescription scene;
    std::vector<Seconds> seconds{seconds_to_load(file, scene)};
    const double scene_bytes = size_of(scene), beyond = status("VmHWM") - before - scene_bytes;
    for (int i = 1; i < times; ++i) {
        scene = {};
        seconds.push_back(seconds_to_load(file, scene));
    }
    const double clock = median(seconds, &Seconds::clock), processors = median(seconds, &Seconds::processors);
    fmt::print(
        "{}: {:.1f} MB, {} threads: {:.1f} ms, {:.0f} MB/s; {:.1f} ms of processors, {:.0f} MB/s; scene {:.1f} MB, "
        "beyond it {:.1f} "
        "MB ({:.0f} % of the file)\n",
        file.filename().string(), file_bytes / 1e6, limit.threads(), 1e3 * clock, file_bytes / clock / 1e6,
        1e3 * processors, file_bytes / processors / 1e6, scene_bytes / 1e6, beyond / 1e6, 100 * beyond / file_bytes);
    return 0;
}

}  // namespace

}  // namespace fathom

int main(int argc, char** argv)
{
    if (argc < 2) return fmt::print("usage: {} FILE [TIMES [THREADS]]\n", argv[0]), 2;
    try {
        return fathom::run(argv[1], argc > 2 ? std::atoi(argv[2]) : 7, argc > 3 ? std::atoi(argv[3]) : 0);
    } catch (const fathom::Error& error) {
        fmt::print("{}\n", error.what());
        return 1;
    }
}
