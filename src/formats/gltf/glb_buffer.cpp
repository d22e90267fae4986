// SPDX-License-Identifier: Apache-2.0
#include "formats/gltf/glb_buffer.h"

#include <algorithm>
#include <bit>

#include "fathom/error.h"

namespace fathom {

static_assert(std::endian::native == std::endian::little);

namespace {

constexpr int type_float = 5126, type_uint = 5125;
/// GLB files are limited to 4 GiB, of which 256 MiB are left for JSON.
constexpr std::size_t largest = (std::size_t(1) << 32) - (std::size_t(1) << 28);

}  // namespace

int GlbBuffer::add_view(const void* bytes, std::size_t size, Use use)
{
    if (size > largest - bytes_.size())
        throw Error("", "", "the scene does not fit into a GLB file, which holds at most 4 GB");
    Json view = {{"buffer", 0}, {"byteOffset", bytes_.size()}, {"byteLength", size}};
    if (use != Use::anything) view["target"] = int(use);
    bytes_.append(static_cast<const char*>(bytes), size);
    bytes_.resize((bytes_.size() + 3) / 4 * 4);
    views_.push_back(std::move(view));
    return int(views_.size()) - 1;
}

int GlbBuffer::add_vertices(const float* values, std::size_t count, int components, bool with_bounds)
{
    const std::size_t n = std::size_t(components);
    Json accessor = {{"bufferView", add_view(values, count * n * sizeof(float), Use::vertices)},
                     {"componentType", type_float},
                     {"count", count},
                     {"type", "VEC" + std::to_string(components)}};
    for (std::size_t c = 0; with_bounds && c < n; ++c) {
        float least = values[c], most = values[c];
        for (std::size_t i = 1; i < count; ++i) {
            least = std::min(least, values[i * n + c]);
            most = std::max(most, values[i * n + c]);
        }
        accessor["min"].push_back(number_json(least));
        accessor["max"].push_back(number_json(most));
    }
    accessors_.push_back(std::move(accessor));
    return int(accessors_.size()) - 1;
}

int GlbBuffer::add_indices(const std::vector<std::uint32_t>& indices)
{
    accessors_.push_back(
        {{"bufferView", add_view(indices.data(), indices.size() * sizeof(std::uint32_t), Use::indices)},
         {"componentType", type_uint},
         {"count", indices.size()},
         {"type", "SCALAR"}});
    return int(accessors_.size()) - 1;
}

}  // namespace fathom
