// SPDX-License-Identifier: Apache-2.0
#include "formats/gltf/glb.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "fathom/error.h"
#include "formats/gltf/glb_buffer.h"
#include "formats/gltf/glb_materials.h"
#include "scene/tessellate.h"

namespace fathom {

namespace {

/// Writes a scene description as GLB. glTF nodes have one parent: a node with several parents is written for each of
/// them, its meshes once.
class GlbWriter {
public:
    GlbWriter(const SceneDescription& scene, const std::string& file, Warnings& warnings)
        : scene_(scene), file_(file), warnings_(warnings), materials_(scene, buffer_, file_, warnings)
    {
    }

    std::string write()
    {
        Json roots = Json::array();
        for (const int root : scene_.roots) roots.push_back(add_node(root));
        report_losses();
        Json gltf = {{"asset", {{"version", "2.0"}, {"generator", "Fathom"}}}, {"scene", 0}};
        gltf["scenes"].push_back(roots.empty() ? Json::object() : Json{{"nodes", std::move(roots)}});
        const auto put = [&](const char* key, Json& list) {
            if (!list.empty()) gltf[key] = std::move(list);
        };
        put("nodes", nodes_);
        put("meshes", meshes_);
        put("cameras", cameras_);
        materials_.put_into(gltf);
        std::set<std::string> used = materials_.extensions();
        if (!lights_.empty()) {
            gltf["extensions"]["KHR_lights_punctual"]["lights"] = std::move(lights_);
            used.insert("KHR_lights_punctual");
        }
        for (const std::string& name : used) gltf["extensionsUsed"].push_back(name);
        if (!buffer_.bytes().empty()) {
            gltf["buffers"].push_back({{"byteLength", buffer_.bytes().size()}});
            gltf["bufferViews"] = buffer_.views();
            if (!buffer_.accessors().empty()) gltf["accessors"] = buffer_.accessors();
        }
        return container(gltf.dump(-1, ' ', false, Json::error_handler_t::replace));
    }

private:
    void warn(const std::string& message) { warnings_.add(file_ + ": " + message); }

    std::string container(std::string json) const
    {
        json.resize((json.size() + 3) / 4 * 4, ' ');
        const std::string& chunk = buffer_.bytes();
        const std::size_t size = 12 + 8 + json.size() + (chunk.empty() ? 0 : 8 + chunk.size());
        if (size > 0xffffffffu)
            throw Error(file_, "", "the scene does not fit into a GLB file, which holds at most 4 GB");
        std::string bytes = "glTF";
        const auto add = [&](std::size_t word) {
            for (int i = 0; i < 4; ++i) bytes += char(word >> (8 * i) & 255);
        };
        add(2), add(size), add(json.size()), bytes += "JSON", bytes += json;
        if (chunk.empty()) return bytes;
        add(chunk.size()), bytes.append("BIN\0", 4), bytes += chunk;
        return bytes;
    }

    static Json matrix_json(const Transform& t)
    {
        Json m = Json::array();
        for (std::size_t column = 0; column < 4; ++column) {
            for (std::size_t row = 0; row < 3; ++row) m.push_back(number_json(t.m[row][column]));
            m.push_back(column < 3 ? 0 : 1);
        }
        return m;
    }

    int push_node(Json node)
    {
        constexpr std::size_t most = 10'000'000;
        if (nodes_.size() >= most)
            throw Error(file_, "",
                        "the scene has more than ten million nodes after expansion: glTF can't instance groups");
        nodes_.push_back(std::move(node));
        return int(nodes_.size()) - 1;
    }
    int push_placed(const Transform& t, const char* key, Json value)
    {
        Json node = {{key, std::move(value)}};
        if (t.m != Transform().m) node["matrix"] = matrix_json(t);
        return push_node(std::move(node));
    }

