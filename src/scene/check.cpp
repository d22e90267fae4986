// SPDX-License-Identifier: Apache-2.0
#include "scene/check.h"

#include <fmt/format.h>

#include <cmath>
#include <numbers>
#include <string>

#include "fathom/error.h"
#include "fathom/memory.h"
#include "scene/light_table.h"
#include "scene/material_table.h"
#include "scene/measured.h"
#include "scene/texture_table.h"

namespace fathom {

namespace {

constexpr int deepest_node = 256;
constexpr double max_places = 1e8;
constexpr float brightest = 1e20f;
constexpr const char* too_many_places = "its instances expand to more than 100 million nodes and shapes";

std::string element(const char* array, std::size_t index)
{
    return std::string(array) + '[' + std::to_string(index) + ']';
}

class Checker {
public:
    explicit Checker(const SceneDescription& scene) : scene_(scene) {}

    void check()
    {
        for (std::size_t i = 0; i < scene_.textures.size(); ++i)
            check_texture(scene_.textures[i], element("textures", i));
        check_texture_graph();
        for (std::size_t i = 0; i < scene_.materials.size(); ++i)
            check_material(scene_.materials[i], element("materials", i));
        check_mixtures();
        for (std::size_t i = 0; i < scene_.measured.size(); ++i)
            if (const std::string problem = problem_of(scene_.measured[i]); !problem.empty())
                fail(element("measured", i), problem);
        for (std::size_t i = 0; i < scene_.meshes.size(); ++i) check_mesh(scene_.meshes[i], element("meshes", i));
        for (std::size_t i = 0; i < scene_.curves.size(); ++i) check_curves(scene_.curves[i], element("curves", i));
        for (std::size_t i = 0; i < scene_.points.size(); ++i) {
            const Points& p = scene_.points[i];
            check_balls(p.centers, p.radii, element("points", i), "centers");
            for (std::size_t k = 0; k < p.radii.size(); ++k)
                if (p.radii[k] == 0) fail(element("points", i) + '.' + element("radii", k), "must be greater than 0");
        }
        for (std::size_t i = 0; i < scene_.nodes.size(); ++i) check_node(scene_.nodes[i], element("nodes", i));
        for (std::size_t i = 0; i < scene_.roots.size(); ++i)
            required(scene_.roots[i], scene_.nodes.size(), element("roots", i), "node");
        check_environment();
        for (std::size_t i = 0; i < scene_.lights.size(); ++i) check_light(i);
        check_graph();
    }

    void check(const SceneParts& parts) const
    {
        const auto each = [](const std::vector<int>& numbers, const auto& check) {
            for (const int i : numbers) check(std::size_t(i));
        };
        each(parts.nodes, [&](std::size_t i) { check_node(scene_.nodes[i], element("nodes", i)); });
        each(parts.meshes, [&](std::size_t i) { check_mesh(scene_.meshes[i], element("meshes", i)); });
        each(parts.materials, [&](std::size_t i) { check_material(scene_.materials[i], element("materials", i)); });
        if (!parts.materials.empty()) check_mixtures();
        each(parts.lights, [&](std::size_t i) { check_light(i); });
        check_environment();
    }

private:
    void check_environment() const
    {
        index(scene_.environment.image, scene_.images.size(), "environment.image", "image");
        for (const int face : scene_.environment.faces) index(face, scene_.images.size(), "environment.faces", "image");
        for (const Color& c : {scene_.environment.color, scene_.environment.bottom, scene_.environment.top})
            check_brightness(c, "environment");
        const double to_sun = length(scene_.environment.to_sun);
        if (!(to_sun > 0 && std::isfinite(to_sun))) fail("environment.to_sun", "is not a direction");
        const auto between = [&](double value, double least, double most, const char* what) {
            if (!(value >= least && value <= most))
                fail(std::string("environment.") + what,
                     fmt::format("is {:g}; a sky of this kind supports {:g} to {:g}", value, least, most));
        };
        if (!(scene_.environment.illuminance >= 0 && std::isfinite(scene_.environment.illuminance)))
            fail("environment.illuminance", "must be at least 0");
        if (scene_.environment.kind != EnvironmentKind::hosek_wilkie) return;
        between(scene_.environment.turbidity, 1, 10, "turbidity");
        between(scene_.environment.ground_albedo, 0, 1, "ground_albedo");
    }

