// SPDX-License-Identifier: Apache-2.0
#include "formats/fathom/scene_json.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/output_file.h"
#include "fathom/error.h"
#include "formats/fathom/measured_writer.h"
#include "formats/fathom/parameters_json.h"
#include "formats/io/read_file.h"
#include "formats/ply/ply_writer.h"
#include "scene/enum_names.h"
#include "scene/light_table.h"
#include "scene/units.h"

namespace fathom {

namespace {

/// Sets a key unless the value is the default `usual`.
void put_unless_default(Json& json, const char* key, Json value, const Json& usual = {})
{
    if (value != usual) json[key] = std::move(value);
}

/// Extension of an image file, from its signature.
std::string extension_of(const ImageFile& image)
{
    const std::string_view bytes(reinterpret_cast<const char*>(image.bytes.data()), image.bytes.size());
    using namespace std::string_view_literals;
    for (const auto& [begin, extension] : {std::pair{"\x89PNG"sv, ".png"},
                                           {"\xff\xd8"sv, ".jpg"},
                                           {"RIFF"sv, ".webp"},
                                           {"#?"sv, ".hdr"},
                                           {"\x76\x2f\x31\x01"sv, ".exr"}})
        if (bytes.starts_with(begin)) return extension;
    if (bytes.substr(std::min<std::size_t>(bytes.size(), 4)).starts_with("ftypavi")) return ".avif";
    return std::filesystem::path(image.name).extension().string();
}

/// Writes a scene description as JSON. Each kind of object has a table in the order of the description; entries are
/// referred to by name.
class SceneWriter {
public:
    SceneWriter(const SceneDescription& scene, const std::string& file, SaveFiles& files, Warnings& warnings)
        : scene_(scene), file_(file), files_(files), warnings_(warnings)
    {
        name(scene.cameras, "camera", cameras_);
        name(scene.lights, "light", lights_);
        name(scene.textures, "texture", textures_);
        name(scene.materials, "material", materials_);
        name(scene.meshes, "mesh", meshes_);
        name(scene.curves, "curves", curves_);
        name(scene.points, "points", points_);
        refer_to_images();
        refer_to_measured();
        count_uses();
        UniqueNames unique;
        for (std::size_t i = 0; i < scene.nodes.size(); ++i)
            nodes_.push_back(is_inline(i) ? "" : unique.add(scene.nodes[i].name, "node"));
    }

    Json write()
    {
        Json json = {{"fathom", 1}};
        put_unless_default(json, "render", render_json(), Json::object());
        add(json, "cameras", scene_.cameras, cameras_, &SceneWriter::camera_json);
        put_unless_default(json, "environment", environment_json(), Json::object());
        add(json, "lights", scene_.lights, lights_, &SceneWriter::light_json);
        for (std::size_t i = 0; i < textures_.size(); ++i)
            json["textures"][textures_[i]] = texture_json(scene_.textures[i], names());
        for (std::size_t i = 0; i < materials_.size(); ++i)
            json["materials"][materials_[i]] = material_json(scene_.materials[i], names());
        add(json, "meshes", scene_.meshes, meshes_, &SceneWriter::mesh_json);
        add(json, "curves", scene_.curves, curves_, &SceneWriter::curves_json);
        add(json, "points", scene_.points, points_, &SceneWriter::points_json);
        add(json, "nodes", scene_.nodes, nodes_, &SceneWriter::shared_node_json);
        Json& roots = json["scene"] = Json::array();
        for (const int root : scene_.roots) roots.push_back(reference(root));
        return json;
    }

private:
    template <class T>
    static void name(const std::vector<T>& things, const char* other, std::vector<std::string>& names)
    {
        UniqueNames unique;
        for (const T& thing : things) names.push_back(unique.add(thing.name, other));
    }

    /// Adds a table with the result of make() for each object; null results are omitted.
    template <class T>
    void add(Json& json, const char* key, const std::vector<T>& things, const std::vector<std::string>& names,
             Json (SceneWriter::*make)(const T&, std::size_t))
    {
        for (std::size_t i = 0; i < things.size(); ++i)
            if (Json thing = (this->*make)(things[i], i); !thing.is_null()) json[key][names[i]] = std::move(thing);
    }

