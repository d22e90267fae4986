// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "formats/common/suggest.h"
#include "formats/gltf/gltf.h"
#include "formats/gltf/gltf_reader.h"
#include "formats/io/read_file.h"
#include "scene/check.h"

namespace fathom {

namespace {

Transform read_rotation(const JsonValue& v)
{
    v.array_of(4);
    return Transform::rotate_quaternion(v[0].number(), v[1].number(), v[2].number(), v[3].number());
}

Transform read_transform(const JsonValue& v)
{
    Transform t;
    if (const auto matrix = v.get("matrix")) {
        matrix->array_of(16);
        for (std::size_t column = 0; column < 4; ++column)
            for (std::size_t row = 0; row < 3; ++row) t.m[row][column] = (*matrix)[4 * column + row].number();
        return t;
    }
    if (const auto translation = v.get("translation")) t = Transform::translate(translation->vec3d());
    if (const auto rotation = v.get("rotation")) t = t * read_rotation(*rotation);
    if (const auto scale = v.get("scale")) t = t * Transform::scale(scale->vec3d());
    return t;
}

/// A node's rest pose, for animations that animate only some of its properties.
NodeRestPose read_rest(const JsonValue& v)
{
    NodeRestPose rest;
    if (const auto translation = v.get("translation")) rest.translation = translation->vec3d();
    if (const auto rotation = v.get("rotation"))
        for (std::size_t i = 0; i < 4; ++i) rest.rotation[i] = rotation->array_of(4)[i].number();
    if (const auto scale = v.get("scale")) rest.scale = scale->vec3d();
    if (const auto weights = v.get("weights"))
        for (std::size_t i = 0; i < weights->array().size(); ++i) rest.weights.push_back((*weights)[i].single());
    return rest;
}

double positive(const JsonValue& v, const char* key)
{
    if (!v.has(key)) v.fail(fmt::format("key '{}' is missing", key));
    const double value = v[key].number();
    if (!(value > 0)) v[key].fail(fmt::format("must be greater than 0, found {}", value));
    return value;
}

/// Names of the objects of a list; their indices where they have none.
std::vector<std::string> names_in(const JsonValue& list)
{
    std::vector<std::string> names;
    for (std::size_t i = 0; i < list.size(); ++i) {
        const JsonValue element = list[i];
        const auto name = element.get("name");
        names.push_back(name ? name->string() : std::to_string(i));
    }
    return names;
}

}  // namespace

int GltfReader::camera(const JsonValue& index)
{
    const auto [found, is_new] = cameras_.try_emplace(index.count(), int(scene_.cameras.size()));
    if (!is_new) return found->second;
    const JsonValue v = file_.follow("cameras", index);
    Camera camera;
    camera.name = fmt::format("camera {}", index.count());
    if (const auto name = v.get("name")) camera.name = name->string();
    if (!v.has("type")) v.fail("key 'type' is missing");
    const std::string type = v["type"].string();
    // The file's aspect ratio is that of the window it was made in. The render's own aspect ratio shows at least as
    // much.
    if (type == "perspective" && v.has("perspective")) {
        const JsonValue perspective = v["perspective"];
        camera.fov_y = positive(perspective, "yfov");
        if (camera.fov_y >= std::numbers::pi) perspective["yfov"].fail("must be less than pi");
    } else if (type == "orthographic" && v.has("orthographic")) {
        const JsonValue orthographic = v["orthographic"];
        camera.kind = CameraKind::orthographic;
        camera.height = 2 * std::abs(orthographic.has("ymag") ? orthographic["ymag"].number() : 0);
        if (!(camera.height > 0)) orthographic.fail("'ymag' must not be 0");
    } else {
        v.fail(fmt::format("is neither a perspective nor an orthographic camera"));
    }
    scene_.cameras.push_back(std::move(camera));
    return found->second;
}

namespace {

LightKind light_kind(const JsonValue& v)
{
    if (!v.has("type")) v.fail("key 'type' is missing");
    const std::string type = v["type"].string();
    if (type == "point") return LightKind::point;
    if (type == "spot") return LightKind::spot;
    if (type == "directional") return LightKind::directional;
    v["type"].fail(fmt::format("'{}' is not one of point, spot, directional", printable(type)));
}

void read_cone(const JsonValue& spot, Light& light)
{
    light.inner_angle = spot.has("innerConeAngle") ? spot["innerConeAngle"].number() : 0;
    light.outer_angle = spot.has("outerConeAngle") ? spot["outerConeAngle"].number() : std::numbers::pi / 4;
    if (!(light.inner_angle >= 0 && light.outer_angle > 0 && light.inner_angle <= light.outer_angle &&
          light.outer_angle <= std::numbers::pi / 2 + 1e-6))
        spot.fail("must satisfy 0 <= innerConeAngle <= outerConeAngle <= pi/2");
}

}  // namespace

/// Reads a light of KHR_lights_punctual.
int GltfReader::light(const JsonValue& index)
{
    const auto [found, is_new] = lights_.try_emplace(index.count(), int(scene_.lights.size()));
    if (!is_new) return found->second;
    const auto extensions = file_.root().get("extensions");
    const auto extension = extensions ? extensions->get("KHR_lights_punctual") : std::nullopt;
    const auto lights = extension ? extension->get("lights") : std::nullopt;
    if (!lights || index.count() >= lights->array().size())
        index.fail(fmt::format("there is no light {}", index.count()));
    const JsonValue v = (*lights)[index.count()];
    v.object();

    Light light;
    if (const auto name = v.get("name")) light.name = name->string();
    light.kind = light_kind(v);
    Color color{1, 1, 1};
    if (const auto c = v.get("color")) color = c->array_of(3).color();
    const float intensity = v.has("intensity") ? std::max(0.0f, v["intensity"].single()) : 1;
    light.intensity = {color.r * intensity, color.g * intensity, color.b * intensity};
    if (const auto spot = v.get("spot")) read_cone(*spot, light);
    if (light.kind != LightKind::directional && v.has("range"))
        file_.warn(
            "'range' of lights is ignored: their light falls off with the square of the distance at any distance");
    scene_.lights.push_back(std::move(light));
    return found->second;
}

/// EXT_lights_image_based: reads the largest cube map. Smaller mip levels and irradiance coefficients are prefiltered,
/// which rendering makes unnecessary.
void GltfReader::read_environment(const JsonValue& reference)
{
    if (!reference.has("light")) reference.fail("key 'light' is missing");
    const JsonValue index = reference["light"];
    const auto extensions = file_.root().get("extensions");
    const auto extension = extensions ? extensions->get("EXT_lights_image_based") : std::nullopt;
    const auto lights = extension ? extension->get("lights") : std::nullopt;
    if (!lights || index.count() >= lights->array().size())
        index.fail(fmt::format("there is no image-based light {}", index.count()));
    const JsonValue v = (*lights)[index.count()];
    const auto images = v.get("specularImages");
    if (!images || images->array().size() == 0) v.fail("key 'specularImages' is missing, or empty");
    const JsonValue faces = (*images)[0];
    faces.array_of(6);
    Environment& environment = scene_.environment;
    environment.kind = EnvironmentKind::cube;
    for (std::size_t i = 0; i < 6; ++i) environment.faces[i] = image(faces[i]);
    const float intensity = v.has("intensity") ? std::max(0.0f, v["intensity"].single()) : 1;
    environment.color = {intensity, intensity, intensity};
    if (const auto rotation = v.get("rotation")) environment.world_from_environment = read_rotation(*rotation);
}

void GltfReader::add_instances(const JsonValue& instancing, std::size_t index)
{
    const auto attributes = instancing.get("attributes");
    if (!attributes) instancing.fail("key 'attributes' is missing");
    std::size_t count = 0;
    const auto read = [&](const char* name, int components) {
        std::vector<float> values;
        const auto accessor_index = attributes->get(name);
        if (!accessor_index) return values;
        const Accessor accessor(file_, *accessor_index);
        if (accessor.components() != components)
            accessor.fail(fmt::format("{} with {} components", name, accessor.components()));
        if (count != 0 && accessor.count() != count)
            accessor.fail("has a different number of elements than the other attributes");
        count = accessor.count();
        if (count > 10'000'000) accessor.fail(fmt::format("{} instances are too many", count));
        values.resize(count * std::size_t(components));
        accessor.read(0, count, components, 0, values.data());
        return values;
    };
    const auto translations = read("TRANSLATION", 3), rotations = read("ROTATION", 4), scales = read("SCALE", 3);
    file_.check_memory(instancing,
                       double(count) * double(sizeof(Node) + scene_.nodes[index].shapes.size() * sizeof(Shape)));
    const std::vector<Shape> shapes = std::move(scene_.nodes[index].shapes);
    scene_.nodes[index].shapes.clear();
    for (std::size_t i = 0; i < count; ++i) {
        Node node;
        node.shapes = shapes;
        Transform& t = node.parent_from_node;
        if (!translations.empty())
            t = Transform::translate({translations[3 * i], translations[3 * i + 1], translations[3 * i + 2]});
        if (!rotations.empty())
            t = t * Transform::rotate_quaternion(rotations[4 * i], rotations[4 * i + 1], rotations[4 * i + 2],
                                                 rotations[4 * i + 3]);
        if (!scales.empty()) t = t * Transform::scale({scales[3 * i], scales[3 * i + 1], scales[3 * i + 2]});
        scene_.nodes[index].children.push_back(int(scene_.nodes.size()));
        scene_.nodes.push_back(std::move(node));
    }
}

void GltfReader::read_node_transform(const JsonValue& v, std::size_t index)
{
    v.object();
    Node& node = scene_.nodes[index];
    if (const auto name = v.get("name")) node.name = printable(name->string());
    node.parent_from_node = read_transform(v);
    if (!rig_.animations.empty()) rig_.nodes[index] = read_rest(v);
    if (const auto children = v.get("children")) {
        children->array();
        for (std::size_t i = 0; i < children->size(); ++i) {
            const JsonValue child = (*children)[i];
            const JsonValue child_node = file_.follow("nodes", child);
            const std::size_t c = child.count();
            if (parents_[c] >= 0) child.fail(fmt::format("{} has two parents", child_node.place()));
            parents_[c] = int(index);
            node.children.push_back(int(c));
        }
    }
    // KHR_node_visibility hides a node with its descendants.
    if (const auto extensions = v.get("extensions"))
        if (const auto visibility = extensions->get("KHR_node_visibility"))
            if (visibility->has("visible") && !(*visibility)["visible"].boolean()) {
                rig_.nodes[index].visible = false;
                // A node whose visibility is animated is read normally and hidden afterward.
                if (may_hide_[index]) return;
                node.children.clear();
                invisible_[index] = true;
            }
}

void GltfReader::read_contents(const JsonValue& v, std::size_t index)
{
    if (invisible_[index]) return;
    if (const auto c = v.get("camera")) scene_.nodes[index].camera = camera(*c);
    const auto extensions = v.get("extensions");
    if (extensions)
        if (const auto punctual = extensions->get("KHR_lights_punctual"))
            if (const auto l = punctual->get("light")) scene_.nodes[index].light = light(*l);
    if (const auto m = v.get("mesh")) {
        const std::vector<Part>& parts = mesh(*m, v.get("weights"), index);
        if (const auto skin = v.get("skin"))
            add_skinned(*skin, index, parts);
        else
            for (const Part& part : parts) {
                scene_.nodes[index].shapes.push_back(part.shape);
                if (const auto* instance = std::get_if<MeshInstance>(&part.shape.geometry);
                    instance && is_morphed_[index])
                    add_deformed(part, instance->mesh, index, -1);
            }
    }
    if (extensions)
        if (const auto instancing = extensions->get("EXT_mesh_gpu_instancing")) add_instances(*instancing, index);
}

void GltfReader::read_roots()
{
    const JsonValue& scenes = file_.list("scenes");
    offered_.scenes = names_in(scenes);
    if (scenes.size() == 0) {
        if (!options_.scene.empty())
            scenes.fail(fmt::format("there is no scene '{}': the file has none", printable(options_.scene)));
        for (std::size_t i = 0; i < parents_.size(); ++i)
            if (parents_[i] < 0) scene_.roots.push_back(int(i));
        return;
    }
    std::size_t chosen = 0;
    if (!options_.scene.empty()) {
        const auto found = find_choice(options_.scene, offered_.scenes);
        if (!found)
            scenes.fail(fmt::format("there is no scene '{}'{}", printable(options_.scene),
                                    choices(options_.scene, offered_.scenes)));
        chosen = *found;
    } else if (const auto index = file_.root().get("scene")) {
        file_.follow("scenes", *index);
        chosen = index->count();
    }
    if (scenes.size() > 1 && options_.scene.empty())
        file_.warn(fmt::format("scene {} of 0 to {} is used; --scene chooses another one", chosen, scenes.size() - 1));
    const JsonValue scene = scenes[chosen];
    if (const auto extensions = scene.get("extensions"))
        if (const auto light = extensions->get("EXT_lights_image_based")) read_environment(*light);
    const auto nodes = scene.get("nodes");
    if (!nodes) return;
    nodes->array();
    for (std::size_t i = 0; i < nodes->size(); ++i) {
        file_.follow("nodes", (*nodes)[i]);
        scene_.roots.push_back((*nodes)[i].integer());
    }
}

void GltfReader::choose_variant()
{
    const auto extensions = file_.root().get("extensions");
    const auto extension = extensions ? extensions->get("KHR_materials_variants") : std::nullopt;
    const auto variants = extension ? extension->get("variants") : std::nullopt;
    if (variants) offered_.variants = names_in(variants->array());
    if (options_.variant.empty()) return;
    const auto found = find_choice(options_.variant, offered_.variants);
    if (!found)
        file_.root().fail(fmt::format("there is no variant '{}'{}", printable(options_.variant),
                                      choices(options_.variant, offered_.variants)));
    variant_ = found;
}

/// Removes meshes that no node refers to: skinned nodes have bent copies of them.
void GltfReader::remove_unused_meshes()
{
    std::vector<int> new_index(scene_.meshes.size(), -1);
    std::vector<Mesh> kept;
    for (Node& node : scene_.nodes)
        for (Shape& shape : node.shapes) {
            auto* instance = std::get_if<MeshInstance>(&shape.geometry);
            if (!instance) continue;
            int& index = new_index[std::size_t(instance->mesh)];
            if (index < 0) {
                index = int(kept.size());
                kept.push_back(std::move(scene_.meshes[std::size_t(instance->mesh)]));
            }
            instance->mesh = index;
        }
    scene_.meshes = std::move(kept);
    for (DeformedMesh& d : rig_.meshes) d.mesh = new_index[std::size_t(d.mesh)];
    std::erase_if(rig_.meshes, [](const DeformedMesh& d) { return d.mesh < 0; });
}

SceneDescription GltfReader::read()
{
    scene_.file = file_.name();
    choose_variant();
    const JsonValue& nodes = file_.list("nodes");
    scene_.nodes.resize(nodes.size());
    parents_.assign(nodes.size(), -1);
    invisible_.assign(nodes.size(), false);
    rig_.nodes.resize(nodes.size());
    read_animations();
    for (std::size_t i = 0; i < nodes.size(); ++i) read_node_transform(nodes[i], i);
    read_roots();
    const std::vector<bool> reachable = reachable_nodes(scene_);
    for (std::size_t i = 0; i < nodes.size(); ++i)
        if (reachable[i]) read_contents(nodes[i], i);
    remove_unused_meshes();
    if (!rig_.animations.empty()) {
        rig_.parents = parents_;
        find_targets();
        hide_nodes();
        offered_.rig = std::move(rig_);
    }
    return std::move(scene_);
}

SceneDescription read_gltf(const std::filesystem::path& file, const std::string& bytes, const LoadOptions& options,
                           LoadContext& context)
{
    GltfFile gltf(file, bytes, context);
    SceneFileContents offered;
    SceneDescription scene = GltfReader(gltf, options, offered).read();
    const bool is_model_of_scene = context.open_files.size() > 1;
    if (!is_model_of_scene)
        context.offered = std::move(offered);
    else if (!offered.rig.animations.empty())
        gltf.warn("animations of a model within a scene are not supported: its rest pose is used");
    return scene;
}

bool looks_like_gltf(std::string_view text)
{
    return text.find("\"asset\"") != std::string_view::npos && text.find("\"version\"") != std::string_view::npos &&
           text.find("\"fathom\"") == std::string_view::npos;
}

}  // namespace fathom