    void check_light(std::size_t i) const
    {
        const Light& light = scene_.lights[i];
        const std::string place = element("lights", i);
        check_brightness(light.intensity, place);
        index(light.picture.image, scene_.images.size(), place + ".picture.image", "image");
        if (info_of(light.kind).needs_image && light.picture.image < 0)
            fail(place, fmt::format("a {} light needs an image or an IES file", info_of(light.kind).kind.name));
        if (light.kind == LightKind::projector && !(light.fov > 0 && light.fov < std::numbers::pi))
            fail(place + ".fov", "must be above 0 and below 180 degrees");
        for (const Parameter<Light>& p : light_parameters()) {
            const auto* const number = std::get_if<Field<Light, double>>(&p.member);
            if (!number || p.unit != 1 || !p.is_of(std::uint32_t(light.kind))) continue;
            if (const double value = (*number)(light); !p.allows(value) || !std::isfinite(value))
                fail(place + '.' + p.key, fmt::format("must be above {:g}", p.least));
        }
    }

    [[noreturn]] void fail(const std::string& place, const std::string& message) const
    {
        throw Error(scene_.file, place, message);
    }

    void required(int i, std::size_t size, const std::string& place, const char* what) const
    {
        if (i < 0 || std::size_t(i) >= size)
            fail(place,
                 "there is no " + std::string(what) + ' ' + std::to_string(i) + ", only " + std::to_string(size));
    }
    void index(int i, std::size_t size, const std::string& place, const char* what) const
    {
        if (i != -1) required(i, size, place, what);
    }

    /// Emission is limited so that sums over a scene don't overflow float.
    void check_brightness(const Color& c, const std::string& place) const
    {
        for (const float x : {c.r, c.g, c.b})
            if (!(std::abs(x) <= brightest))
                fail(place, fmt::format("has a brightness of {:g}; up to {:g} can be rendered", x, brightest));
    }

    void check_material(const Material& m, const std::string& place) const
    {
        check_brightness(m.emission.radiance.value, place + ".emission");
        for_each_texture(m, material_parameters(), [&](int texture, const char* key) {
            index(texture, scene_.textures.size(), place + '.' + key, "texture");
        });
        check_finite(m, material_parameters(), place);
        index(m.measured, scene_.measured.size(), place + ".measured", "measured surface");
        if (m.kind == MaterialKind::measured && m.measured < 0)
            fail(place, "a measured material needs a measured BRDF");
        if (!is_mixture(m)) return;
        required(m.mixture.material_a, scene_.materials.size(), place + ".material_a", "material");
        required(m.mixture.material_b, scene_.materials.size(), place + ".material_b", "material");
    }

    static bool is_mixture(const Material& m)
    {
        return m.kind == MaterialKind::mix || m.kind == MaterialKind::two_sided;
    }

    /// Throws Error if a mixture contains itself or mixtures are nested too deeply.
    void check_mixtures() const
    {
        constexpr int deepest = 16;
        std::vector<int> depth(scene_.materials.size(), 0);
        // Depths grow until they are stable, as in check_texture_graph().
        for (bool grown = true; grown;) {
            grown = false;
            for (std::size_t i = 0; i < scene_.materials.size(); ++i) {
                const Material& m = scene_.materials[i];
                if (!is_mixture(m)) continue;
                const int below =
                    std::max(depth[std::size_t(m.mixture.material_a)], depth[std::size_t(m.mixture.material_b)]);
                if (below < depth[i]) continue;
                depth[i] = below + 1;
                grown = true;
                if (depth[i] > deepest)
                    fail(element("materials", i),
                         "materials are mixed more than " + std::to_string(deepest) + " deep, or one contains itself");
            }
        }
    }

    void check_texture(const Texture& t, const std::string& place) const
    {
        index(t.image, scene_.images.size(), place + ".image", "image");
        for_each_texture(t, texture_parameters(), [&](int texture, const char* key) {
            index(texture, scene_.textures.size(), place + '.' + key, "texture");
        });
        check_finite(t, texture_parameters(), place);
        if (!std::isnormal(t.world_from_texture.determinant()))
            fail(place + ".transform", "the transform of a texture must be invertible");
        if (t.kind == TextureKind::facing && !(length(t.direction) > 0))
            fail(place + ".direction", "is not a direction: all components are 0");
        if (t.kind != TextureKind::ramp) return;
        if (t.stops.size() < 2 || t.stops.size() > 16)
            fail(place + ".stops", std::to_string(t.stops.size()) + " stops: a ramp must have 2 to 16");
        for (std::size_t i = 0; i < t.stops.size(); ++i)
            if (!std::isfinite(t.stops[i].position) || (i > 0 && !(t.stops[i - 1].position < t.stops[i].position)))
                fail(place + '.' + element("stops", i), "positions must be finite and increase");
    }

