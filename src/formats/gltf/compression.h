// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "formats/json/json_object.h"

namespace fathom {

class GltfFile;

/// Decompresses a buffer view of EXT_meshopt_compression with the meshoptimizer library. Throws Error naming `v` if the
/// data is damaged or memory doesn't suffice.
///
/// v     the extension's JSON object
/// data  the compressed bytes
std::string decode_meshopt(const GltfFile& file, const JsonValue& v, std::span<const char> data);

/// Decompressed contents of an accessor: floats or indices.
struct DecodedAccessor {
    std::size_t count = 0;
    int components = 0;
    std::vector<float> values;
    std::vector<std::uint32_t> indices;
};

/// Decompresses a primitive of KHR_draco_mesh_compression; returns its accessors by index. Throws Error naming the
/// primitive if the data is damaged, or if the program was built without Draco.
std::map<std::size_t, DecodedAccessor> decode_draco(GltfFile& file, const JsonValue& primitive);

}  // namespace fathom
