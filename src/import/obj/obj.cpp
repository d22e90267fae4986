#include "import/obj/obj.h"

#include <algorithm>
#include <memory>
#include <optional>
#include <set>

#include "import/common/mesh_cleanup.h"
#include "import/common/point_cloud.h"
#include "import/common/polygon.h"
#include "import/common/text_scanner.h"
#include "import/common/vertex_index.h"

namespace fathom {

namespace {

constexpr std::uint32_t none = ~0u, missing = ~0u - 1;

/// A mesh that grows: all faces of one object with one material, those with normals apart from those without.
struct Part {
    Mesh mesh;
    int material = -1;
    bool has_uvs = false;
    VertexIndex vertices;
};

struct Corner {
    std::uint32_t position, uv, normal;
};

class ObjReader {
public:
    ObjReader(const std::filesystem::path& file, std::string_view text, LoadContext& context)
        : file_(file), name_(file.string()), scan_(name_, text), context_(context), warnings_(context.warnings)
    {
    }

    SceneDescription read()
    {
        for (; !scan_.at_end(); scan_.next_line()) read_line();
        if (corners_seen_ == 0 && cloud_.empty()) cloud_ = positions_;
        if (positions_.empty()) throw Error(name_, "", "there are no vertices in it: is it an OBJ file?");
        scene_.file = name_;
        for (auto& [key, part] : parts_) add_part(*part);
        scene_.roots.resize(scene_.nodes.size());
        for (std::size_t i = 0; i < scene_.roots.size(); ++i) scene_.roots[i] = int(i);
        Points points = fitting_points(std::move(cloud_), name_, warnings_);
        points.name = "points";
        add_point_cloud(scene_, std::move(points));
        return std::move(scene_);
    }

private:
    void warn(const char* message) { warnings_.add(name_ + ": " + message); }

    void read_line()
    {
        const std::string_view key = scan_.word();
        if (key.empty()) return;
        // A backslash at the end of a comment joins nothing.
        if (key[0] == '#') return void(scan_.rest());
        if (key == "v")
            read_position();
        else if (key == "vt")
            read_uv();
        else if (key == "vn")
            normals_.push_back({scan_.number(), scan_.number(), scan_.number()});
        else if (key == "f" || key == "fo")
            read_face();
        else if (key == "usemtl")
            use_material(scan_.rest());
        else if (key == "mtllib")
            read_library(scan_.rest());
        else if (key == "o")
            object_ = scan_.rest(), part_ = nullptr;
        else if (key == "l")
            warn("lines are not shown");
        else if (key == "p")
            read_points();
        else if (key == "vp" || key == "curv" || key == "curv2" || key == "surf" || key == "cstype")
            warn("curves and free-form surfaces are not shown");
        else if (key != "g" && key != "s" && key != "mg" && key != "lod" && key != "usemap" && key != "maplib" &&
                 key != "deg" && key != "end" && key != "parm" && key != "bevel" && key != "c_interp" &&
                 key != "d_interp" && key != "shadow_obj" && key != "trace_obj" && key != "call")
            warn("lines that are not understood are left out");
    }

    void read_position()
    {
        const Vec3f p{scan_.number(), scan_.number(), scan_.number()};
        positions_.push_back(p);
        // Behind the position: a weight that polygons don't need, or a colour, as many programs write it.
        float more[4];
        int count = 0;
        for (; count < 4 && scan_.line_has_more(); ++count) more[count] = scan_.number();
        if (count >= 3) {
            colors_.resize(positions_.size() - 1, {1, 1, 1, 1});
            colors_.push_back({more[0], more[1], more[2], 1});
        } else if (!colors_.empty()) {
            colors_.push_back({1, 1, 1, 1});
        }
    }

    void read_uv()
    {
        const float u = scan_.number();
        const float v = scan_.line_has_more() ? scan_.number() : 0;
        uvs_.push_back({u, 1 - v});
    }

    /// One number of a corner, from 1 on or from -1 back.
    std::uint32_t index(std::string_view word, std::size_t size, const char* what) const
    {
        const auto i = scan_.to_integer<long long>(word);
        const long long from_zero = i > 0 ? i - 1 : i + (long long)size;
        if (i == 0 || from_zero < 0 || from_zero >= (long long)size)
            scan_.fail(fmt::format("{} {} is out of range: there are {} so far", what, i, size));
        return std::uint32_t(from_zero);
    }

    Corner corner(std::string_view word)
    {
        Corner corner{none, none, none};
        const std::size_t slash = word.find('/');
        corner.position = index(word.substr(0, slash), positions_.size(), "vertex");
        if (slash == std::string_view::npos) return corner;
        word.remove_prefix(slash + 1);
        const std::size_t second = word.find('/');
        if (const auto uv = word.substr(0, second); !uv.empty())
            corner.uv = index(uv, uvs_.size(), "texture coordinate");
        if (second == std::string_view::npos) return corner;
        word.remove_prefix(second + 1);
        if (!word.empty()) corner.normal = normal_index(word);
        return corner;
    }

    /// A normal that isn't there is made up for: the rest of the face is as it should be.
    std::uint32_t normal_index(std::string_view word)
    {
        const auto i = scan_.to_integer<long long>(word);
        const long long from_zero = i > 0 ? i - 1 : i + (long long)normals_.size();
        if (i != 0 && from_zero >= 0 && from_zero < (long long)normals_.size()) return std::uint32_t(from_zero);
        warn("normals that are not there are replaced by those of the faces around");
        return missing;
    }