    void warn(const std::string& message) { warnings_.add(file_ + ": " + message); }

    void refer_to_images()
    {
        std::vector<bool> is_used(scene_.images.size());
        const auto use = [&](int image) {
            if (image >= 0) is_used[std::size_t(image)] = true;
        };
        for (const Texture& texture : scene_.textures) use(texture.image);
        use(scene_.environment.image);
        for (const int face : scene_.environment.faces) use(face);
        for (const Light& light : scene_.lights) use(light.picture.image);
        for (std::size_t i = 0; i < scene_.images.size(); ++i) {
            const ImageFile& image = scene_.images[i];
            std::string path = image.bytes.empty() ? files_.refer(image.path) : std::string();
            if (!is_used[i])
                warn("images that no texture uses are not written");
            else if (path.empty())
                path = files_.add(fmt::format("picture-{}-{}", i, std::filesystem::path(image.name).stem().string()),
                                  extension_of(image), [&image](const auto& target) { write_picture(image, target); });
            images_.push_back(std::move(path));
        }
    }

    void refer_to_measured()
    {
        std::vector<bool> is_used(scene_.measured.size());
        for (const Material& m : scene_.materials)
            if (m.kind == MaterialKind::measured) is_used[std::size_t(m.measured)] = true;
        for (std::size_t i = 0; i < scene_.measured.size(); ++i) {
            const MeasuredBrdf& brdf = scene_.measured[i];
            const auto write = [&brdf](const auto& target) {
                const std::string bytes = measured_file(brdf);
                OutputFile out(target);
                out.write(bytes.data(), bytes.size());
                out.commit();
            };
            measured_.push_back(is_used[i] ? files_.add(fmt::format("measured-{}", i), ".bsdf", write) : std::string());
        }
    }

    static void write_picture(const ImageFile& image, const std::filesystem::path& target)
    {
        const std::string bytes = image.bytes.empty() ? read_file(image.path) : std::string();
        OutputFile out(target);
        image.bytes.empty() ? out.write(bytes.data(), bytes.size()) : out.write(image.bytes.data(), image.bytes.size());
        out.commit();
    }

    /// Counts references to nodes, cameras and lights. Throws Error if nodes are nested deeper than the reader allows.
    void count_uses()
    {
        uses_.resize(scene_.nodes.size());
        has_camera_.resize(scene_.cameras.size());
        has_light_.resize(scene_.lights.size());
        heights_.resize(scene_.nodes.size());
        for (const int root : scene_.roots) ++uses_[std::size_t(root)];
        for (std::size_t i = 0; i < scene_.nodes.size(); ++i) {
            const Node& node = scene_.nodes[i];
            for (const int child : node.children) ++uses_[std::size_t(child)];
            if (node.camera >= 0) has_camera_[std::size_t(node.camera)] = true;
            if (node.light >= 0) has_light_[std::size_t(node.light)] = true;
            constexpr int highest = 201;
            if (height(int(i)) > highest)
                throw Error(file_, "",
                            fmt::format("nodes are nested more than {} deep, which no file allows", highest - 1));
        }
    }
    int height(int index)
    {
        int& known = heights_[std::size_t(index)];
        if (known > 0) return known;
        const Node& node = scene_.nodes[std::size_t(index)];
        int below = node.shapes.size() > 1;
        for (const int child : node.children) below = std::max(below, height(child));
        return known = below + 1;
    }

