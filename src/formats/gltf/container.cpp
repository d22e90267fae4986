// SPDX-License-Identifier: Apache-2.0
#include "formats/gltf/container.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <cstring>

#include "fathom/error.h"
#include "fathom/memory.h"
#include "formats/gltf/data_uri.h"
#include "formats/io/read_file.h"

namespace fathom {

namespace {

/// Extensions that this reader supports, at least approximately.
constexpr std::string_view known_extensions[] = {"KHR_materials_anisotropy",
                                                 "KHR_materials_clearcoat",
                                                 "KHR_materials_diffuse_transmission",
                                                 "KHR_materials_dispersion",
                                                 "KHR_materials_sheen",
                                                 "KHR_materials_iridescence",
                                                 "KHR_materials_specular",
                                                 "KHR_animation_pointer",
                                                 "KHR_lights_punctual",
                                                 "KHR_materials_emissive_strength",
                                                 "KHR_materials_ior",
                                                 "KHR_materials_pbrSpecularGlossiness",
                                                 "KHR_materials_transmission",
                                                 "KHR_materials_unlit",
                                                 "KHR_materials_variants",
                                                 "KHR_materials_volume",
                                                 "KHR_materials_volume_scatter",
                                                 "KHR_mesh_quantization",
                                                 "KHR_node_visibility",
                                                 "KHR_texture_transform",
                                                 "EXT_lights_image_based",
                                                 "EXT_mesh_gpu_instancing",
                                                 "EXT_texture_avif",
                                                 "EXT_texture_webp",
                                                 "EXT_meshopt_compression",
                                                 "KHR_meshopt_compression",
                                                 "KHR_draco_mesh_compression"};

/// Extensions that don't affect images, or whose textures are reported individually if they can't be read.
constexpr std::string_view harmless_extensions[] = {"KHR_texture_basisu", "KHR_xmp_json_ld", "KHR_xmp"};

template <std::size_t n>
bool contains(const std::string_view (&names)[n], std::string_view name)
{
    return std::find(std::begin(names), std::end(names), name) != std::end(names);
}

std::uint32_t little_endian_32(const char* p)
{
    const auto byte = [&](int i) { return std::uint32_t(static_cast<unsigned char>(p[i])); };
    return byte(0) | byte(1) << 8 | byte(2) << 16 | byte(3) << 24;
}

const Json empty_list = Json::array();

}  // namespace

GltfFile::GltfFile(std::filesystem::path file, const std::string& bytes, LoadContext& context)
    : file_(std::move(file)), name_(file_.string()), context_(context), root_(name_, json_, PlaceStyle::path)
{
    split(bytes);
    json_ = parse_json(name_, text_, DuplicateKeys::last_wins);
    root_.object();
    check_asset();
    check_extensions();
}

void GltfFile::split(const std::string& bytes)
{
    if (bytes.starts_with("glTF"))
        split_glb(bytes);
    else
        text_ = bytes;
}

void GltfFile::split_glb(const std::string& bytes)
{
    const auto fail = [&](const std::string& message) { throw Error(name_, "GLB header", message); };
    if (bytes.size() < 20) fail(fmt::format("the file ends after {} bytes", bytes.size()));
    const std::uint32_t version = little_endian_32(&bytes[4]), length = little_endian_32(&bytes[8]);
    if (version != 2) fail(fmt::format("version {} is not supported, only 2", version));
    if (length > bytes.size())
        fail(fmt::format("the file ends after {} bytes; its header says {}", bytes.size(), length));
    std::size_t at = 12;
    for (int chunk = 0; at + 8 <= length; ++chunk) {
        const std::size_t size = little_endian_32(&bytes[at]);
        const std::uint32_t type = little_endian_32(&bytes[at + 4]);
        if (size > length - at - 8)
            fail(fmt::format("chunk {} of {} bytes does not fit into the file's {}", chunk, size, length));
        const char* data = bytes.data() + at + 8;
        if (chunk == 0 && type != 0x4e4f534a) fail("the first chunk is not JSON");
        if (chunk == 0) text_ = {data, size};
        if (chunk == 1 && type == 0x004e4942) binary_chunk_ = std::span<const char>(data, size);
        at += 8 + size;
    }
    if (text_.empty()) fail("it contains no JSON");
}

void GltfFile::check_asset() const
{
    if (!root_.has("asset")) root_.fail("this is not glTF 2.0: 'asset' is missing");
    const JsonValue asset = root_["asset"];
    if (!asset.has("version")) asset.fail("key 'version' is missing");
    const JsonValue version = asset["version"];
    if (!version.string().starts_with("2."))
        version.fail(fmt::format("glTF {} is not supported, only 2.0", printable(version.string())));
    if (const auto least = asset.get("minVersion"))
        if (least->string() != "2.0")
            least->fail(fmt::format("the file requires glTF {}, only 2.0 is supported", printable(least->string())));
}

void GltfFile::check_extensions()
{
    const JsonValue& required = list("extensionsRequired");
    for (std::size_t i = 0; i < required.size(); ++i) {
        const std::string name = required[i].string();
        if (!contains(known_extensions, name) && !contains(harmless_extensions, name))
            required[i].fail(fmt::format("the file requires {}, which is not supported", printable(name)));
    }
    const JsonValue& used = list("extensionsUsed");
    for (std::size_t i = 0; i < used.size(); ++i) {
        const std::string name = used[i].string();
        if (!contains(known_extensions, name) && !contains(harmless_extensions, name))
            warn(fmt::format("extension {} is not supported and is ignored", printable(name)));
    }
}

const JsonValue& GltfFile::list(const std::string& key)
{
    if (const auto found = lists_.find(key); found != lists_.end()) return found->second;
    if (!root_.has(key)) return lists_.emplace(key, JsonValue(name_, empty_list, PlaceStyle::path)).first->second;
    return lists_.emplace(key, root_[key].array()).first->second;
}

JsonValue GltfFile::follow(const std::string& list_name, const JsonValue& index)
{
    const JsonValue& elements = list(list_name);
    const std::size_t i = index.count();
    if (i >= elements.size())
        index.fail(fmt::format("there is no {}[{}]: the file has {}", list_name, i, elements.size()));
    JsonValue element = elements[i];
    element.object();
    return element;
}

std::span<const char> GltfFile::buffer(const JsonValue& index)
{
    const JsonValue v = follow("buffers", index);
    const auto [found, is_new] = buffers_.try_emplace(index.count());
    Buffer& buffer = found->second;
    if (is_new) load_buffer(v, index.count() == 0, buffer.bytes, buffer.view);
    return buffer.view;
}

void GltfFile::load_buffer(const JsonValue& v, bool is_first, std::string& out, std::span<const char>& view)
{
    if (!v.has("byteLength")) v.fail("key 'byteLength' is missing");
    const std::size_t length = v["byteLength"].count();
    if (const auto uri = v.get("uri")) {
        const std::string& text = uri->string();
        if (is_data_uri(text)) {
            std::optional<std::string> bytes = decode_data_uri(text);
            if (!bytes) uri->fail("the data URI is damaged");
            out = *std::move(bytes);
        } else {
            if (text.find("://") != std::string::npos) uri->fail("only files and data URIs can be read");
            try {
                out = context_.read(file_.parent_path() / decode_percent(text));
            } catch (const Error& e) {
                uri->fail(fmt::format("'{}': {}", printable(text), e.message()));
            }
        }
        view = out;
    } else if (is_first && binary_chunk_) {
        view = *binary_chunk_;
    } else {
        v.fail("there is no data: neither a 'uri' nor a binary chunk");
    }
    if (view.size() < length) v.fail(fmt::format("expected {} bytes, found {}", length, view.size()));
    view = view.first(length);
}

/// The bytes of a buffer view, given by its JSON or by an extension's object with the same keys.
std::span<const char> GltfFile::bytes_of(const JsonValue& v)
{
    if (!v.has("buffer")) v.fail("key 'buffer' is missing");
    const std::span<const char> bytes = buffer(v["buffer"]);
    const std::size_t offset = v.has("byteOffset") ? v["byteOffset"].count() : 0;
    if (!v.has("byteLength")) v.fail("key 'byteLength' is missing");
    const std::size_t length = v["byteLength"].count();
    if (offset > bytes.size() || length > bytes.size() - offset)
        v.fail(fmt::format("bytes {} to {} are not in the buffer, which has {} bytes", offset, offset + length,
                           bytes.size()));
    return bytes.subspan(offset, length);
}

std::span<const char> GltfFile::unpack(std::size_t view, const JsonValue& extension)
{
    const auto [found, is_new] = unpacked_.try_emplace(view);
    if (is_new) found->second = decode_meshopt(*this, extension, bytes_of(extension));
    return found->second;
}

GltfFile::View GltfFile::buffer_view(const JsonValue& index)
{
    const JsonValue v = follow("bufferViews", index);
    View view;
    const auto extensions = v.get("extensions");
    for (const char* name : {"EXT_meshopt_compression", "KHR_meshopt_compression"})
        if (extensions && extensions->has(name)) view.bytes = unpack(index.count(), (*extensions)[name]);
    if (!view.bytes.data()) view.bytes = bytes_of(v);
    if (const auto stride = v.get("byteStride")) {
        view.stride = stride->count();
        if (view.stride < 1 || view.stride > 252) stride->fail(fmt::format("must be 4 to 252, found {}", view.stride));
    }
    return view;
}

void GltfFile::check_memory(const JsonValue& v, double bytes) const
{
    // Small requests skip the query of available memory.
    if (bytes < 1e6) return;
    if (bytes > double(available_memory_bytes()))
        v.fail(fmt::format("needs {:.1f} GB of memory, {}", bytes / 1e9, available_memory_text()));
}

void GltfFile::warn(const std::string& message, std::size_t times)
{
    context_.warnings.add(fmt::format("{}: {}", name_, message), times);
}

}  // namespace fathom
