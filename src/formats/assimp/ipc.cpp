// SPDX-License-Identifier: Apache-2.0
#include "formats/assimp/ipc.h"

#include <cstring>
#include <type_traits>

#include "scene/material_table.h"

namespace fathom {

namespace {

class Writer {
public:
    template <class T>
        requires std::is_trivially_copyable_v<T>
    void field(const T& value)
    {
        raw(&value, sizeof value);
    }
    void field(const std::string& text)
    {
        field(text.size());
        raw(text.data(), text.size());
    }
    void field(const std::filesystem::path& path) { field(path.string()); }
    template <class T>
    void field(const std::vector<T>& values);
    template <class T>
        requires(!std::is_trivially_copyable_v<T>)
    void field(const T& value);

    std::string bytes;

private:
    void raw(const void* data, std::size_t size) { bytes.append(static_cast<const char*>(data), size); }
};

class Reader {
public:
    explicit Reader(const std::string& bytes) : at_(bytes.data()), left_(bytes.size()) {}

    template <class T>
        requires std::is_trivially_copyable_v<T>
    void field(T& value)
    {
        raw(&value, sizeof value);
    }
    void field(std::string& text)
    {
        text.resize(length(1));
        raw(text.data(), text.size());
    }
    void field(std::filesystem::path& path)
    {
        std::string text;
        field(text);
        path = text;
    }
    template <class T>
    void field(std::vector<T>& values);
    template <class T>
        requires(!std::is_trivially_copyable_v<T>)
    void field(T& value);

    bool is_good = true;

private:
    friend Writer;
    std::size_t length(std::size_t element_size)
    {
        std::size_t n = 0;
        field(n);
        if (n > left_ / element_size) is_good = false;
        return is_good ? n : 0;
    }
    void raw(void* data, std::size_t size)
    {
        if (size > left_) is_good = false;
        if (!is_good || size == 0) return;
        std::memcpy(data, at_, size);
        at_ += size;
        left_ -= size;
    }
    const char* at_;
    std::size_t left_;
};

/// Lists the members of each type once, for both serialization and deserialization.
template <class Archive, class T>
void members(Archive& a, T& x)
{
    const auto all = [&](auto&... fields) { (a.field(fields), ...); };
    using Type = std::remove_const_t<T>;
    if constexpr (std::is_same_v<Type, ImageFile>) {
        all(x.name, x.path, x.bytes);
    } else if constexpr (std::is_same_v<Type, Texture>) {
        all(x.name, x.kind, x.image, x.color_space, x.wrap_u, x.wrap_v, x.nearest, x.uv_set, x.uv_offset, x.uv_scale,
            x.uv_rotation);
    } else if constexpr (std::is_same_v<Type, Material>) {
        all(x.name, x.kind);
        for (const Parameter<Material>& p : material_parameters())
            std::visit([&](auto member) { a.field(member(x)); }, p.member);
    } else if constexpr (std::is_same_v<Type, Mesh>) {
        all(x.name, x.positions, x.normals, x.tangents, x.uvs[0], x.uvs[1], x.colors, x.indices);
    } else if constexpr (std::is_same_v<Type, Shape>) {
        all(x.geometry, x.material, x.name);
    } else if constexpr (std::is_same_v<Type, Light>) {
        all(x.name, x.kind, x.intensity, x.inner_angle, x.outer_angle, x.angle);
    } else if constexpr (std::is_same_v<Type, Camera>) {
        all(x.name, x.kind, x.position, x.look_at, x.up, x.fov_y, x.height, x.aspect);
    } else if constexpr (std::is_same_v<Type, Node>) {
        all(x.name, x.parent_from_node, x.children, x.shapes, x.light, x.camera);
    } else if constexpr (std::is_same_v<Type, SceneDescription>) {
        all(x.files, x.images, x.textures, x.materials, x.meshes, x.lights, x.cameras, x.nodes, x.roots);
    } else {
        static_assert(std::is_same_v<Type, AssimpAnswer>);
        all(x.scene, x.error, x.warnings);
    }
}

template <class T>
void Writer::field(const std::vector<T>& values)
{
    field(values.size());
    if constexpr (std::is_trivially_copyable_v<T>)
        raw(values.data(), values.size() * sizeof(T));
    else
        for (const T& value : values) field(value);
}

template <class T>
    requires(!std::is_trivially_copyable_v<T>)
void Writer::field(const T& value)
{
    members(*this, value);
}

template <class T>
void Reader::field(std::vector<T>& values)
{
    if constexpr (std::is_trivially_copyable_v<T>) {
        values.resize(length(sizeof(T)));
        raw(values.data(), values.size() * sizeof(T));
    } else {
        values.resize(length(1));
        for (T& value : values) field(value);
    }
}

template <class T>
    requires(!std::is_trivially_copyable_v<T>)
void Reader::field(T& value)
{
    members(*this, value);
}

}  // namespace

std::string to_bytes(const AssimpAnswer& answer)
{
    Writer writer;
    members(writer, answer);
    return std::move(writer.bytes);
}

bool from_bytes(const std::string& bytes, AssimpAnswer& answer)
{
    Reader reader(bytes);
    members(reader, answer);
    return reader.is_good;
}

}  // namespace fathom
