#include "import/stl/stl.h"

#include <bit>
#include <cstring>

#include "import/common/mesh_cleanup.h"
#include "import/common/text_scanner.h"
#include "import/common/vertex_index.h"

namespace fathom {

namespace {

constexpr std::size_t header_size = 84, triangle_size = 50;

class StlReader {
public:
    explicit StlReader(std::string name) : name_(std::move(name)) {}

    Mesh read(const std::string& bytes)
    {
        // Many binary files begin with "solid" too; their size gives them away.
        std::uint32_t promised = 0;
        if (bytes.size() >= header_size) std::memcpy(&promised, bytes.data() + 80, 4);
        const bool fits =
            bytes.size() >= header_size && bytes.size() - header_size == triangle_size * std::size_t(promised);
        const bool says_solid = std::string_view(bytes).substr(0, 5) == "solid";
        if (fits || !says_solid)
            read_binary(bytes, promised);
        else
            read_ascii(bytes);
        return std::move(mesh_);
    }

private:
    void read_binary(const std::string& bytes, std::size_t promised)
    {
        if (bytes.size() < header_size) throw Error(name_, "", "this is no STL file: it ends in its header");
        const std::size_t there = (bytes.size() - header_size) / triangle_size;
        if (there < promised)
            throw Error(
                name_, "",
                fmt::format("the file ends too early: {} triangles are promised, there are {}", promised, there));
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

    void read_ascii(const std::string& text)
    {
        TextScanner scan(name_, text);
        for (; !scan.at_end(); scan.next_line())
            if (scan.word() == "vertex") {
                const float x = scan.number(), y = scan.number(), z = scan.number();
                add_corner({x, y, z});
            }
        if (mesh_.indices.size() % 3 != 0) scan.fail("the file ends in a triangle");
    }

    void add_corner(Vec3f p)
    {
        // Both zeros are the same place.
        const auto bits = [](float x) { return std::bit_cast<std::uint32_t>(x == 0 ? 0.0f : x); };
        const std::uint32_t index = vertices_({bits(p.x), bits(p.y), bits(p.z)});
        if (index == mesh_.positions.size()) mesh_.positions.push_back(p);
        mesh_.indices.push_back(index);
    }

    std::string name_;
    Mesh mesh_;
    VertexIndex vertices_;
};

}  // namespace

SceneDescription read_stl(const std::filesystem::path& file, const std::string& bytes, LoadContext& context)
{
    const std::string name = file.string();
    Mesh mesh = StlReader(name).read(bytes);
    if (mesh.indices.empty()) throw Error(name, "", "there are no triangles in it");
    mesh.name = file.stem().string();
    clean_mesh(mesh, name, context.warnings);
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
