#pragma once
#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "formats/json/json_object.h"

namespace fathom {

class GltfFile;

/// The bytes of a view that EXT_meshopt_compression holds, by the library that the extension is the format of. Throws
/// Error naming `v` if they are damaged or more than there is memory for.
///
/// v  the extension's object; data: the compressed bytes
std::string decode_meshopt(const GltfFile& file, const JsonValue& v, std::span<const char> data);

/// What takes the place of an accessor's bytes: floats, or indices.
struct DecodedAccessor {
    std::size_t count = 0;
    int components = 0;
    std::vector<float> values;
    std::vector<std::uint32_t> indices;
};

/// The accessors of a primitive whose bytes are KHR_draco_mesh_compression's, by number. Throws Error naming the
/// primitive if they are damaged, or this program was built without the library.
std::map<std::size_t, DecodedAccessor> decode_draco(GltfFile& file, const JsonValue& primitive);

}  // namespace fathom
