// SPDX-License-Identifier: Apache-2.0
#include "formats/stl/stl.h"

#include <algorithm>
#include <bit>
#include <cctype>
#include <cstring>

#include "formats/io/text_encoding.h"
#include "formats/io/text_scanner.h"
#include "formats/mesh/mesh_cleanup.h"
#include "formats/mesh/vertex_index.h"

namespace fathom {

namespace {

constexpr std::size_t header_size = 84, triangle_size = 50;

bool equals(std::string_view word, std::string_view lower)
{
    return std::equal(word.begin(), word.end(), lower.begin(), lower.end(),
                      [](unsigned char a, char b) { return std::tolower(a) == b; });
}

/// First word of the file, after a byte order mark and whitespace.
std::string_view first_word(std::string_view bytes)
{
    if (bytes.starts_with("\xef\xbb\xbf")) bytes.remove_prefix(3);
    bytes.remove_prefix(std::min(bytes.find_first_not_of(" \t\r\n\v\f"), bytes.size()));
    return bytes.substr(0, bytes.find_first_of(" \t\r\n\v\f"));
}

/// Whether the beginning contains control characters, as binary files do.
bool has_control_characters(std::string_view bytes)
{
    const std::string_view start = bytes.substr(0, 4096);
    return std::any_of(start.begin(), start.end(),
                       [](unsigned char c) { return c == 127 || (c < 32 && (c < '\t' || c > '\r')); });
}

/// Whether a text continues with facets or ends the solid.
bool has_facets(std::string_view text)
{
    std::string lower(text.substr(0, 4096));
    std::transform(lower.begin(), lower.end(), lower.begin(), [](unsigned char c) { return char(std::tolower(c)); });
    return lower.find("facet") != std::string::npos || lower.find("endsolid") != std::string::npos;
}

class StlReader {
public:
    StlReader(std::string name, Warnings& warnings) : name_(std::move(name)), warnings_(warnings) {}

    Mesh read(const std::string& bytes)
    {
        if (is_binary(bytes))
            read_binary(bytes);
        else
            read_ascii(bytes);
        return std::move(mesh_);
    }

private:
    static std::size_t promised_triangles(std::string_view bytes)
    {
        std::uint32_t promised = 0;
        if (bytes.size() >= header_size) std::memcpy(&promised, bytes.data() + 80, 4);
        return promised;
    }
    /// Many binary files begin with "solid" too. They are recognized by their size or, if data follows the last
    /// triangle, by control characters.
    bool is_binary(std::string_view bytes) const
    {
        const std::size_t body = triangle_size * promised_triangles(bytes);
        const bool has_room = bytes.size() >= header_size && bytes.size() - header_size >= body;
        if (has_room && bytes.size() - header_size == body) return true;
        if (equals(first_word(bytes), "solid"))
            return has_control_characters(bytes) && (has_room || !has_facets(bytes));
        if (!has_room) utf8_text(name_, bytes);
        return true;
    }

    void read_binary(const std::string& bytes)
    {
        if (bytes.size() < header_size) throw Error(name_, "", "this is not an STL file: it ends within its header");
        const std::size_t promised = promised_triangles(bytes);
        const std::size_t there = (bytes.size() - header_size) / triangle_size;
        if (there < promised)
            throw Error(
                name_, "",
                fmt::format("the file is truncated: its header says {} triangles, but there are {}", promised, there));
        mesh_.indices.reserve(3 * promised);
        for (std::size_t i = 0; i < promised; ++i) {
            const char* corners = bytes.data() + header_size + i * triangle_size + 12;
            for (std::size_t k = 0; k < 3; ++k) {
                Vec3f p;
                std::memcpy(&p, corners + 12 * k, 12);
                add_corner(p);
            }
        }
    }

    /// Keywords may be in either case and share lines. The line of a solid's name is skipped, since names are
    /// arbitrary.
    void read_ascii(const std::string& text)
    {
        TextScanner scan(name_, utf8_text(name_, text));
        bool is_open = false;
        for (; !scan.at_end(); scan.next_line()) {
            for (std::string_view word = scan.word(); !word.empty(); word = scan.word()) {
                const bool is_start = equals(word, "solid");
                if (is_start || equals(word, "endsolid")) {
                    is_open = is_start;
                    break;
                }
                if (equals(word, "vertex")) read_vertex(scan);
            }
        }
        if (mesh_.indices.size() % 3 != 0) scan.fail("the file ends within a triangle");
        warnings_.add(name_ + ": the file ends without 'endsolid': it may be truncated", is_open);
    }
    void read_vertex(TextScanner& scan)
    {
        const float x = scan.number(), y = scan.number(), z = scan.number();
        add_corner({x, y, z});
    }

    void add_corner(Vec3f p)
    {
        // 0 and -0 are the same position.
        const auto bits = [](float x) { return std::bit_cast<std::uint32_t>(x == 0 ? 0.0f : x); };
        const std::uint32_t index = vertices_({bits(p.x), bits(p.y), bits(p.z)});
        if (index == mesh_.positions.size()) mesh_.positions.push_back(p);
        mesh_.indices.push_back(index);
    }

    std::string name_;
    Warnings& warnings_;
    Mesh mesh_;
    VertexIndex vertices_;
};

}  // namespace

SceneDescription read_stl(const std::filesystem::path& file, const std::string& bytes, LoadContext& context)
{
    const std::string name = file.string();
    Mesh mesh = StlReader(name, context.warnings).read(bytes);
    if (mesh.indices.empty()) throw Error(name, "", "it contains no triangles");
    mesh.name = file.stem().string();
    clean_mesh(mesh, name, context.mesh_faults);
    SceneDescription scene;
    scene.file = name;
    Node node;
    node.name = mesh.name;
    node.shapes.push_back({MeshInstance{0}, -1, mesh.name});
    scene.meshes.push_back(std::move(mesh));
    scene.nodes.push_back(std::move(node));
    scene.roots = {0};
    return scene;
}

}  // namespace fathom
