#include <algorithm>
#include <cmath>
#include <fmt/format.h>

#include "compile/compiler.h"
#include "compile/parallelograms.h"
#include "compile/tessellate.h"
#include "fathom/error.h"

namespace fathom {

namespace {

/// A linear map that keeps angles up to rounding, and its factor.
bool is_similarity(const Transform& t, double& factor)
{
    const Vec3d x = t.vector({1, 0, 0}), y = t.vector({0, 1, 0}), z = t.vector({0, 0, 1});
    factor = length(x);
    const double tolerance = 1e-5 * factor * factor;
    return std::abs(length(y) - factor) * factor <= tolerance && std::abs(length(z) - factor) * factor <= tolerance &&
           std::abs(dot(x, y)) <= tolerance && std::abs(dot(y, z)) <= tolerance && std::abs(dot(x, z)) <= tolerance;
}

class GeometryCompiler {
public:
    explicit GeometryCompiler(Compiler& c) : c_(c), t_(c.tables) {}

    void run(const std::vector<PlacedShape>& placed)
    {
        const std::vector<int> uses = count_uses(placed);
        const bool joins = count_triangles(placed) <= most_joined_triangles;
        std::vector<const PlacedShape*> instanced;
        // Triangles in render space come first, then those of instanced meshes, then the other kinds.
        for (const PlacedShape& p : placed)
            if (const auto* mesh = std::get_if<MeshInstance>(&p.shape->geometry)) {
                if (uses[std::size_t(mesh->mesh)] > 0)
                    instanced.push_back(&p);
                else if (const Mesh& m = c_.scene.meshes[std::size_t(mesh->mesh)]; joins && is_plain(p, m))
                    join_triangles(p, m);
                else
                    add_mesh(p, m, p.render_from_node);
            } else if (needs_tessellation(p)) {
                add_mesh(p, tessellate(p.shape->geometry), p.render_from_node);
            }
        t_.world_triangles = t_.triangle_count();
        std::vector<std::uint32_t> mesh_shapes(c_.scene.meshes.size(), no_index);
        for (const PlacedShape* p : instanced) add_instance(*p, mesh_shapes);
        for (const auto& [p, rectangles] : joined_) add_rectangles(*p, rectangles);
        for (const PlacedShape& p : placed)
            if (const auto* r = std::get_if<Rectangle>(&p.shape->geometry)) add_rectangles(p, {*r});
            else if (const auto* b = std::get_if<Box>(&p.shape->geometry)) add_box(p, *b);
        for (const PlacedShape& p : placed)
            if (const auto* s = std::get_if<Sphere>(&p.shape->geometry); s && !needs_tessellation(p)) add_sphere(p, *s);
        for (const PlacedShape& p : placed)
            if (const auto* d = std::get_if<Disk>(&p.shape->geometry); d && !needs_tessellation(p)) add_disk(p, *d);
        if (degenerate_ > 0)
            c_.warnings.add(fmt::format("{}: degenerate triangles, which have no area and are never seen", c_.scene.file), degenerate_);
        fill_missing_attributes();
    }

private:
    /// How often each mesh is placed, if often enough to be worth an instance; else 0.
    std::vector<int> count_uses(const std::vector<PlacedShape>& placed) const
    {
        std::vector<int> uses(c_.scene.meshes.size());
        for (const PlacedShape& p : placed)
            if (const auto* mesh = std::get_if<MeshInstance>(&p.shape->geometry)) ++uses[std::size_t(mesh->mesh)];
        for (std::size_t i = 0; i < uses.size(); ++i)
            if (uses[i] < 2 || c_.scene.meshes[i].indices.size() / 3 * std::size_t(uses[i]) < 4096) uses[i] = 0;
        // Emissive triangles are lights of their own, each where it stands.
        for (const PlacedShape& p : placed)
            if (const auto* mesh = std::get_if<MeshInstance>(&p.shape->geometry); mesh && emits(*p.shape))
                uses[std::size_t(mesh->mesh)] = 0;
        return uses;
    }

    /// Triangles are joined to parallelograms where a scene is small enough to be traced as a list.
    static constexpr std::size_t most_joined_triangles = 192;

    std::size_t count_triangles(const std::vector<PlacedShape>& placed) const
    {
        std::size_t n = 0;
        for (const PlacedShape& p : placed)
            if (const auto* mesh = std::get_if<MeshInstance>(&p.shape->geometry))
                n += c_.scene.meshes[std::size_t(mesh->mesh)].indices.size() / 3;
        return n;
    }

    /// Nothing but positions matters: the picture of a parallelogram is that of its two triangles.
    bool is_plain(const PlacedShape& p, const Mesh& mesh) const
    {
        const MaterialTable& m = t_.materials[material_of(*p.shape)];
        const bool textured = (m.flags & (MaterialTable::textured | MaterialTable::normal_mapped)) || m.emission_texture != no_index;
        return mesh.normals.empty() && !textured && m.alpha_mode == std::uint32_t(AlphaMode::opaque);
    }