    Json render_json()
    {
        const RenderHints& hints = scene_.hints;
        Json json = Json::object();
        const auto add_hint = [&](const char* key, const auto& hint) {
            if (hint) json[key] = *hint;
        };
        if (hints.width && hints.height)
            json["size"] = {*hints.width, *hints.height};
        else if (hints.width || hints.height)
            warn("an image width without a height, or a height without a width, is not written");
        add_hint("samples", hints.samples);
        add_hint("max_depth", hints.max_depth);
        add_hint("roulette_depth", hints.roulette_depth);
        add_hint("filter", hints.filter);
        add_hint("filter_radius", hints.filter_radius);
        add_hint("build", hints.build);
        add_hint("light_sampling", hints.light_sampling);
        add_hint("exposure", hints.exposure);
        add_hint("white_balance", hints.white_balance);
        if (hints.background) json["background"] = color_json(*hints.background);
        add_hint("tonemap", hints.tonemap);
        if (!hints.own_light) json["own_light"] = false;
        return json;
    }

    Json camera_json(const Camera& camera, std::size_t i)
    {
        if (!has_camera_[i]) {
            warn("cameras that no node uses are not written");
            return {};
        }
        const Camera usual;
        Json json = Json::object();
        put_unless_default(json, "name", camera.name, cameras_[i]);
        put_unless_default(json, "kind", words::camera_kinds[int(camera.kind)], words::camera_kinds[0]);
        put_unless_default(json, "position", vector_json(camera.position), vector_json(usual.position));
        put_unless_default(json, "look_at", vector_json(camera.look_at), vector_json(usual.look_at));
        put_unless_default(json, "up", vector_json(camera.up), vector_json(usual.up));
        put_unless_default(json, "aspect", number_json(camera.aspect), 0);
        if (camera.fov_aspect > 0) {
            json["fov_axis"] = words::fov_axes[int(camera.fov_axis)];
            json["fov_aspect"] = number_json(camera.fov_aspect);
        }
        if (camera.shift_x != 0 || camera.shift_y != 0)
            json["shift"] = {number_json(camera.shift_x), number_json(camera.shift_y)};
        if (camera.shutter_open != 0 || camera.shutter_close != 0)
            json["shutter"] = {number_json(camera.shutter_open), number_json(camera.shutter_close)};
        if (camera.kind == CameraKind::orthographic) {
            put_unless_default(json, "height", number_json(camera.height), number_json(usual.height));
            if (camera.aperture != 0) warn("the lens of an orthographic camera is ignored");
            return json;
        }
        if (camera.kind != CameraKind::perspective) return json;
        if (camera.fov_y != usual.fov_y) json["fov_y_deg"] = number_json(camera.fov_y, radians_per_degree);
        put_unless_default(json, "aperture", number_json(camera.aperture), 0);
        put_unless_default(json, "focus_distance", number_json(camera.focus_distance), 0);
        return json;
    }

    ParameterNames names() { return {file_, textures_, images_, materials_, measured_, warnings_}; }

    Json light_json(const Light& light, std::size_t i)
    {
        if (!has_light_[i]) {
            warn("lights that no node uses are not written");
            return {};
        }
        const LightKindInfo& info = info_of(light.kind);
        Json json = {{"kind", info.kind.name}};
        put_unless_default(json, "name", light.name, lights_[i]);
        put_unless_default(json, "color", color_json(light.intensity), 1);
        add_light_parameters(light, names(), json);
        for (const LightUnit& unit : info.units)
            if (unit.is_flux && !unit.is_radiometric && light.intensity_is_flux) json["unit"] = unit.name;
        const LightImage& picture = light.picture;
        if (picture.image < 0 || !info.image_meaning) return json;
        json["image"] = images_[std::size_t(picture.image)];
        if (picture.color_space != ColorSpace::srgb)
            json["color_space"] = words::color_spaces[int(picture.color_space)];
        if (picture.nearest) json["lookup"] = words::lookups[1];
        return json;
    }

