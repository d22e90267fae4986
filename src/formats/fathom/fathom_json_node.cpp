// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include "fathom/error.h"
#include "fathom/memory.h"
#include "formats/common/suggest.h"
#include "formats/fathom/fathom_json_reader.h"
#include "formats/io/read_file.h"

namespace fathom {

namespace {

/// Maximum nesting of nodes: more than real scenes have, and few enough for the stack that recursion uses.
constexpr int deepest_node = 200;

}  // namespace

int FathomJsonReader::node(const JsonValue& v, int depth)
{
    if (depth > deepest_node) v.fail(fmt::format("nodes are nested more than {} deep", deepest_node));
    if (v.is_string()) return named_node(v, depth);
    if (!v.is_object()) v.fail_type("a node, or the name of one");
    return add_node(v, "", depth);
}

int FathomJsonReader::named_node(const JsonValue& v, int depth)
{
    const std::string& name = v.string();
    const JsonValue definition = find("nodes", "node", v);
    Named& named = nodes_[name];
    if (named.state == State::read) return named.index;
    reading_nodes_.push_back(name);
    if (named.state == State::reading)
        v.fail(fmt::format("a node can't contain itself: {}", fmt::join(reading_nodes_, " > ")));
    named.state = State::reading;
    named.index = add_node(definition, name, depth);
    named.state = State::read;
    reading_nodes_.pop_back();
    return named.index;
}

int FathomJsonReader::add_node(const JsonValue& v, const std::string& name, int depth)
{
    Node node;
    node.name = name;
    JsonObject o(v);
    o.read("name", node.name);
    if (auto t = o.get("transform")) node.parent_from_node = transform(*t);
    if (auto motion = o.get("motion")) {
        if (v.has("transform"))
            motion->fail("a moving node can't have a 'transform' beside its 'motion'; give the transforms in its keys");
        read_motion(*motion, node);
    }

    std::optional<Shape> shape = read_shape(o);
    const auto model = o.get("model");
    const auto instance = o.get("instance");
    if (int(shape.has_value()) + int(model.has_value()) + int(instance.has_value()) > 1)
        v.fail("a node can have one shape, 'model' or 'instance'; put others into 'children'");
    if (model)
        read_model(o, *model, node);
    else if (auto m = o.get("material")) {
        if (!shape) m->fail("this node has no shape or model to apply a material to");
        shape->material = material(*m);
    }
    if (shape) {
        shape->name = node.name;
        node.shapes.push_back(*std::move(shape));
    }
    if (instance) {
        if (!instance->is_string()) instance->fail_type("the name of a node");
        node.children.push_back(named_node(*instance, depth + 1));
    }
    if (auto light = o.get("light")) read_light(*light, node);
    if (auto camera = o.get("camera")) {
        if (camera->is_string()) {
            node.camera = place(cameras_, "cameras", "camera", *camera).index;
        } else {
            node.camera = int(scene_.cameras.size());
            scene_.cameras.push_back(read_camera(*camera, node.name));
        }
    }
    if (auto children = o.get("children")) {
        children->array();
        for (std::size_t i = 0; i < children->size(); ++i) {
            const JsonValue child = (*children)[i];
            node.children.push_back(this->node(child, depth + 1));
        }
    }
    o.done("in a node");
    scene_.nodes.push_back(std::move(node));
    return int(scene_.nodes.size()) - 1;
}

void FathomJsonReader::read_motion(const JsonValue& v, Node& node)
{
    read_motion_keys(v, "a node's", node.motion, [&](JsonObject& o, NodeKey& key) {
        if (auto t = o.get("transform")) key.parent_from_node = transform(*t);
        if (!node.motion.empty() &&
            (key.parent_from_node.determinant() < 0) != (node.motion[0].parent_from_node.determinant() < 0))
            o.value().fail("only one of this key and the first key mirrors: in between, the node would be flat");
    });
    node.parent_from_node = node.motion.front().parent_from_node;
}

void FathomJsonReader::read_model(JsonObject& o, const JsonValue& path, Node& node)
{
    if (path.string().empty()) path.fail("the path of a model is empty");
    LoadOptions options;
    if (auto axis = o.get("up_axis")) {
        const std::vector<std::pair<std::string, char>> axes = {{"y", 'y'}, {"z", 'z'}};
        o.read_enum("up_axis", axes, options.up_axis);
    }
    o.read("scene", options.scene);
    const std::string key = path.string() + '\n' + options.up_axis + options.scene;
    auto found = models_.find(key);
    if (found == models_.end()) {
        SceneDescription model;
        const std::filesystem::path file = context_.locate(file_.parent_path() / path.string());
        if (!std::filesystem::exists(file)) path.fail(fmt::format("no such file: '{}'", file.string()));
        model = load_file(file, options, context_);
        found = models_.emplace(key, append_scene(scene_, std::move(model))).first;
    }
    Appended appended = found->second;
    const auto all = o.get("material");
    const auto some = o.get("materials");
    if (all && some) some->fail("a model can have either one 'material' or 'materials' by name");
    if (all || some) {
        check_copy(all ? *all : *some, std::size_t(appended.node_end - appended.first_node));
        appended = copy_nodes(scene_, appended);
        override_materials(o, appended);
    }
    node.children = appended.roots;
}

void FathomJsonReader::check_copy(const JsonValue& v, std::size_t nodes) const
{
    // Each node that overrides materials copies the model, so a short file can demand much memory. Growing the vector
    // moves the existing nodes.
    const std::size_t all = scene_.nodes.size() + nodes;
    double bytes = double(nodes) * double(sizeof(Node) + sizeof(Shape));
    if (all > scene_.nodes.capacity()) bytes += 2 * double(all) * double(sizeof(Node));
    if (bytes < 1e6) return;
    if (bytes > double(available_memory_bytes()))
        v.fail(fmt::format("a copy of the model with other materials needs {:.1f} GB of memory, {}", bytes / 1e9,
                           available_memory_text()));
}

void FathomJsonReader::override_materials(JsonObject& o, const Appended& model)
{
    const auto for_each_shape = [&](auto&& change) {
        for (int i = model.first_node; i < model.node_end; ++i)
            for (Shape& shape : scene_.nodes[std::size_t(i)].shapes) change(shape);
    };
    if (auto all = o.get("material")) {
        const int index = material(*all);
        for_each_shape([&](Shape& shape) { shape.material = index; });
        return;
    }
    const auto some = o.get("materials");
    if (!some) return;
    some->object();
    for (const auto& [name, json] : some->json().items()) {
        std::vector<std::string> names;
        const int index = material((*some)[name]);
        int replaced = 0;
        for_each_shape([&](Shape& shape) {
            if (shape.material < model.first_material || shape.material >= model.material_end) return;
            if (scene_.materials[std::size_t(shape.material)].name != name) return;
            shape.material = index;
            ++replaced;
        });
        if (replaced > 0) continue;
        for (int i = model.first_material; i < model.material_end; ++i)
            names.push_back(scene_.materials[std::size_t(i)].name);
        (*some)[name].fail(
            fmt::format("the model has no material named '{}'{}", printable(name), suggestion(name, names)));
    }
}

}  // namespace fathom