    int add_node(int index)
    {
        const Node& n = scene_.nodes[std::size_t(index)];
        Json node = Json::object();
        if (!n.name.empty()) node["name"] = n.name;
        if (!n.motion.empty())
            warn("motion blur of nodes is not written: glTF has none; they keep their first transform");
        const Transform& place = n.motion.empty() ? n.parent_from_node : n.motion.front().parent_from_node;
        if (place.m != Transform().m) node["matrix"] = matrix_json(place);
        if (n.light >= 0 && !gltf_type(kind_of(n.light)))
            warn(fmt::format("lights of kind '{}' are not written: glTF has none", light_kind_name(kind_of(n.light))));
        else if (n.light >= 0)
            node["extensions"]["KHR_lights_punctual"]["light"] = light(n.light);
        Json children = Json::array();
        if (n.camera >= 0) add_camera(n.camera, node, children);
        Json primitives = Json::array();
        std::vector<std::pair<int, int>> key;
        for (const Shape& shape : n.shapes) add_shape(shape, primitives, key, children);
        if (!primitives.empty()) node["mesh"] = mesh_of(std::move(primitives), key);
        for (const int child : n.children) children.push_back(add_node(child));
        if (!children.empty()) node["children"] = std::move(children);
        return push_node(std::move(node));
    }

    /// Index of a mesh of these primitives.
    ///
    /// key  indices of the primitives' meshes and materials; a mesh is shared only if the key covers all primitives
    int mesh_of(Json primitives, const std::vector<std::pair<int, int>>& key)
    {
        const bool is_known = key.size() == primitives.size();
        if (is_known)
            if (const auto found = mesh_indices_.find(key); found != mesh_indices_.end()) return found->second;
        const int index = int(meshes_.size());
        Json mesh = {{"primitives", std::move(primitives)}};
        if (is_known) {
            if (const std::string& name = scene_.meshes[std::size_t(key[0].first)].name; !name.empty())
                mesh["name"] = name;
            mesh_indices_.emplace(key, index);
        }
        meshes_.push_back(std::move(mesh));
        return index;
    }

    void add_shape(const Shape& shape, Json& primitives, std::vector<std::pair<int, int>>& key, Json& children)
    {
        if (const auto* instance = std::get_if<MeshInstance>(&shape.geometry)) {
            const Mesh& mesh = scene_.meshes[std::size_t(instance->mesh)];
            if (mesh.indices.empty()) return;
            key.emplace_back(instance->mesh, shape.material);
            const auto [found, is_new] = geometry_.try_emplace(instance->mesh);
            if (is_new) found->second = geometry_json(mesh);
            primitives.push_back(primitive(found->second, shape.material));
        } else if (const auto* sphere = std::get_if<Sphere>(&shape.geometry)) {
            add_sphere(*sphere, shape.material, children);
        } else if (std::holds_alternative<CurvesInstance>(shape.geometry)) {
            warn("curves are not written: glTF has none");
        } else if (const auto* points = std::get_if<PointsInstance>(&shape.geometry)) {
            const Points& p = scene_.points[std::size_t(points->points)];
            if (p.centers.empty()) return;
            warn("the radii of points are not written: glTF has none");
            Json json = {{"mode", 0}, {"material", materials_.index(shape.material)}};
            json["attributes"]["POSITION"] = buffer_.add_vertices(&p.centers[0].x, p.centers.size(), 3, true);
            primitives.push_back(std::move(json));
        } else {
            if (std::holds_alternative<Disk>(shape.geometry)) warn("disks are written as triangles");
            primitives.push_back(primitive(geometry_json(tessellate(shape.geometry)), shape.material));
        }
    }

    /// Adds a sphere as a transformed instance of a tessellated unit sphere.
    void add_sphere(const Sphere& sphere, int material, Json& children)
    {
        warn("spheres are written as triangles");
        if (sphere.center_end) warn("motion blur of spheres is not written: they keep their first position");
        const int side = sphere.radius < 0 ? 1 : 0;
        if (unit_spheres_[side].is_null())
            unit_spheres_[side] = geometry_json(tessellate(Sphere{{0, 0, 0}, side == 1 ? -1.0 : 1.0, {}}));
        const auto [found, is_new] = sphere_meshes_.try_emplace({side, material}, int(meshes_.size()));
        if (is_new) {
            Json mesh;
            mesh["primitives"].push_back(primitive(unit_spheres_[side], material));
            meshes_.push_back(std::move(mesh));
        }
        const double r = std::abs(sphere.radius);
        children.push_back(
            push_placed(Transform::translate(sphere.center) * Transform::scale({r, r, r}), "mesh", found->second));
    }

