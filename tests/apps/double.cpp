// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <sys/prctl.h>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <csignal>
#include <fstream>
#include <thread>

#include "fathom/error.h"
#include "fathom/ground_truth.h"
#include "fathom/lighting.h"
#include "fathom/load.h"
#include "fathom/memory.h"
#include "fathom/profile.h"
#include "fathom/render.h"
#include "fathom/scene_file.h"
#include "film/film_data.h"

// A test double of the library, for tests of the command line. A scene file is a list of words, and the value of a
// sample depends on its index only:
// camera NAME, aspect A, size WxH, spp N, slow MS (a pass), warn TEXT, nan, hint-filter NAME, hint-build NAME,
// triangles N, texture NAME, file NAME, scene NAME, variant NAME, moves NAME (the last node), empty,
// gate FILE and load-gate FILE: each sample, or loading, waits until the file holds a number larger than its own
// (loading has 0); meanwhile FILE.waits holds that number. So a test controls how far the program gets, however slow
// the machine is.
namespace fathom {

namespace {

int slow_ms = 0;
std::uint64_t dropped_per_render = 0;
std::filesystem::path pass_gate;

void wait_at(const std::filesystem::path& gate, std::uint64_t step)
{
    const auto is_open = [&] {
        std::uint64_t allowed = 0;
        std::ifstream(gate) >> allowed;
        return allowed > step;
    };
    if (is_open()) return;
    // A killed test can't open the gate, so this process is killed with it.
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    const std::string waits = gate.string() + ".waits", part = waits + ".part";
    std::ofstream(part) << step << std::flush;
    std::filesystem::rename(part, waits);
    while (!is_open()) std::this_thread::sleep_for(std::chrono::milliseconds(2));
}

}  // namespace

SceneFileContents load_scene_file(const std::filesystem::path& file, const LoadOptions& options, Warnings& warnings)
{
    std::ifstream in(file);
    if (!in || std::filesystem::is_directory(file)) throw Error(file.string(), "", "there is no such file");
    SceneFileContents result;
    SceneDescription& scene = result.scene;
    scene.file = file.string();
    std::string word;
    while (in >> word) {
        if (word == "camera") {
            scene.cameras.emplace_back();
            in >> scene.cameras.back().name;
            scene.nodes.emplace_back().camera = int(scene.cameras.size()) - 1;
            scene.nodes.back().parent_from_node = Transform::translate({1, 2, 3});
            scene.roots.push_back(int(scene.nodes.size()) - 1);
        } else if (word == "aspect") {
            in >> scene.cameras.back().aspect;
        } else if (word == "size") {
            in >> scene.hints.width.emplace() >> scene.hints.height.emplace();
        } else if (word == "spp") {
            in >> scene.hints.samples.emplace();
        } else if (word == "slow") {
            in >> slow_ms;
        } else if (word == "warn") {
            in >> word;
            warnings.add(word), warnings.add(word);
        } else if (word == "nan") {
            dropped_per_render = 3;
        } else if (word == "hint-filter") {
            in >> scene.hints.filter.emplace();
        } else if (word == "texture") {
            in >> word;
            scene.images.push_back({word, file.parent_path() / word, {}});
        } else if (word == "file") {
            in >> word;
            scene.files.push_back(file.parent_path() / word);
        } else if (word == "gate") {
            in >> pass_gate;
        } else if (word == "load-gate") {
            std::filesystem::path gate;
            in >> gate;
            wait_at(gate, 0);
        } else if (word == "triangles") {
            std::size_t triangles = 0;
            in >> triangles;
            scene.meshes.emplace_back().indices.resize(3 * triangles);
        } else if (word == "hint-build") {
            in >> scene.hints.build.emplace();
        } else if (word == "scene") {
            in >> result.scenes.emplace_back();
        } else if (word == "moves") {
            // The last node moves one meter per second along x for two seconds.
            Animation& animation = result.rig.animations.emplace_back();
            in >> animation.name;
            animation.channels.push_back({AnimatedProperty::translation,
                                          int(scene.nodes.size()) - 1,
                                          Interpolation::linear,
                                          {0, 2},
                                          {0, 0, 0, 2, 0, 0}});
            result.rig.nodes.resize(scene.nodes.size());
            result.rig.parents.assign(scene.nodes.size(), -1);
        } else if (word == "variant") {
            in >> result.variants.emplace_back();
        } else if (word != "empty") {
            throw Error(file.string(), "line 1", fmt::format("unknown word '{}'", word));
        }
    }
    if (!options.scene.empty()) warnings.add(fmt::format("scene {}", options.scene));
    if (!options.variant.empty()) warnings.add(fmt::format("variant {}", options.variant));
    if (options.up_axis) warnings.add(fmt::format("up axis {}", options.up_axis));
    return result;
}

SceneDescription load_scene(const std::filesystem::path& file, const LoadOptions& options, Warnings& warnings)
{
    return load_scene_file(file, options, warnings).scene;
}

bool add_default_camera(SceneDescription& scene, const FramingOptions& options)
{
    if (!scene.cameras.empty() && !options.force_camera) return false;
    // The camera is inserted before the others, as in the library.
    for (Node& node : scene.nodes)
        if (node.camera >= 0) ++node.camera;
    scene.cameras.insert(scene.cameras.begin(), Camera())->position = {options.azimuth_deg, options.elevation_deg, 100};
    scene.nodes.emplace_back().camera = 0;
    scene.roots.push_back(int(scene.nodes.size()) - 1);
    return true;
}

std::size_t find_animation(const SceneFileContents& file, const std::string& wanted)
{
    for (std::size_t i = 0; i < file.rig.animations.size(); ++i)
        if (wanted.empty() || file.rig.animations[i].name == wanted) return i;
    throw Error(file.scene.file, "", fmt::format("there is no animation '{}'", wanted));
}

/// Estimates 300 MB for each texture.
std::vector<MemoryEstimate> estimate_memory(const SceneDescription& scene, BvhQuality)
{
    return {{"textures", 3e8 * double(scene.images.size())}, {"triangles", 1000}};
}

struct Scene::Data {
    CompileStatistics statistics;
    Camera camera;
};

Scene Scene::compile(const SceneDescription& description, const std::string& camera, Warnings& warnings,
                     BvhQuality build)
{
    const char* const builds[] = {"fast", "standard", "high", "compact"};  // indexed by BvhQuality
    if (build != BvhQuality::standard) warnings.add(fmt::format("build {}", builds[std::size_t(build)]));
    auto data = std::make_shared<Data>();
    data->camera = world_camera(description, camera);
    const Camera& c = data->camera;
    // Warnings show the camera and the environment to the tests.
    warnings.add(fmt::format("camera '{}' at {},{},{} to {},{},{} up {},{},{} fov {:.4g} aspect {}", c.name,
                             c.position.x, c.position.y, c.position.z, c.look_at.x, c.look_at.y, c.look_at.z, c.up.x,
                             c.up.y, c.up.z, c.fov_y * 180 / M_PI, c.aspect));
    if (c.shutter_close > c.shutter_open)
        warnings.add(fmt::format("shutter from {:g} to {:g}", c.shutter_open, c.shutter_close));
    if (const Environment& e = description.environment; e.kind == EnvironmentKind::image) {
        const Vec3d middle = e.world_from_environment.vector({1, 0, 0});
        warnings.add(fmt::format("environment {} towards {:.3f},{:.3f},{:.3f} times {:g}",
                                 description.images.at(std::size_t(e.image)).path.string(), middle.x, middle.y,
                                 middle.z, e.color.g));
    }
    if (const Environment& e = description.environment; e.kind == EnvironmentKind::sky)
        warnings.add(fmt::format("sky {} sun at {:.3f},{:.3f},{:.3f}", e.sun_disk ? "and" : "without", e.to_sun.x,
                                 e.to_sun.y, e.to_sun.z));
    Scene scene;
    scene.data_ = std::move(data);
    return scene;
}

struct EditableScene::Data {
    SceneDescription scene;
    std::string camera;
    BvhQuality build;
};
EditableScene::EditableScene(SceneDescription scene, std::string camera, BvhQuality build)
    : data_(std::make_unique<Data>(Data{std::move(scene), std::move(camera), build}))
{
}
EditableScene::EditableScene(EditableScene&&) noexcept = default;
EditableScene& EditableScene::operator=(EditableScene&&) noexcept = default;
EditableScene::~EditableScene() = default;
const SceneDescription& EditableScene::description() const
{
    return data_->scene;
}
void EditableScene::set_pose(AnimationPose pose)
{
    fathom::set_pose(data_->scene, std::move(pose));
}
void EditableScene::set_camera(int camera, const Camera& camera_now)
{
    data_->scene.cameras.at(std::size_t(camera)) = camera_now;
}
void EditableScene::set_material(int, const Material&) {}
SceneDescription& EditableScene::edit_description()
{
    return data_->scene;
}
Scene EditableScene::compile(Warnings& warnings)
{
    return compile_bit_exact(warnings);
}
Scene EditableScene::compile_bit_exact(Warnings& warnings)
{
    return Scene::compile(data_->scene, data_->camera, warnings, data_->build);
}

/// A scene named `dark` gets a studio and an exposure.
LitScene compile_lit(EditableScene& edit, LightingMode light, double aspect, Warnings& warnings,
                     const std::optional<Ground>& ground)
{
    const SceneDescription& scene = edit.description();
    const char* const choices[] = {"auto", "file", "studio"};  // indexed by LightingMode
    warnings.add(
        fmt::format("light {}{} aspect {:.4g}", choices[int(light)], scene.hints.own_light ? ", its own" : "", aspect));
    if (ground)
        warnings.add(fmt::format("ground {}of {:g}", ground->only_if_visible_from_above ? "where it fits " : "",
                                 ground->color.value_or(ground->backdrop).g));
    LitScene lit;
    lit.scene = edit.compile_bit_exact(warnings);
    if (scene.file.find("dark") == std::string::npos) return lit;
    lit.added = {"a lamp", "an exposure"};
    lit.exposure_ev = 2;
    return lit;
}

const CompileStatistics& Scene::statistics() const
{
    return data_->statistics;
}
const Camera& Scene::camera() const
{
    return data_->camera;
}

struct RenderJob::Data {
    Scene scene;
    Camera camera;
    FilmKey key;
};
RenderJob::RenderJob(const Scene& scene, const RenderSettings& settings) : RenderJob(scene, scene.camera(), settings) {}
RenderJob::RenderJob(const Scene& scene, const Camera& camera, const RenderSettings& settings)
    : data_(std::make_shared<const Data>(Data{scene, camera, {settings, std::string(32, '0')}}))
{
}
const Scene& RenderJob::scene() const
{
    static const Scene none;
    return none;
}
const Camera& RenderJob::camera() const
{
    static const Camera none;
    return none;
}
const FilmKey& RenderJob::key() const
{
    return data_->key;
}

Film::Film(const RenderJob& job) : Film(job.key()) {}

bool render(const RenderJob& job, SampleRange range, Film& film, const std::atomic<bool>* cancel,
            const std::function<void(const Progress&, const Film&)>& on_pass)
{
    Film::Data& data = film.data();
    const std::uint64_t pixels = std::uint64_t(film.width()) * std::uint64_t(film.height());
    for (std::uint64_t s = range.first; s < range.second; ++s) {
        if (cancel && *cancel) return false;
        std::this_thread::sleep_for(std::chrono::milliseconds(slow_ms));
        if (!pass_gate.empty()) wait_at(pass_gate, s);
        for (std::size_t i = 0; i < pixels; ++i) {
            const double value = double(s * 7 % 16) / 16;
            for (int c = 0; c < 3; ++c) {
                ExactSum::add_number(radiance_sum(data.pixel(i), c), value);
                ExactSquareSum::add_number(square_sum(data.pixel(i), c), value * value);
            }
            if (data.layout.alpha >= 0) ExactSum::add_number(other_sum(data.pixel(i), data.layout.alpha), 1);
        }
        data.add_range({s, s + 1});
        Progress progress{(s - range.first + 1) * pixels, (range.second - range.first) * pixels, {}};
        progress.costs.rays = {progress.samples_done, progress.samples_done * 3, progress.samples_done};
        progress.costs.clear_shadow_rays = progress.samples_done / 2;
        progress.costs.vertices = 2'000'000, progress.costs.shaded_lanes = 2'500'000;
        progress.costs.light_samples = 500'000;
        if (job.settings().measure_stages) {
            progress.costs.seconds[std::size_t(RenderStage::trace)] = 0.75;
            progress.costs.seconds[std::size_t(RenderStage::light)] = 0.25;
        }
        if (on_pass) on_pass(progress, film);
    }
    data.dropped = dropped_per_render;
    if (data.dropped > 0) data.invalid_sample = Film::SampleLocation{7, 8, 9};
    return true;
}
std::optional<LightTracingTrial> try_light_tracing(const RenderJob&, const std::atomic<bool>*, TrialEffort)
{
    return LightTracingTrial{};
}
double light_of_photons(const RenderJob&, const std::atomic<bool>*)
{
    return 0;
}

std::optional<RenderProfile> profile_render(const RenderJob& job, const std::vector<SceneObject>&, int set_samples,
                                            const std::atomic<bool>* cancel)
{
    if (!pass_gate.empty()) wait_at(pass_gate, 1);
    if (cancel && *cancel) return {};
    RenderProfile profile;
    profile.width = job.settings().width, profile.height = job.settings().height;
    profile.samples_per_pixel = profile_sets * set_samples;
    const auto pixels = std::size_t(profile.width) * std::size_t(profile.height);
    profile.image.resize(3 * pixels), profile.pixel_error.resize(pixels), profile.pixel_seconds.resize(pixels);
    return profile;
}

PinholeCamera pinhole_camera(const RenderJob&)
{
    return {};
}
GroundTruth trace_ground_truth(const RenderJob& job, const std::vector<SceneObject>&)
{
    GroundTruth truth;
    truth.width = job.settings().width, truth.height = job.settings().height;
    truth.depth.resize(std::size_t(truth.width) * std::size_t(truth.height));
    return truth;
}
std::vector<ObjectMask> trace_masks(const RenderJob&, const std::vector<SceneObject>&)
{
    return {};
}
std::vector<Vec2f> optical_flow(const GroundTruth&, const RenderJob&, const RenderJob&)
{
    return {};
}

Color render_sample(const RenderJob&, int x, int y, std::uint64_t sample)
{
    return {float(x), float(y), float(sample)};
}
int simd_width()
{
    return 1;
}
const char* simd_name()
{
    return "none";
}
KernelChoice kernel_choice()
{
    return {"none", "a test double", ""};
}

}  // namespace fathom
