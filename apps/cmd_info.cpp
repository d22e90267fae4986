#include <fmt/format.h>
#include <memory>
#include <nlohmann/json.hpp>

#include "arguments.h"
#include "commands.h"
#include "fathom/error.h"
#include "film_info.h"
#include "scene_options.h"
#include "streams.h"

namespace fathom::cli {

namespace {

using nlohmann::ordered_json;

struct InfoOptions {
    SceneOptions scene;
    bool json = false;
};

const char* name_of(LightKind kind)
{
    switch (kind) {
        case LightKind::point:
            return "point";
        case LightKind::spot:
            return "spot";
        case LightKind::directional:
            return "directional";
    }
    return "";
}

const char* name_of(EnvironmentKind kind)
{
    switch (kind) {
        case EnvironmentKind::none:
            return "none";
        case EnvironmentKind::constant:
            return "constant";
        case EnvironmentKind::gradient:
            return "gradient";
        case EnvironmentKind::image:
            return "image";
        case EnvironmentKind::studio:
            return "studio";
        case EnvironmentKind::sky:
            return "sky";
        case EnvironmentKind::cube:
            return "cube";
        case EnvironmentKind::equal_area:
            return "equal-area";
    }
    return "";
}

bool emits(const Material& material)
{
    const Color& c = material.emission.value;
    return c.r > 0 || c.g > 0 || c.b > 0;
}

ordered_json count(const SceneDescription& scene)
{
    std::size_t triangles = 0, vertices = 0, emitters = 0;
    for (const Mesh& mesh : scene.meshes) triangles += mesh.indices.size() / 3, vertices += mesh.positions.size();
    std::size_t shapes[std::variant_size_v<decltype(Shape::geometry)>] = {};
    for (const Node& node : scene.nodes)
        for (const Shape& shape : node.shapes) {
            ++shapes[shape.geometry.index()];
            emitters += shape.material >= 0 && shape.material < int(scene.materials.size()) &&
                        emits(scene.materials[shape.material]);
        }
    return {{"triangles", triangles},
            {"vertices", vertices},
            {"meshes", scene.meshes.size()},
            {"nodes", scene.nodes.size()},
            {"mesh instances", shapes[0]},
            {"spheres", shapes[1]},
            {"rectangles", shapes[2]},
            {"boxes", shapes[3]},
            {"disks", shapes[4]},
            {"materials", scene.materials.size()},
            {"textures", scene.textures.size()},
            {"images", scene.images.size()},
            {"lights", scene.lights.size()},
            {"emitting shapes", emitters},
            {"cameras", scene.cameras.size()}};
}

ordered_json vector_json(Vec3d v)
{
    return {v.x, v.y, v.z};
}

ordered_json describe(const InfoOptions& o)
{
    Warnings warnings;
    SceneFile file = load_scene_file(o.scene.file, load_options(o.scene), warnings);
    SceneDescription& scene = file.scene;
    ordered_json info;
    info["file"] = o.scene.file.string();
    info["load_s"] = seconds_since_start();
    info["counts"] = count(scene);
    const Bounds bounds = world_bounds(scene);
    if (!bounds.empty) info["bounds"] = {{"min", vector_json(bounds.min)}, {"max", vector_json(bounds.max)}};
    info["cameras"] = ordered_json::array();
    for (const Camera& camera : scene.cameras)
        info["cameras"].push_back(
            {{"name", camera.name}, {"kind", camera.kind == CameraKind::perspective ? "perspective" : "orthographic"}});
    info["lights"] = ordered_json::array();
    for (const Light& light : scene.lights)
        info["lights"].push_back({{"name", light.name}, {"kind", name_of(light.kind)}});
    info["environment"] = name_of(scene.environment.kind);
    info["scenes"] = file.scenes;
    info["variants"] = file.variants;
    info["animations"] = ordered_json::array();
    for (const Animation& animation : file.rig.animations)
        info["animations"].push_back(
            {{"name", animation.name}, {"duration_s", animation.duration()}, {"channels", animation.channels.size()}});

    // What only shows when a scene is made ready: missing textures, degenerate triangles, memory.
    info["added"] = complete_scene(scene, {}).added;
    try {
        const SceneStatistics statistics = Scene::compile(scene, "", warnings).statistics();
        info["compiled"] = {{"triangles", statistics.triangles},       {"primitives", statistics.primitives},
                            {"instances", statistics.instances},       {"lights", statistics.lights},
                            {"memory_bytes", statistics.memory_bytes}, {"build_s", statistics.build_s}};
    } catch (const Error& error) {
        info["not renderable"] = error.what();
    }
    info["warnings"] = ordered_json::array();
    for (const auto& [message, times] : warnings.counts())
        info["warnings"].push_back({{"message", message}, {"count", times}});
    return info;
}

/// With numbers, by which they can be chosen, where there are several.
std::string join(const ordered_json& values, const char* key)
{
    std::vector<std::string> texts;
    for (const auto& value : values) {
        const std::string name = value["name"];
        const std::string number = values.size() > 1 ? fmt::format("{}: ", texts.size()) : "";
        texts.push_back(fmt::format("{}{} ({})", number, name.empty() ? "unnamed" : name, std::string(value[key])));
    }
    return texts.empty() ? "none" : fmt::format("{}", fmt::join(texts, ", "));
}

void print_text(const ordered_json& info)
{
    const auto line = [](const std::string& name, const std::string& value) {
        print(fmt::format("{:<16} {}\n", name, value));
    };
    line("file", info["file"]);
    // Cameras and lights are told by name below.
    for (const auto& [name, value] : info["counts"].items())
        if (value != 0 && name != "cameras" && name != "lights") line(name, fmt::format("{}", std::uint64_t(value)));
    if (info.contains("bounds")) {
        const auto corner = [&](const char* which) {
            const auto& v = info["bounds"][which];
            return fmt::format("{:.6g}, {:.6g}, {:.6g}", double(v[0]), double(v[1]), double(v[2]));
        };
        line("bounds", fmt::format("({}) to ({})", corner("min"), corner("max")));
    } else {
        line("bounds", "empty");
    }
    line("cameras", join(info["cameras"], "kind"));
    line("lights", join(info["lights"], "kind"));
    for (const char* choice : {"scenes", "variants"}) {
        const std::vector<std::string> names = info[choice];
        // One scene is no choice.
        if (names.size() > (choice == std::string("scenes") ? 1u : 0u))
            line(choice, fmt::format("{}", fmt::join(names, ", ")));
    }
    const auto& animations = info["animations"];
    for (std::size_t i = 0; i < animations.size(); ++i)
        line(i == 0 ? "animations" : "",
             fmt::format("{}: {} ({:.3g} s; --at SECONDS, --frames A:B)", i, std::string(animations[i]["name"]),
                         double(animations[i]["duration_s"])));
    line("environment", info["environment"]);
    for (const auto& added : info["added"]) line("added to render", added);
    if (info.contains("compiled")) {
        const auto& c = info["compiled"];
        line("memory", fmt::format("{:.1f} MB compiled, built in {:.3f} s", double(c["memory_bytes"]) / 1e6,
                                   double(c["build_s"])));
    } else {
        line("not renderable", info["not renderable"]);
    }
    for (const auto& w : info["warnings"])
        line("warning", fmt::format("{}{}", std::string(w["message"]),
                                    w["count"] > 1 ? fmt::format(" ({} times)", std::uint64_t(w["count"])) : ""));
}

}  // namespace

void add_info(CLI::App& program, Run& run)
{
    const auto options = std::make_shared<InfoOptions>();
    Command command(program, "info", "Tell what is in a scene, model or film file");
    add_file_options(command, options->scene);
    command.add_flag("--json", options->json, "as JSON");
    command.set_footer(
        "Counts, bounds, memory, cameras, lights, and what was not understood. Of a film file: its samples and what "
        "is\n"
        "missing of them, seed, settings, layers, noise; all of it is read, so damage shows.\n\n"
        "Examples:\n  fathom info model.glb\n  fathom info scene.json --json\n  fathom info film.exr\n\n"
        "Exit codes: 0 done; 1 error; 2 wrong usage.");
    command.set_run(run, [options] {
        const bool is_film = is_film_file(options->scene.file);
        const ordered_json info = is_film ? describe_film(options->scene.file) : describe(*options);
        if (options->json)
            print(info.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + '\n');
        else if (is_film)
            print_film_text(info);
        else
            print_text(info);
        return int(exit_ok);
    });
}

}  // namespace fathom::cli
