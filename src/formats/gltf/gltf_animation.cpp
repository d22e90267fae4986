// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>

#include "fathom/error.h"
#include "formats/gltf/gltf_reader.h"
#include "formats/io/read_file.h"
#include "scene/animation.h"
#include "scene/check.h"

namespace fathom {

namespace {

/// A JSON pointer of KHR_animation_pointer, where `*` is the target's index, and the property that it animates.
struct Pointer {
    const char* pattern;
    const char* list;  ///< list of targets in the file; null: the light list of KHR_lights_punctual
    AnimatedProperty value;
    const char* factor = nullptr;  ///< member of the same object that multiplies the value
    bool is_factor_colour = false;
};
constexpr Pointer pointers[] = {
    {"/nodes/*/translation", "nodes", AnimatedProperty::translation},
    {"/nodes/*/rotation", "nodes", AnimatedProperty::rotation},
    {"/nodes/*/scale", "nodes", AnimatedProperty::scale},
    {"/nodes/*/weights", "nodes", AnimatedProperty::weights},
    {"/nodes/*/extensions/KHR_node_visibility/visible", "nodes", AnimatedProperty::visible},
    {"/materials/*/pbrMetallicRoughness/baseColorFactor", "materials", AnimatedProperty::base_color},
    {"/materials/*/pbrMetallicRoughness/metallicFactor", "materials", AnimatedProperty::metallic},
    {"/materials/*/pbrMetallicRoughness/roughnessFactor", "materials", AnimatedProperty::roughness},
    {"/materials/*/emissiveFactor", "materials", AnimatedProperty::emission,
     "/extensions/KHR_materials_emissive_strength/emissiveStrength"},
    {"/materials/*/extensions/KHR_materials_emissive_strength/emissiveStrength", "materials",
     AnimatedProperty::emission, "/emissiveFactor", true},
    {"/materials/*/alphaCutoff", "materials", AnimatedProperty::alpha_cutoff},
    {"/materials/*/normalTexture/scale", "materials", AnimatedProperty::normal_scale},
    {"/extensions/KHR_lights_punctual/lights/*/color", nullptr, AnimatedProperty::intensity, "/intensity"},
    {"/extensions/KHR_lights_punctual/lights/*/intensity", nullptr, AnimatedProperty::intensity, "/color", true},
    {"/extensions/KHR_lights_punctual/lights/*/spot/innerConeAngle", nullptr, AnimatedProperty::inner_angle},
    {"/extensions/KHR_lights_punctual/lights/*/spot/outerConeAngle", nullptr, AnimatedProperty::outer_angle},
    {"/cameras/*/perspective/yfov", "cameras", AnimatedProperty::fov_y},
    {"/cameras/*/orthographic/ymag", "cameras", AnimatedProperty::height}};

/// Returns the index in place of `*` if the text matches the pattern.
std::optional<int> match(std::string_view pattern, std::string_view text)
{
    const std::size_t star = pattern.find('*');
    if (!text.starts_with(pattern.substr(0, star))) return {};
    int number = 0;
    const char* const begin = text.data() + star;
    const auto [end, error] = std::from_chars(begin, text.data() + text.size(), number);
    const std::string_view rest(end, std::size_t(text.data() + text.size() - end));
    if (error != std::errc() || number < 0 || rest != pattern.substr(star + 1)) return {};
    return number;
}

/// The pointer with indices replaced by `*`, so that each kind is reported once.
std::string pattern_of(const std::string& pointer)
{
    std::string pattern;
    for (const char c : pointer) {
        if (c < '0' || c > '9')
            pattern += c;
        else if (!pattern.ends_with('*'))
            pattern += '*';
    }
    return pattern;
}

Interpolation interpolation_of(const JsonValue& sampler)
{
    const auto v = sampler.get("interpolation");
    if (!v || v->string() == "LINEAR") return Interpolation::linear;
    if (v->string() == "STEP") return Interpolation::step;
    if (v->string() == "CUBICSPLINE") return Interpolation::cubic;
    v->fail(fmt::format("'{}' is not one of LINEAR, STEP, CUBICSPLINE", printable(v->string())));
}

/// The value at a JSON pointer below `json`, or null.
const Json* below(const Json& json, const std::string& pointer)
{
    const Json::json_pointer p(pointer);
    return json.contains(p) ? &json[p] : nullptr;
}

std::vector<float> numbers_of(const Json& json)
{
    std::vector<float> numbers;
    if (json.is_number()) numbers.push_back(json.get<float>());
    for (std::size_t i = 0; json.is_array() && i < json.size(); ++i)
        numbers.push_back(json[i].is_number() ? json[i].get<float>() : 0.0f);
    return numbers;
}

/// Multiplies animated values of each key with a constant factor or color of the file.
void multiply(std::vector<float>& values, std::vector<float> rest, bool rest_is_colour)
{
    const std::size_t wanted = rest_is_colour ? 3 : 1;
    if (rest.size() != wanted) rest.assign(wanted, 1.0f);
    std::vector<float> result;
    for (const float value : values)
        for (const float r : rest) result.push_back(value * r);
    values = std::move(result);
}

}  // namespace

AnimationChannel GltfReader::channel_of_path(const JsonValue& target, const std::string& path) const
{
    AnimationChannel channel;
    if (path == "translation")
        channel.value = AnimatedProperty::translation;
    else if (path == "rotation")
        channel.value = AnimatedProperty::rotation;
    else if (path == "scale")
        channel.value = AnimatedProperty::scale;
    else if (path == "weights")
        channel.value = AnimatedProperty::weights;
    else
        target["path"].fail(
            fmt::format("'{}' is not one of translation, rotation, scale, weights, pointer", printable(path)));
    const JsonValue node = target["node"];
    file_.follow("nodes", node);
    channel.target = int(node.count());
    return channel;
}

std::optional<AnimationChannel> GltfReader::channel_of_pointer(const JsonValue& pointer)
{
    for (const Pointer& p : pointers) {
        const std::optional<int> number = match(p.pattern, pointer.string());
        if (!number) continue;
        const auto extensions = file_.root().get("extensions");
        const auto punctual = extensions ? extensions->get("KHR_lights_punctual") : std::nullopt;
        const auto lights = punctual ? punctual->get("lights") : std::nullopt;
        const std::size_t targets = p.list ? file_.list(p.list).size() : lights ? lights->size() : 0;
        if (std::size_t(*number) >= targets)
            pointer.fail(fmt::format("there is no {}: the file has {} of them", printable(pointer.string()), targets));
        AnimationChannel channel;
        channel.value = p.value;
        channel.target = *number;
        return channel;
    }
    file_.warn(
        fmt::format("animations of {} are not supported and are ignored", printable(pattern_of(pointer.string()))));
    return {};
}

/// Emission and light intensity are products of a factor and a color in glTF; multiplies the animated one with the
/// other's value at rest.
void GltfReader::scale_by_rest_value(const std::string& pointer, AnimationChannel& channel) const
{
    for (const Pointer& p : pointers) {
        if (!p.factor || !match(p.pattern, pointer)) continue;
        const std::string member(p.pattern, std::string_view(p.pattern).find('*'));
        const Json* target = below(file_.root().json(), member + std::to_string(channel.target));
        const Json* rest = target ? below(*target, p.factor) : nullptr;
        // Factors have defaults: without an emissive factor nothing is emitted, and lights are white.
        const bool is_dark = !rest && std::string_view(p.factor) == "/emissiveFactor";
        multiply(channel.values,
                 is_dark ? std::vector<float>(3, 0.0f)
                 : rest  ? numbers_of(*rest)
                         : std::vector<float>(),
                 p.is_factor_colour);
    }
}

std::optional<AnimationChannel> GltfReader::read_channel(const JsonValue& v, const JsonValue& samplers)
{
    for (const char* key : {"target", "sampler"})
        if (!v.has(key)) v.fail(fmt::format("key '{}' is missing", key));
    const JsonValue target = v["target"], index = v["sampler"];
    if (!target.has("path")) target.fail("key 'path' is missing");
    const std::string& path = target["path"].string();
    const auto extensions = target.get("extensions");
    const auto extension = extensions ? extensions->get("KHR_animation_pointer") : std::nullopt;
    const auto pointer = extension && path == "pointer" ? extension->get("pointer") : std::nullopt;
    // Channels without a node may belong to an extension that this reader doesn't know.
    if (!pointer && !target.has("node")) return {};
    std::optional<AnimationChannel> channel = pointer ? channel_of_pointer(*pointer) : channel_of_path(target, path);
    if (!channel) return {};

    if (index.count() >= samplers.size())
        index.fail(fmt::format("there is no sampler {}: the animation has {}", index.count(), samplers.size()));
    const JsonValue sampler = samplers[index.count()];
    for (const char* key : {"input", "output"})
        if (!sampler.has(key)) sampler.fail(fmt::format("key '{}' is missing", key));
    channel->interpolation = interpolation_of(sampler);
    const JsonValue input_index = sampler["input"], output_index = sampler["output"];
    const Accessor input(file_, input_index), output(file_, output_index);
    if (input.components() != 1) input.fail(fmt::format("times with {} components", input.components()));
    file_.check_memory(v, 8.0 * double(input.count()) + 8.0 * double(output.count()) * output.components());
    channel->times.resize(input.count());
    input.read(0, input.count(), 1, 0, channel->times.data());
    channel->values.resize(output.count() * std::size_t(output.components()));
    output.read(0, output.count(), output.components(), 0, channel->values.data());
    if (pointer) scale_by_rest_value(pointer->string(), *channel);
    if (const std::string problem = problem_of(*channel); !problem.empty())
        (problem.starts_with("times") ? input : output).fail(problem);
    return channel;
}

Animation GltfReader::read_animation(const JsonValue& v)
{
    for (const char* key : {"channels", "samplers"})
        if (!v.has(key)) v.fail(fmt::format("key '{}' is missing", key));
    const JsonValue channels = v["channels"], samplers = v["samplers"];
    channels.array();
    samplers.array();
    Animation animation;
    double bytes = 0;
    for (std::size_t i = 0; i < channels.size(); ++i) {
        const JsonValue channel_value = channels[i];
        std::optional<AnimationChannel> channel = read_channel(channel_value, samplers);
        if (!channel) continue;
        bytes += 4.0 * double(channel->times.size() + channel->values.size());
        file_.check_memory(v, bytes);
        animation.channels.push_back(*std::move(channel));
    }
    return animation;
}

void GltfReader::read_animations()
{
    const JsonValue& animations = file_.list("animations");
    is_morphed_.assign(rig_.nodes.size(), false);
    may_hide_.assign(rig_.nodes.size(), false);
    for (std::size_t i = 0; i < animations.size(); ++i) {
        const JsonValue v = animations[i];
        Animation animation;
        // A still image doesn't need animations, so their errors are warnings.
        try {
            animation = read_animation(v);
        } catch (const Error& e) {
            animation.problem = fmt::format("{}: {}", e.place(), e.message());
            file_.warn(fmt::format("{} can't be played: {}", v.place(), animation.problem));
        }
        const auto name = v.get("name");
        animation.name = name && name->is_string() ? printable(name->string()) : std::to_string(i);
        for (const AnimationChannel& channel : animation.channels) {
            if (channel.value == AnimatedProperty::weights) is_morphed_[std::size_t(channel.target)] = true;
            if (channel.value == AnimatedProperty::visible) may_hide_[std::size_t(channel.target)] = true;
        }
        rig_.animations.push_back(std::move(animation));
    }
}

/// Replaces the file's indices of targets by those of the scene; channels of targets outside the scene are removed.
void GltfReader::find_targets()
{
    const std::vector<bool> reachable = reachable_nodes(scene_);
    for (Animation& animation : rig_.animations) {
        std::vector<AnimationChannel> found;
        const auto add = [&](const AnimationChannel& channel, int target) {
            found.push_back(channel);
            found.back().target = target;
        };
        for (const AnimationChannel& channel : animation.channels) {
            const auto file_index = std::size_t(channel.target);
            if (is_of_material(channel.value)) {
                for (const bool has_colors : {false, true})
                    if (const auto m = materials_.find({channel.target, has_colors}); m != materials_.end())
                        add(channel, m->second);
            } else if (is_of_light(channel.value)) {
                if (const auto l = lights_.find(file_index); l != lights_.end()) add(channel, l->second);
            } else if (channel.value == AnimatedProperty::fov_y || channel.value == AnimatedProperty::height) {
                const auto c = cameras_.find(file_index);
                for (std::size_t i = 0; c != cameras_.end() && i < rig_.nodes.size(); ++i)
                    if (scene_.nodes[i].camera == c->second) add(channel, int(i));
            } else {
                add(channel, channel.target);
            }
        }
        animation.channels = std::move(found);
    }
    for (std::size_t i = 0; i < may_hide_.size(); ++i) may_hide_[i] = may_hide_[i] && reachable[i];
}

void GltfReader::add_deformed(const Part& part, int mesh, std::size_t node, int skin)
{
    if (part.rest.positions.empty()) return;
    DeformedMesh d;
    d.mesh = mesh;
    d.rest = part.rest;
    d.targets = part.targets;
    d.weights = part.target_weights;
    d.node = int(node);
    d.skin = skin;
    if (skin >= 0) {
        d.joints = part.joints;
        d.joint_weights = part.weights;
    }
    rig_.meshes.push_back(std::move(d));
}

/// Registers the nodes whose visibility is animated, and hides those that are invisible at rest.
void GltfReader::hide_nodes()
{
    for (std::size_t i = 0; i < may_hide_.size(); ++i)
        if (may_hide_[i]) rig_.hiding.push_back({int(i), int(i), scene_.nodes[i]});
    if (rig_.hiding.empty()) return;
    for (const auto& [node, owner] : skinned_nodes_)
        rig_.hiding.push_back({node, owner, scene_.nodes[std::size_t(node)]});
    std::vector<bool> visible;
    visible.reserve(rig_.nodes.size());
    for (const NodeRestPose& node : rig_.nodes) visible.push_back(node.visible);
    for (const auto& [node, contents] : visible_contents(rig_, visible))
        set_contents(scene_.nodes[std::size_t(node)], contents);
}

}  // namespace fathom