    void join_triangles(const PlacedShape& p, const Mesh& mesh)
    {
        Parallelograms pairs = pair_triangles(mesh);
        if (!pairs.found.empty()) joined_.emplace_back(&p, std::move(pairs.found));
        if (pairs.triangles.empty()) return;
        Mesh rest;
        rest.positions = mesh.positions;
        rest.indices = std::move(pairs.triangles);
        add_mesh(p, rest, p.render_from_node);
    }

    std::uint32_t material_of(const Shape& shape) const
    {
        return shape.material >= 0 ? std::uint32_t(shape.material) : std::uint32_t(t_.materials.size() - 1);
    }
    bool emits(const Shape& shape) const { return t_.materials[material_of(shape)].flags & MaterialTable::emits; }

    static bool needs_tessellation(const PlacedShape& p)
    {
        double factor;
        return (std::holds_alternative<Sphere>(p.shape->geometry) || std::holds_alternative<Disk>(p.shape->geometry)) &&
               !is_similarity(p.render_from_node, factor);
    }

    ShapeTable& add_shape(const PlacedShape& p, std::uint32_t first_primitive, bool mirrored)
    {
        ShapeTable shape;
        shape.material = material_of(*p.shape);
        const MaterialTable& material = t_.materials[shape.material];
        if (material.alpha_mode != std::uint32_t(AlphaMode::opaque)) shape.flags |= ShapeTable::alpha_tested;
        if (mirrored) shape.flags |= ShapeTable::flipped;
        shape.first_primitive = first_primitive;
        shape.object_id = p.object_id;
        t_.shapes.push_back(shape);
        return t_.shapes.back();
    }

    /// Numbers `count` primitives of the last shape.
    void take_primitives(std::size_t count)
    {
        if (t_.shape_of_primitive.size() + count > 0x7fffffffu) throw Error(c_.scene.file, "", "more than 2^31 primitives");
        t_.shape_of_primitive.insert(t_.shape_of_primitive.end(), count, std::uint32_t(t_.shapes.size() - 1));
    }

    void add_mesh(const PlacedShape& p, const Mesh& mesh, const Transform& transform)
    {
        const bool mirrored = transform.determinant() < 0;
        ShapeTable& shape = add_shape(p, t_.triangle_count(), mirrored);
        const std::size_t base = t_.positions.size();
        if (base + mesh.positions.size() > 0x7fffffffu) throw Error(c_.scene.file, "", "more than 2^31 vertices");
        // Normals go by the inverse transpose; its scale does not matter.
        const Transform inverse = transform.inverse();
        for (Vec3f q : mesh.positions) t_.positions.push_back(to_float(transform.point(to_double(q))));
        if (!mesh.normals.empty()) {
            shape.flags |= ShapeTable::has_normals;
            pad(t_.normals, base);
            for (Vec3f n : mesh.normals) t_.normals.push_back(to_float(normal(inverse, to_double(n))));
        }
        if (!mesh.tangents.empty()) {
            shape.flags |= ShapeTable::has_tangents;
            pad(t_.tangents, base);
            for (Vec4f v : mesh.tangents) {
                const Vec3d d = normalize(transform.vector({v.x, v.y, v.z}));
                t_.tangents.push_back({float(d.x), float(d.y), float(d.z), mirrored ? -v.w : v.w});
            }
        }
        copy(mesh.uvs[0], t_.uv0, base, shape, ShapeTable::has_uv0);
        copy(mesh.uvs[1], t_.uv1, base, shape, ShapeTable::has_uv1);
        copy(mesh.colors, t_.colors, base, shape, ShapeTable::has_colors);
        for (std::uint32_t i : mesh.indices) t_.triangles.push_back(std::uint32_t(base) + i);
        count_degenerate(t_.triangles.size() - mesh.indices.size());
        take_primitives(mesh.indices.size() / 3);
    }

    static Vec3d normal(const Transform& inverse, Vec3d n)
    {
        const auto& m = inverse.m;
        return normalize({m[0][0] * n.x + m[1][0] * n.y + m[2][0] * n.z, m[0][1] * n.x + m[1][1] * n.y + m[2][1] * n.z,
                          m[0][2] * n.x + m[1][2] * n.y + m[2][2] * n.z});
    }

    template <class T>
    static void pad(std::vector<T>& v, std::size_t size)
    {
        if (v.size() < size) v.resize(size);
    }
    template <class T>
    static void copy(const std::vector<T>& from, std::vector<T>& to, std::size_t base, ShapeTable& shape, std::uint32_t flag)
    {
        if (from.empty()) return;
        shape.flags |= flag;
        pad(to, base);
        to.insert(to.end(), from.begin(), from.end());
    }
    /// Arrays that some mesh has reach over the vertices of all.
    void fill_missing_attributes()
    {
        const std::size_t n = t_.positions.size();
        const auto fill = [&](auto& v) {
            if (!v.empty()) v.resize(n);
        };
        fill(t_.normals), fill(t_.tangents), fill(t_.uv0), fill(t_.uv1), fill(t_.colors);
    }