    /// A primitive without its material, and "colors" if the mesh has vertex colors.
    Json geometry_json(const Mesh& mesh)
    {
        if (!mesh.motion.empty()) warn("motion blur of deforming meshes is not written: they keep their first shape");
        const std::vector<Vec3f>& positions = mesh.motion.empty() ? mesh.positions : mesh.motion.front().positions;
        const std::vector<Vec3f>& normals = mesh.motion.empty() ? mesh.normals : mesh.motion.front().normals;
        Json json = Json::object();
        Json& attributes = json["attributes"];
        attributes["POSITION"] = buffer_.add_vertices(&positions[0].x, positions.size(), 3, true);
        if (!normals.empty()) attributes["NORMAL"] = buffer_.add_vertices(&normals[0].x, normals.size(), 3);
        if (!mesh.tangents.empty())
            attributes["TANGENT"] = buffer_.add_vertices(&mesh.tangents[0].x, mesh.tangents.size(), 4);
        for (int set = 0; set < 2; ++set)
            if (const std::vector<Vec2f>& uv = mesh.uvs[set]; !uv.empty())
                attributes[fmt::format("TEXCOORD_{}", set)] = buffer_.add_vertices(&uv[0].x, uv.size(), 2);
        json["indices"] = buffer_.add_indices(mesh.indices);
        if (!mesh.colors.empty()) json["colors"] = buffer_.add_vertices(&mesh.colors[0].x, mesh.colors.size(), 4);
        return json;
    }

    /// Whether to write vertex colors: glTF applies them always, Fathom only to materials that use them.
    bool wants_colors(int material) const
    {
        if (material < 0) return false;
        const Material& m = scene_.materials[std::size_t(material)];
        const int texture = m.base_color.texture;
        return m.use_vertex_color ||
               (texture >= 0 && scene_.textures[std::size_t(texture)].kind == TextureKind::vertex_color);
    }

    Json primitive(Json geometry, int material)
    {
        if (geometry.contains("colors")) {
            if (wants_colors(material)) geometry["attributes"]["COLOR_0"] = geometry["colors"];
            geometry.erase("colors");
        }
        geometry["material"] = materials_.index(material);
        return geometry;
    }

    void add_camera(int index, Json& node, Json& children)
    {
        const Camera& c = scene_.cameras[std::size_t(index)];
        const auto [found, is_new] = camera_indices_.try_emplace(index, int(cameras_.size()));
        if (is_new) cameras_.push_back(camera_json(c));
        const Vec3d back = normalize(c.position - c.look_at), right = normalize(cross(c.up, back)),
                    up = cross(back, right);
        Transform place;
        for (std::size_t row = 0; row < 3; ++row) {
            const auto part = [&](const Vec3d& v) { return row == 0 ? v.x : row == 1 ? v.y : v.z; };
            place.m[row] = {part(right), part(up), part(back), part(c.position)};
        }
        if (place.m == Transform().m)
            node["camera"] = found->second;
        else
            children.push_back(push_placed(place, "camera", found->second));
    }

    Json camera_json(const Camera& c)
    {
        // Rasterizers need clipping distances; ray tracers ignore them.
        constexpr double nearest = 0.01, farthest = 1e5;
        Json json = Json::object();
        if (!c.name.empty()) json["name"] = c.name;
        if (c.shift_x != 0 || c.shift_y != 0) warn("the lens shift of cameras is not written: glTF has none");
        if (c.aperture > 0) warn("depth of field is not written: glTF has none");
        if (c.shutter_open != 0 || c.shutter_close != 0) warn("the shutter is not written: glTF has none");
        if (c.kind == CameraKind::orthographic) {
            json["type"] = "orthographic";
            json["orthographic"] = {{"xmag", number_json(c.height / 2 * (c.aspect > 0 ? c.aspect : 1))},
                                    {"ymag", number_json(c.height / 2)},
                                    {"znear", nearest},
                                    {"zfar", farthest}};
            return json;
        }
        if (c.kind != CameraKind::perspective) warn("panoramic cameras are written as perspective cameras");
        json["type"] = "perspective";
        json["perspective"] = {{"yfov", number_json(c.fov_y)}, {"znear", nearest}};
        if (c.aspect > 0) json["perspective"]["aspectRatio"] = number_json(c.aspect);
        return json;
    }

