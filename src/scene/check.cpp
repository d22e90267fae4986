#include "scene/check.h"

#include <cmath>
#include <string>

#include "fathom/error.h"

namespace fathom {

namespace {

constexpr int deepest_node = 256;
constexpr double most_places = 1e8;

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
            index(scene_.textures[i].image, scene_.images.size(), element("textures", i) + ".image", "image");
        for (std::size_t i = 0; i < scene_.materials.size(); ++i)
            check_material(scene_.materials[i], element("materials", i));
        for (std::size_t i = 0; i < scene_.meshes.size(); ++i) check_mesh(scene_.meshes[i], element("meshes", i));
        for (std::size_t i = 0; i < scene_.nodes.size(); ++i) check_node(scene_.nodes[i], element("nodes", i));
        for (std::size_t i = 0; i < scene_.roots.size(); ++i)
            required(scene_.roots[i], scene_.nodes.size(), element("roots", i), "node");
        index(scene_.environment.image, scene_.images.size(), "environment.image", "image");
        check_graph();
    }

private:
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

    void check_material(const Material& m, const std::string& place) const
    {
        for (const auto& [texture, name] :
             {std::pair{m.base_color.texture, ".base_color"},
              std::pair{m.transmission_color.texture, ".transmission_color"}, std::pair{m.roughness.texture, ".roughness"},
              std::pair{m.metallic.texture, ".metallic"}, std::pair{m.emission.texture, ".emission"},
              std::pair{m.alpha.texture, ".alpha"}, std::pair{m.normal_texture, ".normal_texture"}})
            if (texture != -1) required(texture, scene_.textures.size(), place + name, "texture");
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
            fail(place + ".indices", std::to_string(mesh.indices.size()) + " indices can't be divided by 3");
        for (std::size_t i = 0; i < mesh.indices.size(); ++i)
            if (mesh.indices[i] >= vertices)
                fail(place + '.' + element("indices", i),
                     "there is no vertex " + std::to_string(mesh.indices[i]) + ", only " + std::to_string(vertices));
        for (std::size_t i = 0; i < vertices; ++i) {
            const Vec3f p = mesh.positions[i];
            if (!(std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z)))
                fail(place + '.' + element("positions", i), "is not finite");
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

    void check_node(const Node& node, const std::string& place) const
    {
        for (const auto& row : node.parent_from_node.m)
            for (double value : row)
                if (!std::isfinite(value)) fail(place + ".parent_from_node", "the transform is not finite");
        for (std::size_t i = 0; i < node.children.size(); ++i)
            required(node.children[i], scene_.nodes.size(), place + '.' + element("children", i), "node");
        for (std::size_t i = 0; i < node.shapes.size(); ++i)
            check_shape(node.shapes[i], place + '.' + element("shapes", i));
        index(node.light, scene_.lights.size(), place + ".light", "light");
        index(node.camera, scene_.cameras.size(), place + ".camera", "camera");
    }

    /// Depth of the tree below each node, and nodes and shapes in it, each node visited once: instances make the tree
    /// exponentially larger than the file.
    void check_graph() const
    {
        enum class State : char { unseen, open, done };
        std::vector<State> states(scene_.nodes.size(), State::unseen);
        std::vector<int> depths(scene_.nodes.size(), 0);
        std::vector<double> places(scene_.nodes.size(), 0);
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
                places[i] = 1 + double(node.shapes.size());
                for (int child : node.children) {
                    depths[i] = std::max(depths[i], depths[std::size_t(child)] + 1);
                    places[i] += places[std::size_t(child)];
                }
                if (depths[i] >= deepest_node)
                    fail(element("nodes", i), "nodes are nested more than " + std::to_string(deepest_node) + " deep");
                if (places[i] > most_places)
                    fail(element("nodes", i), "instances make more than 100 million nodes and shapes of it");
                states[i] = State::done;
                stack.pop_back();
            }
        }
    }

    const SceneDescription& scene_;
};

}  // namespace

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
