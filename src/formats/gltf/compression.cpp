// SPDX-License-Identifier: Apache-2.0
#include "formats/gltf/compression.h"

#include <fmt/format.h>

#include <algorithm>

#include "formats/gltf/container.h"
#include "formats/io/read_file.h"

#if FATHOM_MESHOPT
#include <meshoptimizer.h>
#endif
#if FATHOM_DRACO
#include <draco/compression/decode.h>
#endif

namespace fathom {

#if FATHOM_MESHOPT
namespace {

void apply_filter(const JsonValue& filter, std::string& bytes, std::size_t count, std::size_t stride)
{
    const std::string& name = filter.string();
    const auto needs = [&](bool fits) {
        if (!fits) filter.fail(fmt::format("{} can't be applied to elements of {} bytes", printable(name), stride));
    };
    if (name == "OCTAHEDRAL") {
        needs(stride == 4 || stride == 8);
        meshopt_decodeFilterOct(bytes.data(), count, stride);
    } else if (name == "QUATERNION") {
        needs(stride == 8);
        meshopt_decodeFilterQuat(bytes.data(), count, stride);
    } else if (name == "EXPONENTIAL") {
        needs(stride % 4 == 0);
        meshopt_decodeFilterExp(bytes.data(), count, stride);
    } else if (name != "NONE") {
        filter.fail(fmt::format("'{}' is not one of NONE, OCTAHEDRAL, QUATERNION, EXPONENTIAL", printable(name)));
    }
}

}  // namespace

std::string decode_meshopt(const GltfFile& file, const JsonValue& v, std::span<const char> data)
{
    for (const char* key : {"byteStride", "count", "mode"})
        if (!v.has(key)) v.fail(fmt::format("key '{}' is missing", key));
    const std::size_t count = v["count"].count(), stride = v["byteStride"].count();
    const std::string& mode = v["mode"].string();
    if (count == 0) v["count"].fail("must be at least 1");
    if (stride == 0 || stride > 256) v["byteStride"].fail(fmt::format("must be 1 to 256, found {}", stride));
    file.check_memory(v, double(count) * double(stride));
    std::string bytes(count * stride, '\0');
    const auto* in = reinterpret_cast<const unsigned char*>(data.data());
    int error = 0;
    if (mode == "ATTRIBUTES") {
        if (stride % 4 != 0) v["byteStride"].fail(fmt::format("must be a multiple of 4, found {}", stride));
        error = meshopt_decodeVertexBuffer(bytes.data(), count, stride, in, data.size());
    } else if (mode == "TRIANGLES" || mode == "INDICES") {
        if (stride != 2 && stride != 4) v["byteStride"].fail(fmt::format("must be 2 or 4, found {}", stride));
        if (mode == "TRIANGLES" && count % 3 != 0) v["count"].fail(fmt::format("{} is not a multiple of 3", count));
        error = mode == "TRIANGLES" ? meshopt_decodeIndexBuffer(bytes.data(), count, stride, in, data.size())
                                    : meshopt_decodeIndexSequence(bytes.data(), count, stride, in, data.size());
    } else {
        v["mode"].fail(fmt::format("'{}' is not one of ATTRIBUTES, TRIANGLES, INDICES", printable(mode)));
    }
    if (error != 0) v.fail("the compressed data is damaged");
    if (const auto filter = v.get("filter"); filter && mode == "ATTRIBUTES")
        apply_filter(*filter, bytes, count, stride);
    return bytes;
}
#else
std::string decode_meshopt(const GltfFile&, const JsonValue& v, std::span<const char>)
{
    v.fail("EXT_meshopt_compression: this program was built without meshoptimizer (libmeshoptimizer-dev)");
}
#endif

#if FATHOM_DRACO
namespace {

DecodedAccessor read_attribute(const draco::PointAttribute& attribute, std::size_t points, const JsonValue& place)
{
    const int components = attribute.num_components();
    if (components < 1 || components > 4) place.fail(fmt::format("the attribute has {} components", components));
    DecodedAccessor out{points, components, {}, {}};
    out.values.resize(points * std::size_t(components));
    for (std::size_t i = 0; i < points; ++i) {
        const draco::AttributeValueIndex value = attribute.mapped_index(draco::PointIndex(std::uint32_t(i)));
        if (value.value() >= attribute.size() ||
            !attribute.ConvertValue<float>(value, std::int8_t(components), &out.values[i * std::size_t(components)]))
            place.fail("the compressed data is damaged");
    }
    return out;
}

}  // namespace

std::map<std::size_t, DecodedAccessor> decode_draco(GltfFile& file, const JsonValue& primitive)
{
    const JsonValue extensions = primitive["extensions"], v = extensions["KHR_draco_mesh_compression"];
    for (const char* key : {"bufferView", "attributes"})
        if (!v.has(key)) v.fail(fmt::format("key '{}' is missing", key));
    const std::span<const char> bytes = file.buffer_view(v["bufferView"]).bytes;
    // Memory for the promised counts is checked before decompression, because a few bytes can demand much.
    const JsonValue attributes = primitive["attributes"];
    double most = 0;
    for (const auto& [name, number] : attributes.json().items()) {
        const JsonValue accessor = file.follow("accessors", attributes[name]);
        if (!accessor.has("count")) accessor.fail("key 'count' is missing");
        most = std::max(most, double(accessor["count"].count()));
    }
    file.check_memory(v, 100 * most);
    draco::DecoderBuffer buffer;
    buffer.Init(bytes.data(), bytes.size());
    draco::Decoder decoder;
    auto decoded = decoder.DecodeMeshFromBuffer(&buffer);
    if (!decoded.ok())
        v.fail(fmt::format("the compressed data is damaged: {}", printable(decoded.status().error_msg_string())));
    const draco::Mesh& mesh = *decoded.value();
    std::map<std::size_t, DecodedAccessor> accessors;
    const JsonValue ids = v["attributes"];
    ids.object();
    for (const auto& [name, number] : ids.json().items()) {
        if (!attributes.has(name)) continue;
        const JsonValue id = ids[name];
        const draco::PointAttribute* attribute = mesh.GetAttributeByUniqueId(std::uint32_t(id.count()));
        if (!attribute) id.fail("the compressed data has no attribute with this id");
        accessors[attributes[name].count()] = read_attribute(*attribute, mesh.num_points(), id);
    }
    if (const auto index = primitive.get("indices")) {
        DecodedAccessor out{3 * std::size_t(mesh.num_faces()), 1, {}, {}};
        for (std::uint32_t i = 0; i < mesh.num_faces(); ++i)
            for (const draco::PointIndex corner : mesh.face(draco::FaceIndex(i))) out.indices.push_back(corner.value());
        accessors[index->count()] = std::move(out);
    }
    return accessors;
}
#else
std::map<std::size_t, DecodedAccessor> decode_draco(GltfFile&, const JsonValue& primitive)
{
    primitive.fail("KHR_draco_mesh_compression: this program was built without Draco (libdraco-dev)");
}
#endif

}  // namespace fathom