    /// Each word is a vertex.
    void read_points()
    {
        for (std::string_view word = scan_.word(); !word.empty() && word[0] != '#'; word = scan_.word())
            cloud_.push_back(positions_[index(word, positions_.size(), "vertex")]);
    }

    void read_face()
    {
        corners_.clear();
        for (std::string_view word = scan_.word(); !word.empty() && word[0] != '#'; word = scan_.word())
            corners_.push_back(corner(word));
        corners_seen_ += corners_.size();
        if (corners_.size() < 3) return warn("faces with fewer than three corners are left out");
        const bool has_normals =
            std::all_of(corners_.begin(), corners_.end(), [](Corner c) { return c.normal != none; });
        Part& part = part_for(has_normals);
        triangles_.clear();
        if (corners_.size() == 3) {
            triangles_.insert(triangles_.end(), {0, 1, 2});
        } else {
            points_.clear();
            for (Corner c : corners_) points_.push_back(positions_[c.position]);
            triangulate(points_, triangles_);
        }
        for (std::uint32_t i : triangles_) part.mesh.indices.push_back(vertex(part, corners_[i], has_normals));
    }

    std::uint32_t vertex(Part& part, Corner c, bool has_normals)
    {
        if (!has_normals) c.normal = none;
        const std::uint32_t n = part.vertices({c.position, c.uv, c.normal});
        Mesh& mesh = part.mesh;
        if (n < mesh.positions.size()) return n;
        mesh.positions.push_back(positions_[c.position]);
        if (has_normals) mesh.normals.push_back(c.normal == missing ? Vec3f{0, 0, 0} : normals_[c.normal]);
        mesh.uvs[0].push_back(c.uv != none ? uvs_[c.uv] : Vec2f{0, 0});
        part.has_uvs |= c.uv != none;
        if (c.position < colors_.size()) {
            mesh.colors.resize(n, {1, 1, 1, 1});
            mesh.colors.push_back(colors_[c.position]);
        }
        return n;
    }

    Part& part_for(bool has_normals)
    {
        if (part_ && part_has_normals_ == has_normals) return *part_;
        auto& part = parts_[{object_, material_, has_normals}];
        if (!part) {
            part = std::make_unique<Part>();
            part->mesh.name = printable(object_);
            part->material = material_;
        }
        part_ = part.get();
        part_has_normals_ = has_normals;
        return *part_;
    }

    void use_material(std::string_view name)
    {
        part_ = nullptr;
        const auto found = materials_.find(name);
        material_ = found == materials_.end() ? -1 : found->second;
        if (material_ < 0)
            warnings_.add(fmt::format("{}: there is no material named '{}': grey is used", name_, printable(name)));
    }

    bool read_library_file(std::string_view name)
    {
        const std::filesystem::path file = context_.locate(file_.parent_path() / std::string(name));
        std::error_code error;
        if (!std::filesystem::is_regular_file(file, error)) return false;
        if (!libraries_.insert(file).second) return true;
        read_mtl(file, context_.read(file), scene_, materials_, warnings_);
        return true;
    }

    /// One file, whose name may have spaces, or several.
    void read_library(std::string_view rest)
    {
        if (read_library_file(rest)) return;
        TextScanner names(name_, rest);
        for (std::string_view name = names.word(); !name.empty(); name = names.word())
            if (!read_library_file(name))
                warnings_.add(fmt::format("{}: the material file '{}' is missing", name_, printable(name)));
    }

    void add_part(Part& part)
    {
        if (!part.has_uvs) part.mesh.uvs[0].clear();
        if (!part.mesh.colors.empty()) {
            part.mesh.colors.resize(part.mesh.positions.size(), {1, 1, 1, 1});
            part.material = with_vertex_colors(part.material);
        }
        clean_mesh(part.mesh, name_, warnings_);
        if (part.mesh.indices.empty()) return;
        Node node;
        node.name = part.mesh.name;
        node.shapes.push_back({MeshInstance{int(scene_.meshes.size())}, part.material, node.name});
        scene_.nodes.push_back(std::move(node));
        scene_.meshes.push_back(std::move(part.mesh));
    }

    int with_vertex_colors(int material)
    {
        if (const auto found = colored_.find(material); found != colored_.end()) return found->second;
        Material m;
        m.base_color.value = {1, 1, 1};
        if (material >= 0) m = scene_.materials[std::size_t(material)];
        m.use_vertex_color = true;
        scene_.materials.push_back(std::move(m));
        return colored_[material] = int(scene_.materials.size()) - 1;
    }

    const std::filesystem::path& file_;
    std::string name_;
    TextScanner scan_;
    LoadContext& context_;
    Warnings& warnings_;
    SceneDescription scene_;

    std::vector<Vec3f> positions_, normals_;
    std::vector<Vec2f> uvs_;
    std::vector<Vec4f> colors_;
    std::map<std::string, int, std::less<>> materials_;
    std::set<std::filesystem::path> libraries_;  ///< that were read
    std::map<int, int> colored_;

    std::string object_;
    int material_ = -1;
    std::map<std::tuple<std::string, int, bool>, std::unique_ptr<Part>> parts_;
    Part* part_ = nullptr;  ///< that of the last face, nullptr after a change of object or material
    bool part_has_normals_ = false;

    std::vector<Vec3f> cloud_;  ///< what `p` names
    std::size_t corners_seen_ = 0;
    std::vector<Corner> corners_;  ///< of the face being read
    std::vector<Vec3f> points_;
    std::vector<std::uint32_t> triangles_;
};

}  // namespace

SceneDescription read_obj(const std::filesystem::path& file, std::string_view text, LoadContext& context)
{
    return ObjReader(file, text, context).read();
}

}  // namespace fathom