    template <class Owner>
    void check_finite(const Owner& owner, std::span<const Parameter<Owner>> parameters, const std::string& place) const
    {
        const auto is_finite = [](const auto& value) {
            using T = std::decay_t<decltype(value)>;
            if constexpr (std::is_same_v<T, Color>)
                return std::isfinite(value.r) && std::isfinite(value.g) && std::isfinite(value.b);
            else if constexpr (std::is_same_v<T, Vec2f>)
                return std::isfinite(value.x) && std::isfinite(value.y);
            else if constexpr (std::is_same_v<T, Vec3d>)
                return std::isfinite(value.x) && std::isfinite(value.y) && std::isfinite(value.z);
            else if constexpr (std::is_same_v<T, Transform>)
                return std::isfinite(value.determinant()) && std::isfinite(length(value.point({})));
            else if constexpr (std::is_floating_point_v<T>)
                return std::isfinite(value);
            else
                return true;
        };
        for (const Parameter<Owner>& p : parameters)
            std::visit(
                [&](auto member) {
                    const auto& value = member(owner);
                    bool finite = is_finite(value);
                    if constexpr (requires { value.value; }) finite = is_finite(value.value);
                    if (!finite) fail(place + '.' + p.key, "is not finite");
                },
                p.member);
    }

    /// Throws Error if a texture refers to itself, directly or indirectly, or references are nested too deeply.
    void check_texture_graph() const
    {
        constexpr int deepest = 16;
        std::vector<int> depth(scene_.textures.size(), 0);
        // Depths of the reference graph grow until they are stable; with a cycle they never are, so the limit is
        // exceeded.
        for (;;) {
            bool grown = false;
            for (std::size_t i = 0; i < scene_.textures.size(); ++i)
                for_each_texture(scene_.textures[i], texture_parameters(), [&](int texture, const char*) {
                    if (texture < 0 || depth[std::size_t(texture)] < depth[i]) return;
                    depth[i] = depth[std::size_t(texture)] + 1;
                    grown = true;
                    if (depth[i] > deepest)
                        fail(element("textures", i), "textures are nested more than " + std::to_string(deepest) +
                                                         " deep, or one contains itself");
                });
            if (!grown) return;
        }
    }

    void check_mesh(const Mesh& mesh, const std::string& place) const
    {
        const std::size_t vertices = mesh.positions.size();
        const auto length_is = [&](std::size_t size, const char* name) {
            if (size != 0 && size != vertices)
                fail(place + name,
                     "has " + std::to_string(size) + " elements for " + std::to_string(vertices) + " positions");
        };
        length_is(mesh.normals.size(), ".normals");
        length_is(mesh.tangents.size(), ".tangents");
        length_is(mesh.uvs[0].size(), ".uvs[0]");
        length_is(mesh.uvs[1].size(), ".uvs[1]");
        length_is(mesh.colors.size(), ".colors");
        if (mesh.indices.size() % 3 != 0)
            fail(place + ".indices", std::to_string(mesh.indices.size()) + " indices are not a multiple of 3");
        for (std::size_t i = 0; i < mesh.indices.size(); ++i)
            if (mesh.indices[i] >= vertices)
                fail(place + '.' + element("indices", i),
                     "there is no vertex " + std::to_string(mesh.indices[i]) + ", only " + std::to_string(vertices));
        check_positions(mesh.positions, place);
        check_times(mesh.motion, place);
        for (std::size_t k = 0; k < mesh.motion.size(); ++k) {
            const MeshKey& key = mesh.motion[k];
            const std::string at = place + '.' + element("motion", k);
            if (key.positions.size() != vertices || key.normals.size() != mesh.normals.size())
                fail(at, "has " + std::to_string(key.positions.size()) + " positions and " +
                             std::to_string(key.normals.size()) + " normals, but the mesh has " +
                             std::to_string(vertices) + " and " + std::to_string(mesh.normals.size()));
            check_positions(key.positions, at);
        }
    }

