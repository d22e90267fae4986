// SPDX-License-Identifier: Apache-2.0
#include "dataset/truth_layers.h"

namespace fathom::cli {

namespace {

std::vector<float> to_floats(const std::vector<Vec3f>& vectors)
{
    std::vector<float> numbers;
    numbers.reserve(3 * vectors.size());
    for (const Vec3f& v : vectors) numbers.insert(numbers.end(), {v.x, v.y, v.z});
    return numbers;
}

/// Ids below 2^24 are exact as floats.
std::vector<float> to_floats(const std::vector<std::uint32_t>& ids)
{
    return {ids.begin(), ids.end()};
}

Image::Layer truth_layer(const GroundTruth& truth, TruthLayer layer)
{
    switch (layer) {
        case TruthLayer::depth:
            return {"truth.depth", {"Z"}, truth.depth};
        case TruthLayer::distance:
            return {"truth.distance", {"Z"}, truth.distance};
        case TruthLayer::normal:
            return {"truth.normal", {"X", "Y", "Z"}, to_floats(truth.normal)};
        case TruthLayer::camera_normal:
            return {"truth.camera-normal", {"X", "Y", "Z"}, to_floats(truth.camera_normal)};
        case TruthLayer::position:
            return {"truth.position", {"X", "Y", "Z"}, to_floats(truth.position)};
        case TruthLayer::instance:
            return {"truth.instance", {"ID"}, to_floats(truth.instance)};
        case TruthLayer::material:
            return {"truth.material", {"ID"}, to_floats(truth.material)};
        case TruthLayer::flow:
            break;
    }
    return {};
}

}  // namespace

std::vector<Image::Layer> truth_layers(const GroundTruth& truth, const std::vector<TruthLayer>& wanted)
{
    std::vector<Image::Layer> layers;
    for (const TruthLayer layer : wanted)
        if (layer != TruthLayer::flow) layers.push_back(truth_layer(truth, layer));
    return layers;
}

Image::Layer flow_layer(const char* name, const std::vector<Vec2f>& flow)
{
    Image::Layer layer{name, {"X", "Y"}, {}};
    layer.pixels.reserve(2 * flow.size());
    for (const Vec2f& v : flow) layer.pixels.insert(layer.pixels.end(), {v.x, v.y});
    return layer;
}

}  // namespace fathom::cli