    Json environment_json() const
    {
        const Environment& e = scene_.environment;
        Json json = Json::object();
        if (e.kind == EnvironmentKind::none) return json;
        json["kind"] = words::environment_kinds[int(e.kind)];
        if (e.kind == EnvironmentKind::gradient) {
            json["bottom"] = color_json(e.bottom);
            json["top"] = color_json(e.top);
        } else {
            put_unless_default(json, "color", color_json(e.color), 1);
        }
        if (e.kind == EnvironmentKind::constant) return json;
        const bool has_picture = e.kind == EnvironmentKind::image || e.kind == EnvironmentKind::equal_area ||
                                 e.kind == EnvironmentKind::cube;
        if ((e.kind == EnvironmentKind::image || e.kind == EnvironmentKind::equal_area) && e.image >= 0)
            json["image"] = images_[std::size_t(e.image)];
        if (e.kind == EnvironmentKind::cube)
            for (const int face : e.faces) json["faces"].push_back(face >= 0 ? images_[std::size_t(face)] : "");
        if (has_picture) put_unless_default(json, "illuminance", number_json(e.illuminance), 0);
        if (e.kind == EnvironmentKind::sky) {
            json["to_sun"] = vector_json(e.to_sun);
            put_unless_default(json, "sun", e.sun_disk, true);
            put_unless_default(json, "ground", e.sky_ground, true);
        }
        if (e.kind == EnvironmentKind::hosek_wilkie) {
            json["to_sun"] = vector_json(e.to_sun);
            put_unless_default(json, "turbidity", number_json(e.turbidity), 3);
            put_unless_default(json, "ground_albedo", number_json(e.ground_albedo), number_json(0.3));
        }
        if (e.world_from_environment.m != Transform().m) json["rotate"] = matrix_json(e.world_from_environment);
        return json;
    }

    std::string add_ply(const std::string& name, PlyFile file)
    {
        return files_.add(name, ".ply", [file = std::move(file)](const auto& target) { file.write(target); });
    }

    Json mesh_json(const Mesh& mesh, std::size_t i)
    {
        const std::string name = fmt::format("mesh-{}-{}", i, meshes_[i]);
        PlyFile file;
        file.add_vertices({"x", "y", "z"}, mesh.positions);
        file.add_vertices({"nx", "ny", "nz"}, mesh.normals);
        file.add_vertices({"tx", "ty", "tz", "tw"}, mesh.tangents);
        file.add_vertices({"u0", "v0"}, mesh.uvs[0]);
        file.add_vertices({"u1", "v1"}, mesh.uvs[1]);
        file.add_vertices({"red", "green", "blue", "alpha"}, mesh.colors);
        file.set_triangles(mesh.indices);
        Json json = {{"file", add_ply(name, std::move(file))}};
        for (std::size_t k = 0; k < mesh.motion.size(); ++k) {
            PlyFile vertices;
            vertices.add_vertices({"x", "y", "z"}, mesh.motion[k].positions);
            vertices.add_vertices({"nx", "ny", "nz"}, mesh.motion[k].normals);
            json["motion"].push_back({{"time", number_json(mesh.motion[k].time)},
                                      {"file", add_ply(fmt::format("key-{}-of-{}", k, name), std::move(vertices))}});
        }
        return json;
    }

    Json curves_json(const Curves& curves, std::size_t i)
    {
        const std::string name = fmt::format("curves-{}-{}", i, curves_[i]);
        PlyFile file;
        file.add_vertices({"x", "y", "z"}, curves.points);
        file.add_vertices({"radius"}, curves.radii);
        file.set_curves(curves.counts);
        Json json = {{"basis", words::curve_bases[int(curves.basis)]},
                     {"style", words::curve_styles[curves.ribbons]},
                     {"file", add_ply(name, std::move(file))}};
        for (std::size_t k = 0; k < curves.motion.size(); ++k) {
            PlyFile points;
            points.add_vertices({"x", "y", "z"}, curves.motion[k].points);
            points.add_vertices({"radius"}, curves.motion[k].radii);
            json["motion"].push_back({{"time", number_json(curves.motion[k].time)},
                                      {"file", add_ply(fmt::format("key-{}-of-{}", k, name), std::move(points))}});
        }
        return json;
    }

    Json points_json(const Points& points, std::size_t i)
    {
        PlyFile file;
        file.add_vertices({"x", "y", "z"}, points.centers);
        file.add_vertices({"radius"}, points.radii);
        return {{"file", add_ply(fmt::format("points-{}-{}", i, points_[i]), std::move(file))}};
    }