    void check_positions(const std::vector<Vec3f>& positions, const std::string& place) const
    {
        for (std::size_t i = 0; i < positions.size(); ++i) {
            const Vec3f p = positions[i];
            if (!(std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z)))
                fail(place + '.' + element("positions", i), "is not finite");
        }
    }

    template <class Key>
    void check_times(const std::vector<Key>& keys, const std::string& place) const
    {
        if (keys.size() == 1) fail(place + ".motion", "has one key; motion needs at least two");
        for (std::size_t i = 0; i < keys.size(); ++i)
            if (!std::isfinite(keys[i].time) || (i > 0 && !(keys[i - 1].time < keys[i].time)))
                fail(place + '.' + element("motion", i) + ".time", "times must be finite and increase");
    }

    void check_balls(const std::vector<Vec3f>& centers, const std::vector<float>& radii, const std::string& place,
                     const char* name) const
    {
        if (centers.size() != radii.size())
            fail(place,
                 "has " + std::to_string(radii.size()) + " radii for " + std::to_string(centers.size()) + ' ' + name);
        for (std::size_t i = 0; i < centers.size(); ++i) {
            const Vec3f p = centers[i];
            if (!finite({p.x, p.y, p.z})) fail(place + '.' + element(name, i), "is not finite");
            if (!std::isfinite(radii[i]) || radii[i] < 0)
                fail(place + '.' + element("radii", i), "must be finite and not negative");
        }
    }

    void check_curves(const Curves& curves, const std::string& place) const
    {
        check_balls(curves.points, curves.radii, place, "points");
        std::size_t sum = 0;
        const std::size_t least = curves.basis == CurveBasis::linear ? 2 : 4;
        for (std::size_t i = 0; i < curves.counts.size(); ++i) {
            const std::size_t n = curves.counts[i];
            sum += n;
            if (n < least || (curves.basis == CurveBasis::bezier && n % 3 != 1))
                fail(place + '.' + element("counts", i),
                     std::to_string(n) + " points don't make a curve of this basis");
        }
        if (sum != curves.points.size())
            fail(place + ".counts", "sum to " + std::to_string(sum) + ", but there are " +
                                        std::to_string(curves.points.size()) + " points");
        check_times(curves.motion, place);
        for (std::size_t k = 0; k < curves.motion.size(); ++k) {
            const CurvesKey& key = curves.motion[k];
            const std::string at = place + '.' + element("motion", k);
            if (key.points.size() != curves.points.size())
                fail(at, "has " + std::to_string(key.points.size()) + " points, but the curves have " +
                             std::to_string(curves.points.size()));
            check_balls(key.points, key.radii, at, "points");
        }
    }

    static bool finite(Vec3d v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }

    void check_shape(const Shape& shape, const std::string& place) const
    {
        if (shape.material != -1) required(shape.material, scene_.materials.size(), place + ".material", "material");
        bool is_finite = true;
        if (const auto* mesh = std::get_if<MeshInstance>(&shape.geometry)) {
            required(mesh->mesh, scene_.meshes.size(), place + ".mesh", "mesh");
        } else if (const auto* s = std::get_if<Sphere>(&shape.geometry)) {
            is_finite = finite(s->center) && std::isfinite(s->radius) && (!s->center_end || finite(*s->center_end));
        } else if (const auto* r = std::get_if<Rectangle>(&shape.geometry)) {
            is_finite = finite(r->corner) && finite(r->edge_u) && finite(r->edge_v);
        } else if (const auto* b = std::get_if<Box>(&shape.geometry)) {
            is_finite = finite(b->min) && finite(b->max);
        } else if (const auto* d = std::get_if<Disk>(&shape.geometry)) {
            is_finite = finite(d->center) && finite(d->normal) && std::isfinite(d->radius);
        }
        if (!is_finite) fail(place, "a position or size is not finite");
    }

    void check_transform(const Transform& t, const std::string& place) const
    {
        for (const auto& row : t.m)
            for (double value : row)
                if (!std::isfinite(value)) fail(place + ".parent_from_node", "the transform is not finite");
    }

