// SPDX-License-Identifier: Apache-2.0
#include "formats/fathom/fathom_json.h"

#include <fmt/format.h>

#include <algorithm>

#include <numbers>

#include "fathom/error.h"
#include "formats/common/suggest.h"
#include "formats/fathom/fathom_json_reader.h"
#include "formats/io/read_file.h"
#include "scene/enum_names.h"
#include "scene/units.h"

namespace fathom {

namespace {

void check_camera(const JsonValue& v, const Camera& camera)
{
    const Vec3d view = camera.look_at - camera.position;
    if (length(view) == 0) v.fail("'position' and 'look_at' are the same point");
    if (length(cross(normalize(view), normalize(camera.up))) < 1e-9)
        v.fail("'up' must not be zero or parallel to the view direction");
    if (camera.aspect < 0) v["aspect"].fail("must not be negative");
    if (camera.aperture < 0) v["aperture"].fail("must not be negative");
    if (camera.focus_distance < 0) v["focus_distance"].fail("must not be negative");
}

}  // namespace

Camera FathomJsonReader::read_camera(const JsonValue& v, const std::string& name)
{
    Camera camera;
    camera.name = name;
    JsonObject o(v);
    o.read("name", camera.name);
    o.read_word("kind", words::camera_kinds, camera.kind);
    o.read("position", camera.position);
    o.read("look_at", camera.look_at);
    o.read("up", camera.up);
    o.read("aspect", camera.aspect);
    if (o.get("fov_axis")) {
        o.read_word("fov_axis", words::fov_axes, camera.fov_axis);
        o.read("fov_aspect", camera.fov_aspect);
        if (!(camera.fov_aspect > 0)) v["fov_axis"].fail("needs a 'fov_aspect' above 0");
    }
    if (auto shift = o.get("shift")) {
        shift->array_of(2);
        camera.shift_x = (*shift)[0].number();
        camera.shift_y = (*shift)[1].number();
    }
    if (auto shutter = o.get("shutter")) {
        shutter->array_of(2);
        camera.shutter_open = (*shutter)[0].number();
        camera.shutter_close = (*shutter)[1].number();
        if (camera.shutter_close < camera.shutter_open) shutter->fail("the shutter closes before it opens");
    }
    if (camera.kind == CameraKind::perspective) {
        if (auto fov = o.get("fov_y_deg")) {
            camera.fov_y = fov->number() * radians_per_degree;
            if (!(camera.fov_y > 0 && camera.fov_y < std::numbers::pi))
                fov->fail(fmt::format("must be between 0 and 180, found {}", fov->number()));
        }
        o.read("aperture", camera.aperture);
        o.read("focus_distance", camera.focus_distance);
        o.done("in a perspective camera");
    } else if (camera.kind != CameraKind::orthographic) {
        if (v.has("shift")) v["shift"].fail("panoramic cameras have none");
        o.done("in a panoramic camera");
    } else {
        o.read("height", camera.height);
        if (!(camera.height > 0)) v["height"].fail("must be greater than 0");
        o.done("in an orthographic camera");
    }
    check_camera(v, camera);
    return camera;
}

void FathomJsonReader::read_cameras(JsonObject& scene)
{
    const auto add = [&](const JsonValue& v, const std::string& name) {
        cameras_[name].index = int(scene_.cameras.size());
        scene_.cameras.push_back(read_camera(v, name));
    };
    const auto camera = scene.get("camera");
    const auto cameras = scene.get("cameras");
    if (camera && cameras) cameras->fail("a file can have 'camera' or 'cameras', not both");
    if (camera) add(*camera, "camera");
    if (cameras) tables_.emplace("cameras", cameras->object());
    for_each_named("cameras", [&](const std::string& name, const JsonValue& v) { add(v, name); });
}

void FathomJsonReader::read_environment(const JsonValue& v)
{
    Environment& environment = scene_.environment;
    JsonObject o(v);
    if (!v.has("kind"))
        v.fail(
            "key 'kind' is missing: expected none, constant, gradient, image, studio, sky, cube, equal-area or "
            "hosek-wilkie");
    o.read_word("kind", words::environment_kinds, environment.kind);
    const bool turns = environment.kind != EnvironmentKind::none && environment.kind != EnvironmentKind::constant;
    if (environment.kind != EnvironmentKind::none && environment.kind != EnvironmentKind::gradient)
        o.read("color", environment.color);
    if (environment.kind == EnvironmentKind::gradient) {
        o.read("bottom", environment.bottom);
        o.read("top", environment.top);
    }
    if (environment.kind == EnvironmentKind::image || environment.kind == EnvironmentKind::equal_area)
        environment.image = image(o.require("image"));
    if (environment.kind == EnvironmentKind::image || environment.kind == EnvironmentKind::equal_area ||
        environment.kind == EnvironmentKind::cube)
        o.read("illuminance", environment.illuminance);
    if (environment.illuminance < 0) v["illuminance"].fail("must not be negative");
    if (environment.kind == EnvironmentKind::cube) {
        const JsonValue faces = o.require("faces");
        faces.array_of(6);
        for (std::size_t i = 0; i < 6; ++i) environment.faces[i] = image(faces[i]);
    }
    if (environment.kind == EnvironmentKind::sky) {
        o.read("to_sun", environment.to_sun);
        o.read("sun", environment.sun_disk);
        o.read("ground", environment.sky_ground);
    }
    if (environment.kind == EnvironmentKind::hosek_wilkie) {
        o.read("to_sun", environment.to_sun);
        o.read("turbidity", environment.turbidity);
        o.read("ground_albedo", environment.ground_albedo);
    }
    if (turns) {
        if (auto rotate = o.get("rotate"))
            environment.world_from_environment = rotate->has("matrix") ? transform(*rotate) : read_rotation(*rotate);
    }
    o.done(fmt::format("in an environment of kind '{}'", v["kind"].string()));
}

void FathomJsonReader::read_render(const JsonValue& v)
{
    RenderHints& hints = scene_.hints;
    JsonObject o(v);
    const auto read_int = [&](const char* key, std::optional<int>& out, int least) {
        if (auto value = o.get(key)) {
            out = value->integer();
            if (*out < least) value->fail(fmt::format("must be at least {}, found {}", least, *out));
        }
    };
    if (auto size = o.get("size")) {
        size->array_of(2);
        for (std::size_t i : {0, 1}) {
            const int pixels = (*size)[i].integer();
            if (pixels < 1) (*size)[i].fail("an image must be at least 1 pixel wide and high");
            (i == 0 ? hints.width : hints.height) = pixels;
        }
    }
    read_int("samples", hints.samples, 1);
    read_int("max_depth", hints.max_depth, -1);
    read_int("roulette_depth", hints.roulette_depth, 0);
    o.read_word("filter", words::filters, hints.filter);
    if (auto value = o.get("filter_radius")) {
        hints.filter_radius = value->number();
        if (!(*hints.filter_radius >= 0.01 && *hints.filter_radius <= 64)) value->fail("must be 0.01 to 64 pixels");
    }
    o.read_word("tonemap", words::tonemaps, hints.tonemap);
    o.read_word("build", words::builds, hints.build);
    if (auto value = o.get("light_sampling")) hints.light_sampling = value->boolean();
    if (auto value = o.get("exposure")) hints.exposure = value->number();
    if (auto value = o.get("white_balance")) {
        hints.white_balance = value->number();
        if (!(*hints.white_balance >= min_white_kelvin && *hints.white_balance <= max_white_kelvin))
            value->fail(fmt::format("the temperature of light must be {} to {} K", min_white_kelvin, max_white_kelvin));
    }
    if (auto value = o.get("background")) hints.background = value->color();
    if (auto value = o.get("own_light")) hints.own_light = value->boolean();
    o.done("in render settings");
}

JsonValue FathomJsonReader::find(const char* table_name, const char* what, const JsonValue& v)
{
    const std::string& name = v.string();
    const JsonValue* named = table(table_name);
    if (named && named->has(name)) return (*named)[name];
    std::vector<std::string> names;
    if (named)
        for (const auto& [key, json] : named->json().items()) names.push_back(key);
    v.fail(fmt::format("there is no {} named '{}'{}", what, printable(name), suggestion(name, names)));
}

FathomJsonReader::Placed FathomJsonReader::place(IndexedMap<std::string, Placed>& all, const char* table_name,
                                                 const char* what, const JsonValue& v)
{
    find(table_name, what, v);
    Placed& placed = all.find(v.string())->second;
    placed.is_placed = true;
    return placed;
}

const JsonValue* FathomJsonReader::table(const char* key)
{
    const auto found = tables_.find(key);
    return found == tables_.end() ? nullptr : &found->second;
}

void FathomJsonReader::read_unused()
{
    for_each_named("textures", [&](const std::string& name, const JsonValue& v) {
        if (!textures_.contains({name, Use::color}) && !textures_.contains({name, Use::data}))
            textures_[{name, Use::color}] = add_texture(v, name, Use::color);
    });
    for_each_named("nodes", [&](const std::string& name, const JsonValue& v) {
        if (nodes_.contains(name)) return;
        nodes_[name].state = State::read;
        nodes_[name].index = add_node(v, name, 0);
    });
}

/// Adds named cameras and lights that no node refers to as root nodes.
void FathomJsonReader::add_unplaced_to_roots()
{
    const auto add = [&](const std::string& name, int Node::* member, Placed& placed) {
        if (placed.is_placed) return;
        Node node;
        node.name = name;
        node.parent_from_node = placed.place;
        node.*member = placed.index;
        scene_.roots.push_back(int(scene_.nodes.size()));
        scene_.nodes.push_back(std::move(node));
    };
    for (auto& [name, camera] : cameras_) add(name, &Node::camera, camera);
    for (auto& [name, light] : lights_) add(name, &Node::light, light);
}

SceneDescription FathomJsonReader::read()
{
    JsonObject o(root_);
    scene_.file = file_.string();
    if (auto schema = o.get("$schema")) schema->string();
    if (auto version = o.get("fathom"))
        if (version->integer() != 1)
            version->fail(fmt::format("format {} is not supported; this version reads format 1", version->integer()));
    for (const char* key : {"textures", "materials", "meshes", "curves", "points", "lights", "nodes"})
        if (auto v = o.get(key)) tables_.emplace(key, v->object());

    read_cameras(o);
    for_each_named("lights", [&](const std::string& name, const JsonValue& v) { lights_[name] = add_light(v, name); });
    // Reading in the order of the file makes ids in images and the order of a saved scene follow it. Other things are
    // read when they are referred to.
    read_textures();
    read_materials();
    for_each_named("meshes", [&](const std::string& name, const JsonValue& v) { meshes_[name] = add_mesh(v, name); });
    for_each_named("curves", [&](const std::string& name, const JsonValue& v) { curves_[name] = add_curves(v, name); });
    for_each_named("points", [&](const std::string& name, const JsonValue& v) { points_[name] = add_points(v, name); });
    if (auto nodes = o.get("scene")) {
        nodes->array();
        for (std::size_t i = 0; i < nodes->size(); ++i) {
            const JsonValue v = (*nodes)[i];
            scene_.roots.push_back(node(v, 0));
        }
    }
    add_unplaced_to_roots();
    if (auto environment = o.get("environment")) read_environment(*environment);
    scene_.hints.own_light = true;
    if (auto render = o.get("render")) read_render(*render);
    o.done("in a scene");
    read_unused();
    keep_zero_exposure();
    return std::move(scene_);
}

/// Fixes the exposure of scenes with light of their own (`own_light`) at 0 if they have emission or an environment.
/// Scenes with only lamps, which are in physical units, keep automatic exposure.
void FathomJsonReader::keep_zero_exposure()
{
    const bool emits = std::any_of(scene_.materials.begin(), scene_.materials.end(), [](const Material& m) {
        return std::max({m.emission.radiance.value.r, m.emission.radiance.value.g, m.emission.radiance.value.b}) > 0;
    });
    if (scene_.hints.own_light && !scene_.hints.exposure && (emits || scene_.environment.kind != EnvironmentKind::none))
        scene_.hints.exposure = 0;
}

bool begins_as_object(std::string_view text)
{
    const std::size_t first = text.find_first_not_of(" \t\r\n\xef\xbb\xbf");
    return first != std::string_view::npos && text[first] == '{';
}

SceneDescription read_fathom_json(const std::filesystem::path& file, std::string_view text, LoadContext& context)
{
    const std::string name = file.string();
    const Json json = parse_json(name, text, DuplicateKeys::error);
    const JsonValue root(name, json);
    return FathomJsonReader(file, root, context).read();
}

}  // namespace fathom
