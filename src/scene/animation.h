#pragma once
#include <array>
#include <string>
#include <utility>
#include <vector>

#include "fathom/animation.h"

namespace fathom {

/// How many numbers a key of it has.
std::size_t components(const AnimationChannel& channel);
/// What is wrong with its keys, in words; empty if nothing.
std::string problem_of(const AnimationChannel& channel);
/// A rotation is a unit quaternion.
std::vector<double> value_at(const AnimationChannel& channel, double time_s);

bool places_node(AnimatedValue value);
bool is_of_material(AnimatedValue value);
bool is_of_light(AnimatedValue value);

/// Values outside what there can be are brought to the nearest.
void set_number(Material& material, AnimatedValue value, const std::array<float, 4>& numbers);
void set_number(Light& light, AnimatedValue value, const std::array<float, 4>& numbers);
void set_number(Camera& camera, AnimatedValue value, const std::array<float, 4>& numbers);

/// Of a node that may vanish: what it places, and what hangs below it.
bool same_contents(const Node& a, const Node& b);
void set_contents(Node& node, const Node& contents);

/// Hides nodes: those that aren't visible, and the skins of what is below them.
///
/// visible  by node
std::vector<std::pair<int, Node>> contents_at(const AnimationRig& rig, const std::vector<bool>& visible);

}  // namespace fathom