    void check_node(const Node& node, const std::string& place) const
    {
        check_transform(node.parent_from_node, place);
        check_times(node.motion, place);
        for (std::size_t i = 0; i < node.motion.size(); ++i) {
            const std::string at = place + '.' + element("motion", i);
            check_transform(node.motion[i].parent_from_node, at);
            const double determinant = node.motion[i].parent_from_node.determinant();
            if (!std::isnormal(determinant)) fail(at, "the transform of a moving node must be invertible");
            if ((determinant < 0) != (node.motion[0].parent_from_node.determinant() < 0))
                fail(at, "only one of this key and the first key mirrors: in between, the node would be flat");
        }
        for (std::size_t i = 0; i < node.children.size(); ++i)
            required(node.children[i], scene_.nodes.size(), place + '.' + element("children", i), "node");
        for (std::size_t i = 0; i < node.shapes.size(); ++i)
            check_shape(node.shapes[i], place + '.' + element("shapes", i));
        index(node.light, scene_.lights.size(), place + ".light", "light");
        index(node.camera, scene_.cameras.size(), place + ".camera", "camera");
    }

    /// Checks depth, nodes and shapes of the tree below each node. Each node is visited once: instances make the tree
    /// exponentially larger than the file.
    void check_graph() const
    {
        enum class State : char { unseen, open, done };
        std::vector<State> states(scene_.nodes.size(), State::unseen);
        std::vector<int> depths(scene_.nodes.size(), 0);
        std::vector<double> places(scene_.nodes.size(), 0), shapes(scene_.nodes.size(), 0);
        struct Visit {
            int node;
            std::size_t next_child;
        };
        std::vector<Visit> stack;
        for (std::size_t start = 0; start < scene_.nodes.size(); ++start) {
            if (states[start] != State::unseen) continue;
            stack.push_back({int(start), 0});
            states[start] = State::open;
            while (!stack.empty()) {
                Visit& visit = stack.back();
                const std::size_t i = std::size_t(visit.node);
                const Node& node = scene_.nodes[i];
                if (visit.next_child < node.children.size()) {
                    const std::size_t child = std::size_t(node.children[visit.next_child]);
                    const std::string place = element("nodes", i) + '.' + element("children", visit.next_child);
                    if (states[child] == State::open) fail(place, "a node can't contain itself");
                    ++visit.next_child;
                    if (states[child] == State::unseen) {
                        states[child] = State::open;
                        stack.push_back({int(child), 0});
                    }
                    continue;
                }
                shapes[i] = double(node.shapes.size());
                places[i] = 1 + shapes[i];
                for (int child : node.children) {
                    depths[i] = std::max(depths[i], depths[std::size_t(child)] + 1);
                    places[i] += places[std::size_t(child)];
                    shapes[i] += shapes[std::size_t(child)];
                }
                if (depths[i] >= deepest_node)
                    fail(element("nodes", i), "nodes are nested more than " + std::to_string(deepest_node) + " deep");
                if (places[i] > max_places) fail(element("nodes", i), too_many_places);
                states[i] = State::done;
                stack.pop_back();
            }
        }
        double all_places = 0, all_shapes = 0;
        for (int root : scene_.roots) {
            all_places += places[std::size_t(root)];
            all_shapes += shapes[std::size_t(root)];
        }
        if (all_places > max_places) fail("roots", too_many_places);
        // Small scenes skip the query of available memory.
        const double bytes = all_shapes * bytes_per_occurrence;
        if (bytes > 1e6 && bytes > double(available_memory_bytes()))
            fail("", fmt::format("its instances make {:.0f} shapes, which need about {:.1f} GB of memory; {}",
                                 all_shapes, bytes / 1e9, available_memory_text()));
    }

    const SceneDescription& scene_;
};

}  // namespace

void check_parts(const SceneDescription& scene, const SceneParts& parts)
{
    Checker(scene).check(parts);
}

void check_scene(const SceneDescription& scene)
{
    Checker(scene).check();
}

std::vector<bool> reachable_nodes(const SceneDescription& scene)
{
    std::vector<bool> reachable(scene.nodes.size(), false);
    std::vector<int> todo(scene.roots.begin(), scene.roots.end());
    while (!todo.empty()) {
        const std::size_t i = std::size_t(todo.back());
        todo.pop_back();
        if (reachable[i]) continue;
        reachable[i] = true;
        todo.insert(todo.end(), scene.nodes[i].children.begin(), scene.nodes[i].children.end());
    }
    return reachable;
}

}  // namespace fathom