    void count_degenerate(std::size_t from)
    {
        for (std::size_t i = from; i + 2 < t_.triangles.size(); i += 3) {
            const Vec3d a = to_double(t_.positions[t_.triangles[i]]), b = to_double(t_.positions[t_.triangles[i + 1]]),
                        d = to_double(t_.positions[t_.triangles[i + 2]]);
            const Vec3d n = cross(b - a, d - a);
            if (dot(n, n) == 0) ++degenerate_;
        }
    }

    void add_instance(const PlacedShape& p, std::vector<std::uint32_t>& mesh_shapes)
    {
        const int mesh = std::get<MeshInstance>(p.shape->geometry).mesh;
        std::uint32_t& mesh_shape = mesh_shapes[std::size_t(mesh)];
        if (mesh_shape == no_index) {
            mesh_shape = std::uint32_t(t_.shapes.size());
            add_mesh(p, c_.scene.meshes[std::size_t(mesh)], Transform());
        }
        // A shape without primitives of its own: the instance's material, flags and id.
        ShapeTable shape = t_.shapes[mesh_shape];
        shape.material = material_of(*p.shape);
        shape.flags &= ~std::uint32_t(ShapeTable::alpha_tested | ShapeTable::flipped);
        if (t_.materials[shape.material].alpha_mode != std::uint32_t(AlphaMode::opaque)) shape.flags |= ShapeTable::alpha_tested;
        if (p.render_from_node.determinant() < 0) shape.flags |= ShapeTable::flipped;
        shape.object_id = p.object_id;
        InstanceTable instance;
        const Transform inverse = p.render_from_node.inverse();
        for (std::size_t i = 0; i < 12; ++i) {
            instance.render_from_object[i] = float(p.render_from_node.m[i / 4][i % 4]);
            instance.object_from_render[i] = float(inverse.m[i / 4][i % 4]);
        }
        instance.shape = std::uint32_t(t_.shapes.size());
        instance.mesh_shape = mesh_shape;
        t_.shapes.push_back(shape);
        t_.instances.push_back(instance);
    }

    void add_quad(const PlacedShape& p, Vec3d corner, Vec3d u, Vec3d v)
    {
        t_.quads.push_back({to_float(p.render_from_node.point(corner)), to_float(p.render_from_node.vector(u)),
                            to_float(p.render_from_node.vector(v))});
        take_primitives(1);
    }
    void add_rectangles(const PlacedShape& p, const std::vector<Rectangle>& rectangles)
    {
        add_shape(p, t_.first_quad() + std::uint32_t(t_.quads.size()), p.render_from_node.determinant() < 0);
        for (const Rectangle& r : rectangles) add_quad(p, r.corner, r.edge_u, r.edge_v);
    }
    void add_box(const PlacedShape& p, const Box& b)
    {
        add_shape(p, t_.first_quad() + std::uint32_t(t_.quads.size()), p.render_from_node.determinant() < 0);
        const Vec3d d = b.max - b.min;
        const Vec3d x{d.x, 0, 0}, y{0, d.y, 0}, z{0, 0, d.z};
        add_quad(p, b.min, z, y);       // -x
        add_quad(p, b.min + x, y, z);   // +x
        add_quad(p, b.min, x, z);       // -y
        add_quad(p, b.min + y, z, x);   // +y
        add_quad(p, b.min, y, x);       // -z
        add_quad(p, b.min + z, x, y);   // +z
    }
    void add_sphere(const PlacedShape& p, const Sphere& s)
    {
        double factor;
        is_similarity(p.render_from_node, factor);
        add_shape(p, t_.first_sphere() + std::uint32_t(t_.spheres.size()), false);
        SphereTable sphere;
        const Vec3d center = p.render_from_node.point(s.center);
        sphere.center = to_float(center);
        sphere.radius = float(s.radius * factor);
        if (s.center_end) {
            sphere.motion = to_float(p.render_from_node.point(*s.center_end) - center);
            t_.moving = true;
        }
        t_.spheres.push_back(sphere);
        take_primitives(1);
    }
    void add_disk(const PlacedShape& p, const Disk& d)
    {
        double factor;
        is_similarity(p.render_from_node, factor);
        add_shape(p, t_.first_disk() + std::uint32_t(t_.disks.size()), false);
        const Vec3d n = normal(p.render_from_node.inverse(), d.normal);
        t_.disks.push_back({to_float(p.render_from_node.point(d.center)), to_float(n), float(d.radius * factor)});
        take_primitives(1);
    }

    Compiler& c_;
    SceneTables& t_;
    std::size_t degenerate_ = 0;
    std::vector<std::pair<const PlacedShape*, std::vector<Rectangle>>> joined_;  ///< shapes of joined triangles
};

}  // namespace

void compile_geometry(Compiler& c, const std::vector<PlacedShape>& shapes)
{
    GeometryCompiler(c).run(shapes);
}

}  // namespace fathom