    /// Nodes with a single reference are written in place.
    bool is_inline(std::size_t node) const { return uses_[node] == 1; }
    Json reference(int index)
    {
        const std::size_t i = std::size_t(index);
        return is_inline(i) ? node_json(scene_.nodes[i], "") : Json(nodes_[i]);
    }
    Json shared_node_json(const Node& node, std::size_t i)
    {
        return is_inline(i) ? Json() : node_json(node, nodes_[i]);
    }

    /// name  name of the node's entry, or empty if it is written in place
    Json node_json(const Node& node, const std::string& name)
    {
        Json json = Json::object();
        put_unless_default(json, "name", node.name, name);
        put_unless_default(json, "transform", node.motion.empty() ? transform_json(node.parent_from_node) : Json());
        for (const NodeKey& key : node.motion) {
            json["motion"].push_back({{"time", number_json(key.time)}});
            put_unless_default(json["motion"].back(), "transform", transform_json(key.parent_from_node));
        }
        if (node.light >= 0) json["light"] = lights_[std::size_t(node.light)];
        if (node.camera >= 0) json["camera"] = cameras_[std::size_t(node.camera)];
        Json children = Json::array();
        if (node.shapes.size() == 1)
            add_shape(node.shapes[0], json);
        else
            for (const Shape& shape : node.shapes) {
                Json child = Json::object();
                put_unless_default(child, "name", shape.name, "");
                add_shape(shape, child);
                children.push_back(std::move(child));
            }
        for (const int child : node.children) children.push_back(reference(child));
        put_unless_default(json, "children", std::move(children), Json::array());
        return json;
    }

    void add_shape(const Shape& shape, Json& json) const
    {
        std::visit([&](const auto& geometry) { add_geometry(geometry, json); }, shape.geometry);
        if (shape.material >= 0) json["material"] = materials_[std::size_t(shape.material)];
    }
    void add_geometry(const MeshInstance& m, Json& json) const { json["mesh"] = meshes_[std::size_t(m.mesh)]; }
    void add_geometry(const CurvesInstance& c, Json& json) const { json["curves"] = curves_[std::size_t(c.curves)]; }
    void add_geometry(const PointsInstance& p, Json& json) const { json["points"] = points_[std::size_t(p.points)]; }
    static void add_geometry(const Sphere& s, Json& json)
    {
        Json& sphere = json["sphere"] = {{"center", vector_json(s.center)}, {"radius", number_json(s.radius)}};
        if (s.center_end) sphere["center_end"] = vector_json(*s.center_end);
    }
    static void add_geometry(const Rectangle& r, Json& json)
    {
        json["rectangle"] = {
            {"corner", vector_json(r.corner)}, {"edge_u", vector_json(r.edge_u)}, {"edge_v", vector_json(r.edge_v)}};
    }
    static void add_geometry(const Box& b, Json& json)
    {
        json["box"] = {{"min", vector_json(b.min)}, {"max", vector_json(b.max)}};
    }
    static void add_geometry(const Disk& d, Json& json)
    {
        json["disk"] = {
            {"center", vector_json(d.center)}, {"normal", vector_json(d.normal)}, {"radius", number_json(d.radius)}};
    }

    const SceneDescription& scene_;
    const std::string& file_;
    SaveFiles& files_;
    Warnings& warnings_;
    std::vector<std::string> cameras_, lights_, textures_, materials_, measured_, meshes_, curves_, points_, nodes_;
    std::vector<std::string> images_;  ///< paths of images in the scene file
    std::vector<int> uses_, heights_;  ///< indexed by node: number of references, and nesting depth of its descendants
    std::vector<bool> has_camera_, has_light_;
};

}  // namespace

Json scene_json(const SceneDescription& scene, const std::string& file, SaveFiles& files, Warnings& warnings)
{
    return SceneWriter(scene, file, files, warnings).write();
}

}  // namespace fathom
