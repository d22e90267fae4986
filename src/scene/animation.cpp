// SPDX-License-Identifier: Apache-2.0
#include "fathom/animation.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "scene/animation.h"
#include "scene/motion.h"

namespace fathom {

namespace {

std::array<double, 4> unit(std::array<double, 4> q)
{
    double square = 0;
    for (const double x : q) square += x * x;
    // A zero quaternion is treated as the identity.
    if (!(square > 0)) return {0, 0, 0, 1};
    for (double& x : q) x /= std::sqrt(square);
    return q;
}

std::array<double, 4> quaternion(const float* values)
{
    return unit({values[0], values[1], values[2], values[3]});
}

/// Number of components of a channel's value; 0 if any number is valid.
std::size_t expected_components(AnimatedProperty value)
{
    switch (value) {
        case AnimatedProperty::translation:
        case AnimatedProperty::scale:
        case AnimatedProperty::emission:
        case AnimatedProperty::intensity:
            return 3;
        case AnimatedProperty::rotation:
        case AnimatedProperty::base_color:
            return 4;
        case AnimatedProperty::weights:
            return 0;
        default:
            return 1;
    }
}

}  // namespace

double Animation::duration() const
{
    double end = 0;
    for (const AnimationChannel& channel : channels)
        if (!channel.times.empty()) end = std::max(end, double(channel.times.back()));
    return end;
}

std::size_t components(const AnimationChannel& channel)
{
    return channel.values.size() / channel.times.size() / (channel.interpolation == Interpolation::cubic ? 3 : 1);
}

std::string problem_of(const AnimationChannel& channel)
{
    const std::size_t keys = channel.times.size(), parts = channel.interpolation == Interpolation::cubic ? 3 : 1;
    if (keys == 0) return "there are no keys";
    for (std::size_t i = 0; i < keys; ++i)
        if (!std::isfinite(channel.times[i]) || (i > 0 && !(channel.times[i] > channel.times[i - 1])))
            return fmt::format("times must be finite and increase: {} is the time of key {}", channel.times[i], i);
    if (!std::all_of(channel.values.begin(), channel.values.end(), [](float x) { return std::isfinite(x); }))
        return "a value is not finite";
    const std::size_t expected = expected_components(channel.value), each = expected > 0 ? expected : 1;
    const bool fits = expected > 0 ? channel.values.size() == keys * parts * each
                                   : !channel.values.empty() && channel.values.size() % (keys * parts) == 0;
    if (!fits)
        return fmt::format("{} numbers are not {} for each of {} keys", channel.values.size(),
                           expected > 0 ? fmt::format("{}", parts * each) : "as many", keys);
    return {};
}

std::vector<double> value_at(const AnimationChannel& channel, double time_s)
{
    const std::size_t n = components(channel), parts = channel.interpolation == Interpolation::cubic ? 3 : 1;
    /// part  part of a cubic key: 0 in-tangent, 1 value, 2 out-tangent
    const auto key = [&](std::size_t i, std::size_t part) {
        return channel.values.data() + (i * parts + (parts == 3 ? part : 0)) * n;
    };
    const auto& times = channel.times;
    const bool rotates = channel.value == AnimatedProperty::rotation;
    const auto next = std::upper_bound(times.begin(), times.end(), time_s);
    const std::size_t a = std::size_t(next - times.begin()) - (next == times.begin() ? 0 : 1), b = a + 1;
    std::vector<double> value(key(a, 1), key(a, 1) + n);
    const bool stands = next == times.begin() || next == times.end() || channel.interpolation == Interpolation::step;
    const double dt = stands ? 1 : double(times[b]) - double(times[a]);
    const double u = stands ? 0 : (time_s - double(times[a])) / dt;
    if (u > 0 && rotates && channel.interpolation == Interpolation::linear) {
        const std::array<double, 4> q = slerp(quaternion(key(a, 1)), quaternion(key(b, 1)), u);
        value.assign(q.begin(), q.end());
    } else if (u > 0 && channel.interpolation == Interpolation::linear) {
        for (std::size_t k = 0; k < n; ++k) value[k] = (1 - u) * double(key(a, 1)[k]) + u * double(key(b, 1)[k]);
    } else if (u > 0) {
        const double u2 = u * u, u3 = u2 * u;
        for (std::size_t k = 0; k < n; ++k)
            value[k] = (2 * u3 - 3 * u2 + 1) * double(key(a, 1)[k]) + dt * (u3 - 2 * u2 + u) * double(key(a, 2)[k]) +
                       (3 * u2 - 2 * u3) * double(key(b, 1)[k]) + dt * (u3 - u2) * double(key(b, 0)[k]);
    }
    if (rotates) {
        const std::array<double, 4> q = unit({value[0], value[1], value[2], value[3]});
        value.assign(q.begin(), q.end());
    }
    return value;
}

bool is_node_transform(AnimatedProperty value)
{
    return value == AnimatedProperty::translation || value == AnimatedProperty::rotation ||
           value == AnimatedProperty::scale;
}

bool is_of_material(AnimatedProperty value)
{
    return value >= AnimatedProperty::base_color && value <= AnimatedProperty::normal_scale;
}

bool is_of_light(AnimatedProperty value)
{
    return value >= AnimatedProperty::intensity && value <= AnimatedProperty::outer_angle;
}

void set_number(Material& m, AnimatedProperty value, const std::array<float, 4>& v)
{
    const auto share = [](float x) { return std::clamp(x, 0.0f, 1.0f); };
    switch (value) {
        case AnimatedProperty::base_color:
            m.base_color.value = {share(v[0]), share(v[1]), share(v[2])};
            // The base color tints transmitted light.
            if (m.kind == MaterialKind::glass || m.transmission.weight.value > 0)
                m.transmission.color.value = m.base_color.value;
            if (m.opacity.mode != AlphaMode::opaque) m.opacity.alpha.value = share(v[3]);
            break;
        case AnimatedProperty::metallic:
            m.metallic.value = share(v[0]);
            break;
        case AnimatedProperty::roughness:
            m.roughness.value = share(v[0]);
            break;
        case AnimatedProperty::emission:
            m.emission.radiance.value = {std::max(0.0f, v[0]), std::max(0.0f, v[1]), std::max(0.0f, v[2])};
            break;
        case AnimatedProperty::alpha_cutoff:
            m.opacity.cutoff = v[0];
            break;
        default:
            m.normal_map.scale = v[0];
    }
}

void set_number(Light& light, AnimatedProperty value, const std::array<float, 4>& v)
{
    constexpr double half_pi = 1.5707963267948966;
    switch (value) {
        case AnimatedProperty::intensity:
            light.intensity = {std::max(0.0f, v[0]), std::max(0.0f, v[1]), std::max(0.0f, v[2])};
            break;
        case AnimatedProperty::inner_angle:
            light.inner_angle = std::clamp(double(v[0]), 0.0, light.outer_angle);
            break;
        default:
            light.outer_angle = std::clamp(double(v[0]), std::max(1e-4, light.inner_angle), half_pi);
    }
}

void set_number(Camera& camera, AnimatedProperty value, const std::array<float, 4>& v)
{
    constexpr double least = 1e-3, most = 3.14;
    if (value == AnimatedProperty::fov_y)
        camera.fov_y = std::clamp(double(v[0]), least, most);
    else
        camera.height = std::max(1e-9, 2 * std::abs(double(v[0])));
}

bool same_contents(const Node& a, const Node& b)
{
    return a.children == b.children && a.shapes.size() == b.shapes.size() && a.light == b.light && a.camera == b.camera;
}

void set_contents(Node& node, const Node& contents)
{
    node.children = contents.children;
    node.shapes = contents.shapes;
    node.light = contents.light;
    node.camera = contents.camera;
}

void set_pose(SceneDescription& scene, AnimationPose pose)
{
    for (auto& [node, transform] : pose.nodes) scene.nodes.at(std::size_t(node)).parent_from_node = transform;
    for (auto& [node, keys] : pose.motions) scene.nodes.at(std::size_t(node)).motion = std::move(keys);
    for (AnimationPose::Vertices& v : pose.meshes) {
        Mesh& mesh = scene.meshes.at(std::size_t(v.mesh));
        mesh.positions = std::move(v.positions);
        mesh.normals = std::move(v.normals);
        mesh.tangents = std::move(v.tangents);
        mesh.motion = std::move(v.motion);
        if (!v.colors.empty()) mesh.colors = std::move(v.colors);
        for (std::size_t set = 0; set < 2; ++set)
            if (!v.uvs[set].empty()) mesh.uvs[set] = std::move(v.uvs[set]);
    }
    for (const AnimationPose::ParameterValue& n : pose.numbers) {
        const auto target = std::size_t(n.target);
        if (is_of_material(n.value))
            set_number(scene.materials.at(target), n.value, n.numbers);
        else if (is_of_light(n.value))
            set_number(scene.lights.at(target), n.value, n.numbers);
        else if (const int camera = scene.nodes.at(target).camera; camera >= 0)
            set_number(scene.cameras.at(std::size_t(camera)), n.value, n.numbers);
    }
    for (const auto& [node, contents] : pose.contents) set_contents(scene.nodes.at(std::size_t(node)), contents);
}

}  // namespace fathom
