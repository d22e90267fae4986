// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <string>
#include <utility>
#include <vector>

#include "fathom/animation.h"

namespace fathom {

/// Number of components of a key's value.
std::size_t components(const AnimationChannel& channel);
/// Describes what is wrong with the channel's keys; empty if nothing is.
std::string problem_of(const AnimationChannel& channel);
/// The channel's value at a time, interpolated between keys; a rotation is a unit quaternion.
std::vector<double> value_at(const AnimationChannel& channel, double time_s);

/// Whether the value is a translation, rotation or scale of a node.
bool is_node_transform(AnimatedProperty value);
/// Whether the value is a parameter of a material.
bool is_of_material(AnimatedProperty value);
/// Whether the value is a parameter of a light.
bool is_of_light(AnimatedProperty value);

/// Sets an animated parameter; values outside its range are clamped.
void set_number(Material& material, AnimatedProperty value, const std::array<float, 4>& numbers);
void set_number(Light& light, AnimatedProperty value, const std::array<float, 4>& numbers);
void set_number(Camera& camera, AnimatedProperty value, const std::array<float, 4>& numbers);

/// Whether two nodes have the same shapes, lights, camera and children.
bool same_contents(const Node& a, const Node& b);
/// Copies shapes, light, camera and children, but not the transform.
void set_contents(Node& node, const Node& contents);

/// Contents of the nodes that the rig can hide: empty if the node that owns them, or a node above it, is invisible.
///
/// visible  one entry per node of the rig
std::vector<std::pair<int, Node>> visible_contents(const AnimationRig& rig, const std::vector<bool>& visible);

}  // namespace fathom