    LightKind kind_of(int light) const { return scene_.lights[std::size_t(light)].kind; }
    /// Type in KHR_lights_punctual; nullptr: none is similar.
    static const char* gltf_type(LightKind kind)
    {
        switch (kind) {
            case LightKind::point:
            case LightKind::goniometric:
                return "point";
            case LightKind::spot:
            case LightKind::projector:
                return "spot";
            case LightKind::directional:
                return "directional";
            default:
                return nullptr;
        }
    }

    int light(int index)
    {
        const auto [found, is_new] = light_indices_.try_emplace(index, int(lights_.size()));
        if (!is_new) return found->second;
        const Light& l = scene_.lights[std::size_t(index)];
        Json json = {{"type", gltf_type(l.kind)}};
        if (l.picture.image >= 0 || l.kind == LightKind::projector)
            warn("light images are not written: projectors become spot lights, goniometric lights become point lights");
        if (!l.name.empty()) json["name"] = l.name;
        const Color c = l.intensity;
        const float most = std::max({c.r, c.g, c.b});
        const bool is_flux =
            l.intensity_is_flux && (l.kind == LightKind::projector || l.kind == LightKind::goniometric);
        json["intensity"] = is_flux ? number_json(double(most) / (4 * std::numbers::pi)) : number_json(most);
        if (most > 0) json["color"] = {number_json(c.r / most), number_json(c.g / most), number_json(c.b / most)};
        if (l.kind == LightKind::directional && l.angle > 0)
            warn("the angular diameter of directional lights is not written: glTF has none");
        if (l.kind == LightKind::spot)
            // glTF requires the inner angle to be less than the outer one.
            json["spot"] = {{"innerConeAngle", number_json(std::min(l.inner_angle, l.outer_angle * (1 - 1e-6)))},
                            {"outerConeAngle", number_json(l.outer_angle)}};
        if (l.kind == LightKind::spot && l.falloff != SpotFalloff::square && l.inner_angle < l.outer_angle)
            warn("the falloff of spot lights is replaced by glTF's");
        if (l.kind == LightKind::projector)
            json["spot"] = {{"outerConeAngle", number_json(std::min(l.fov, std::numbers::pi * (1 - 1e-6)) / 2)}};
        lights_.push_back(std::move(json));
        return found->second;
    }

    void report_losses()
    {
        if (scene_.environment.kind != EnvironmentKind::none) warn("the environment is not written: glTF has none");
        const RenderHints& h = scene_.hints;
        if (h.width || h.height || h.samples || h.max_depth || h.roulette_depth || h.filter || h.light_sampling ||
            h.exposure || h.white_balance || h.background || h.tonemap || h.build)
            warn("render settings (size, samples, exposure, ...) are not written: glTF has none");
    }

    const SceneDescription& scene_;
    const std::string& file_;
    Warnings& warnings_;
    GlbBuffer buffer_;
    GlbMaterials materials_;
    Json nodes_ = Json::array(), meshes_ = Json::array(), cameras_ = Json::array(), lights_ = Json::array();
    std::map<int, Json> geometry_;  ///< primitives by mesh index
    std::map<std::vector<std::pair<int, int>>, int> mesh_indices_;
    Json unit_spheres_[2];  ///< meshes of a unit sphere: facing outward, and inward
    std::map<std::pair<int, int>, int> sphere_meshes_;
    std::map<int, int> camera_indices_, light_indices_;
};

}  // namespace

std::string glb_bytes(const SceneDescription& scene, const std::string& file, Warnings& warnings)
{
    return GlbWriter(scene, file, warnings).write();
}

}  // namespace fathom
