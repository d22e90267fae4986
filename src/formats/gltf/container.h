// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "formats/common/load_context.h"
#include "formats/gltf/compression.h"
#include "formats/json/json_object.h"

namespace fathom {

/// The JSON of a glTF file and its buffers. Every reference is checked when it is followed.
class GltfFile {
public:
    /// Throws Error if the container is damaged, is not glTF 2, or requires an unknown extension. Warns of extensions
    /// that are used but unknown.
    ///
    /// bytes  content of the file; must outlive this object
    GltfFile(std::filesystem::path file, const std::string& bytes, LoadContext& context);
    GltfFile(const GltfFile&) = delete;
    GltfFile& operator=(const GltfFile&) = delete;

    const JsonValue& root() const { return root_; }
    /// One of the top-level arrays, such as `accessors`; empty if the file lacks it.
    const JsonValue& list(const std::string& name);
    /// The element of a list that an index in the file refers to. Throws Error if it doesn't exist.
    JsonValue follow(const std::string& list_name, const JsonValue& index);

    struct View {
        std::span<const char> bytes;
        std::size_t stride = 0;  ///< 0: elements are tightly packed
    };
    /// The bytes of a buffer view, decompressed if necessary. Throws Error if it is out of range.
    View buffer_view(const JsonValue& index);
    /// Replaces the contents of accessors by decompressed data.
    void add_decoded(std::map<std::size_t, DecodedAccessor> accessors) { decoded_.merge(accessors); }
    const DecodedAccessor* decoded(std::size_t accessor) const
    {
        const auto found = decoded_.find(accessor);
        return found == decoded_.end() ? nullptr : &found->second;
    }

    /// Adds a warning that names the file.
    void warn(const std::string& message, std::size_t times = 1);
    /// Throws Error naming `v` if it needs more memory than is available: a short file can demand much by referring to
    /// the same bytes many times.
    void check_memory(const JsonValue& v, double bytes) const;
    Warnings& warnings() { return context_.warnings; }
    MeshFaults& mesh_faults() { return context_.mesh_faults; }
    const std::filesystem::path& path() const { return file_; }
    const std::string& name() const { return name_; }

private:
    void split(const std::string& bytes);
    void split_glb(const std::string& bytes);
    void check_asset() const;
    void check_extensions();
    std::span<const char> buffer(const JsonValue& index);
    std::span<const char> bytes_of(const JsonValue& view);
    std::span<const char> unpack(std::size_t view, const JsonValue& extension);
    void load_buffer(const JsonValue& v, bool is_first, std::string& out, std::span<const char>& view);

    std::filesystem::path file_;
    std::string name_;
    LoadContext& context_;
    std::string_view text_;
    std::optional<std::span<const char>> binary_chunk_;
    Json json_;
    JsonValue root_;
    std::map<std::string, JsonValue> lists_;
    struct Buffer {
        std::string bytes;  ///< empty if `view` is the binary chunk
        std::span<const char> view;
    };
    std::map<std::size_t, Buffer> buffers_;
    std::map<std::size_t, std::string> unpacked_;  ///< decompressed buffer views, by view index
    std::map<std::size_t, DecodedAccessor> decoded_;
};

}  // namespace fathom
