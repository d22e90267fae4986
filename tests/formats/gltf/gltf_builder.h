// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

#include <fmt/format.h>

namespace fathom::test {

/// Assembles small glTF files: all bytes go into one buffer (a data URI), with a buffer view for each piece.
class GltfBuilder {
public:
    template <class T>
    int view(const std::vector<T>& values, int stride = 0)
    {
        while (bytes_.size() % 4 != 0) bytes_ += '\0';
        const std::size_t offset = bytes_.size();
        bytes_.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T));
        views_.push_back(fmt::format(R"({{"buffer": 0, "byteOffset": {}, "byteLength": {}{}}})", offset,
                                     values.size() * sizeof(T),
                                     stride ? fmt::format(R"(, "byteStride": {})", stride) : ""));
        return int(views_.size()) - 1;
    }
    /// Buffer view of compressed bytes under an extension's name, with the unpacked size.
    int packed_view(const std::string& packed, std::size_t unpacked_bytes, const std::string& extension,
                    const std::string& members, int stride = 0)
    {
        const int plain = view(std::vector<char>(packed.begin(), packed.end()));
        std::string inner = views_[std::size_t(plain)];
        inner.insert(inner.size() - 1, ", " + members);
        views_[std::size_t(plain)] =
            fmt::format(R"({{"buffer": 0, "byteLength": {}{}, "extensions": {{"{}": {}}}}})", unpacked_bytes,
                        stride ? fmt::format(R"(, "byteStride": {})", stride) : "", extension, inner);
        return plain;
    }
    int accessor(int view, int component_type, std::size_t count, const std::string& type, const std::string& more = "")
    {
        accessors_.push_back(fmt::format(R"({{{}"componentType": {}, "count": {}, "type": "{}"{}}})",
                                         view >= 0 ? fmt::format(R"("bufferView": {}, )", view) : "", component_type,
                                         count, type, more.empty() ? "" : ", " + more));
        return int(accessors_.size()) - 1;
    }
    int floats(const std::vector<float>& values, const std::string& type)
    {
        const std::size_t components = type == "VEC2"   ? 2
                                       : type == "VEC3" ? 3
                                       : type == "VEC4" ? 4
                                       : type == "MAT4" ? 16
                                                        : 1;
        return accessor(view(values), 5126, values.size() / components, type);
    }
    /// A right triangle with legs of length 1 in the xy plane.
    int triangle() { return floats({0, 0, 0, 1, 0, 0, 0, 1, 0}, "VEC3"); }

    /// The whole file: the given members plus accessors, buffer views and buffer.
    std::string gltf(const std::string& members) const
    {
        return fmt::format(
            R"({{"asset": {{"version": "2.0"}}, {}{}"accessors": [{}], "bufferViews": [{}], "buffers": [{{"byteLength": {},
                "uri": "data:application/octet-stream;base64,{}"}}]}})",
            members, members.empty() ? "" : ", ", fmt::join(accessors_, ", "), fmt::join(views_, ", "), bytes_.size(),
            base64());
    }
    /// A file with one node and one mesh with one primitive.
    std::string one_primitive(const std::string& primitive, const std::string& members = "") const
    {
        return gltf(R"("scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}], "meshes": [{"primitives": [{)" + primitive +
                    "}]}]" + (members.empty() ? "" : ", " + members));
    }

private:
    std::string base64() const
    {
        static const char letters[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
        std::string text;
        for (std::size_t i = 0; i < bytes_.size(); i += 3) {
            std::uint32_t bits = 0;
            for (std::size_t k = 0; k < 3; ++k)
                bits = bits << 8 | (i + k < bytes_.size() ? static_cast<unsigned char>(bytes_[i + k]) : 0u);
            for (std::size_t k = 0; k < 4; ++k)
                text += i + k <= bytes_.size() ? letters[bits >> (18 - 6 * k) & 63] : '=';
        }
        return text;
    }
    std::string bytes_;
    std::vector<std::string> views_, accessors_;
};

}  // namespace fathom::test
