// SPDX-License-Identifier: Apache-2.0
#include "report/scene_info.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <numbers>
#include <set>

#include "fathom/error.h"
#include "fathom/image.h"
#include "fathom/scene_file.h"

namespace fathom::cli {

namespace {

using nlohmann::ordered_json;

const char* name_of(EnvironmentKind kind)
{
    constexpr const char* names[] = {"none", "constant", "gradient",   "image",       "studio",
                                     "sky",  "cube",     "equal-area", "hosek-wilkie"};
    return names[int(kind)];
}

ordered_json to_json(Vec3d v)
{
    return {v.x, v.y, v.z};
}
ordered_json to_json(const Color& c)
{
    return {c.r, c.g, c.b};
}

bool is_nonzero(const ColorInput& input)
{
    return input.value.r > 0 || input.value.g > 0 || input.value.b > 0;
}
bool is_nonzero(const FloatInput& input)
{
    return input.value > 0;
}

const Material* material_of(const SceneDescription& scene, const Shape& shape)
{
    const bool has = shape.material >= 0 && std::size_t(shape.material) < scene.materials.size();
    return has ? &scene.materials[std::size_t(shape.material)] : nullptr;
}

ordered_json count_json(const SceneDescription& scene)
{
    std::size_t triangles = 0, vertices = 0, emitters = 0, curves = 0, points = 0;
    for (const Mesh& mesh : scene.meshes) triangles += mesh.indices.size() / 3, vertices += mesh.positions.size();
    for (const Curves& c : scene.curves) curves += c.counts.size();
    for (const Points& p : scene.points) points += p.centers.size();
    std::size_t shapes[std::variant_size_v<decltype(Shape::geometry)>] = {};
    for (const Node& node : scene.nodes)
        for (const Shape& shape : node.shapes) {
            ++shapes[shape.geometry.index()];
            const Material* const material = material_of(scene, shape);
            emitters += material && is_nonzero(material->emission.radiance);
        }
    return {{"triangles", triangles},
            {"vertices", vertices},
            {"meshes", scene.meshes.size()},
            {"curves", curves},
            {"points", points},
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

/// Features of a material beside its kind.
std::vector<std::string> material_features(const Material& m)
{
    std::vector<std::string> uses;
    const auto add = [&](bool is_used, const char* what) {
        if (is_used) uses.emplace_back(what);
    };
    const bool has_layers = m.kind == MaterialKind::principled;
    add(is_nonzero(m.emission.radiance), "emission");
    add(m.base_color.texture >= 0, "color texture");
    add(m.use_vertex_color, "vertex colors");
    if (has_layers || m.kind == MaterialKind::glass) {
        add(m.interior.attenuation_distance > 0, "absorption");
        add(m.interior.scatter.r > 0 || m.interior.scatter.g > 0 || m.interior.scatter.b > 0, "scattering inside");
        add(m.interior.thin, "thin");
    }
    if (has_layers) {
        add(is_nonzero(m.metallic), "metallic");
        add(is_nonzero(m.transmission.weight), "transmission");
        add(m.transmission.dispersion > 0, "dispersion");
        add(is_nonzero(m.diffuse_transmission.weight), "diffuse transmission");
        add(is_nonzero(m.subsurface.weight), "subsurface");
        add(is_nonzero(m.microfacets.anisotropy), "anisotropy");
        add(is_nonzero(m.coat.weight), "coat");
        add(is_nonzero(m.sheen.color), "sheen");
        add(is_nonzero(m.thin_film.weight), "thin film");
    }
    add(m.normal_map.texture >= 0, "normal map");
    add(m.bump.texture >= 0, "bumps");
    add(m.displacement.height.value != 0, "displacement");
    add(m.opacity.mode == AlphaMode::mask, "alpha mask");
    add(m.opacity.mode == AlphaMode::blend, "alpha");
    add(m.visibility.camera_backface_culling, "single-sided");
    add(m.visibility.hidden_from_camera, "hidden from the camera");
    add(m.visibility.invisible_light, "invisible light");
    return uses;
}

ordered_json materials_of(const SceneDescription& scene)
{
    std::vector<std::size_t> shapes(scene.materials.size(), 0);
    for (const Node& node : scene.nodes)
        for (const Shape& shape : node.shapes)
            if (const Material* const m = material_of(scene, shape)) ++shapes[std::size_t(m - scene.materials.data())];
    ordered_json result = ordered_json::array();
    for (std::size_t i = 0; i < scene.materials.size(); ++i) {
        const Material& m = scene.materials[i];
        result.push_back({{"name", m.name},
                          {"kind", material_kind_name(m.kind)},
                          {"shapes", shapes[i]},
                          {"uses", material_features(m)}});
        if (is_nonzero(m.emission.radiance)) result.back()["emission"] = to_json(m.emission.radiance.value);
    }
    return result;
}

/// Whether a file is an IES profile, which lights use like an image.
bool is_light_profile(const std::string& name)
{
    std::string extension = std::filesystem::path(name).extension().string();
    for (char& c : extension) c = char(std::tolower(static_cast<unsigned char>(c)));
    return extension == ".ies";
}

ordered_json images_of(const SceneDescription& scene)
{
    ordered_json result = ordered_json::array();
    for (const ImageFile& image : scene.images) {
        const bool is_inside = !image.bytes.empty();
        const auto size =
            is_inside ? image_size(image.name, image.bytes.data(), image.bytes.size()) : image_size(image.path);
        std::error_code error;
        const std::uintmax_t bytes = is_inside ? image.bytes.size() : std::filesystem::file_size(image.path, error);
        result.push_back({{"name", is_inside ? image.name : image.path.string()}, {"inside", is_inside}});
        if (!error) result.back()["bytes"] = bytes;
        if (size) result.back()["size"] = *size;
        if (error)
            result.back()["problem"] = "is missing";
        else if (!size && !is_light_profile(image.name))
            result.back()["problem"] = "is not a readable image";
    }
    return result;
}

ordered_json files_of(const SceneDescription& scene)
{
    ordered_json result = ordered_json::array();
    std::set<std::filesystem::path> seen;
    for (const std::filesystem::path& file : scene.files) {
        if (!seen.insert(file).second) continue;
        std::error_code error;
        const std::uintmax_t bytes = std::filesystem::file_size(file, error);
        result.push_back({{"file", file.string()}, {"bytes", error ? 0 : bytes}});
    }
    return result;
}

ordered_json cameras_of(const SceneDescription& scene)
{
    ordered_json result = ordered_json::array();
    for (const Camera& camera : scene.cameras) {
        constexpr const char* kinds[] = {"perspective", "orthographic", "spherical", "equal-area"};
        ordered_json c = {{"name", camera.name}, {"kind", kinds[int(camera.kind)]}};
        if (camera.kind == CameraKind::perspective) c["fov_y_deg"] = camera.fov_y * 180 / std::numbers::pi;
        if (camera.kind == CameraKind::orthographic) c["height"] = camera.height;
        if (camera.aspect > 0) c["aspect"] = camera.aspect;
        if (camera.shift_x != 0 || camera.shift_y != 0) c["shift"] = {camera.shift_x, camera.shift_y};
        if (camera.aperture > 0) c["aperture"] = camera.aperture;
        result.push_back(std::move(c));
    }
    return result;
}

ordered_json lights_of(const SceneDescription& scene)
{
    ordered_json result = ordered_json::array();
    for (const Light& light : scene.lights)
        result.push_back(
            {{"name", light.name}, {"kind", light_kind_name(light.kind)}, {"intensity", to_json(light.intensity)}});
    return result;
}

/// Settings of the image that the file contains; options override them.
ordered_json hints_json(const RenderHints& hints)
{
    ordered_json result = ordered_json::object();
    const auto add = [&](const char* key, const auto& value) {
        if (value) result[key] = *value;
    };
    add("width", hints.width);
    add("height", hints.height);
    add("spp", hints.samples);
    add("max_depth", hints.max_depth);
    add("roulette_depth", hints.roulette_depth);
    add("filter", hints.filter);
    add("filter_radius", hints.filter_radius);
    add("light_sampling", hints.light_sampling);
    add("exposure", hints.exposure);
    add("white_balance", hints.white_balance);
    if (hints.background) result["background"] = {hints.background->r, hints.background->g, hints.background->b};
    add("tonemap", hints.tonemap);
    return result;
}

/// Adds what only compiling shows: missing textures, degenerate triangles, memory.
void add_compiled(ordered_json& info, const SceneDescription& scene, Warnings& warnings)
{
    try {
        const CompileStatistics statistics = Scene::compile(scene, "", warnings).statistics();
        info["compiled"] = {{"triangles", statistics.triangles},       {"primitives", statistics.primitives},
                            {"instances", statistics.instances},       {"lights", statistics.lights},
                            {"memory_bytes", statistics.memory_bytes}, {"build_s", statistics.build_s}};
    } catch (const Error& error) {
        info["not renderable"] = error.what();
    }
}

}  // namespace

ordered_json describe_scene(const SceneOptions& options)
{
    Warnings warnings;
    SceneFileContents file = load_scene_file(options.file, load_options(options), warnings);
    SceneDescription& scene = file.scene;
    ordered_json info;
    info["file"] = options.file.string();
    info["format"] = file.format;
    info["files"] = files_of(scene);
    info["load_s"] = seconds_since_start();
    info["counts"] = count_json(scene);
    const Bounds bounds = world_bounds(scene);
    if (!bounds.empty)
        info["bounds"] = {
            {"min", to_json(bounds.min)}, {"max", to_json(bounds.max)}, {"size", to_json(bounds.max - bounds.min)}};
    info["cameras"] = cameras_of(scene);
    info["lights"] = lights_of(scene);
    info["environment"] = name_of(scene.environment.kind);
    info["materials"] = materials_of(scene);
    info["images"] = images_of(scene);
    info["settings"] = hints_json(scene.hints);
    info["scenes"] = file.scenes;
    info["variants"] = file.variants;
    info["animations"] = ordered_json::array();
    for (const Animation& animation : file.rig.animations)
        info["animations"].push_back(
            {{"name", animation.name}, {"duration_s", animation.duration()}, {"channels", animation.channels.size()}});
    info["added"] = ordered_json::array();
    if (add_default_camera(scene, {})) info["added"].push_back("a camera that frames the scene");
    add_compiled(info, scene, warnings);
    info["warnings"] = ordered_json::array();
    for (const auto& [message, times] : warnings.counts())
        info["warnings"].push_back({{"message", message}, {"count", times}});
    return info;
}

}  // namespace fathom::cli
