// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <utility>

#include "compile/check_sizes.h"
#include "compile/compiler.h"
#include "fathom/error.h"
#include "geometry/compile/curves.h"
#include "geometry/compile/instancing.h"
#include "geometry/compile/parallelograms.h"
#include "geometry/compile/poses.h"
#include "scene/motion.h"
#include "scene/tessellate.h"

namespace fathom {

namespace {

/// Calls f(positions, normals) for each pose of the mesh that the tables hold, in order.
template <class F>
void for_each_pose(const SceneTables& tables, const Mesh& mesh, bool moves, const F& f)
{
    if (mesh.motion.empty()) return f(mesh.positions, mesh.normals);
    const auto at = [&](float time) {
        const MeshKey key = vertices_at(mesh, time);
        f(key.positions, key.normals);
    };
    if (!moves) return at(tables.shutter_open);
    for (float time : tables.vertex_times) at(time);
}

Vec4f unit_tangent(const Vec4f& v, const Transform& transform)
{
    const Vec3d d = normalize(transform.vector({v.x, v.y, v.z}));
    return {float(d.x), float(d.y), float(d.z), transform.determinant() < 0 ? -v.w : v.w};
}

class GeometryCompiler {
public:
    GeometryCompiler(Compiler& c, const FlattenedScene& occurrences) : c_(c), t_(c.tables), instancing_(c, occurrences)
    {
    }

    InstancedGeometry run(FlattenedScene& all)
    {
        std::vector<FlattenedShape>& shapes = all.shapes;
        t_.vertex_times = instancing_.vertex_times();
        t_.moving = !t_.vertex_times.empty();
        const bool joins = count_triangles(shapes) <= max_joined_triangles;
        find_solids(shapes);
        std::vector<const FlattenedShape*> instanced, rest;
        // Triangles in render space come first, then those of instanced meshes, then the other kinds of primitives.
        for (FlattenedShape& p : shapes)
            if (p.instanced = instancing_.is_instanced(p); p.instanced)
                instanced.push_back(&p);
            else if (const Mesh* mesh = c_.mesh_of(*p.shape); !mesh && !needs_tessellation(p))
                rest.push_back(&p);
            else if (!mesh)
                add_mesh(p, tessellate(p.shape->geometry), p.render_from_node);
            else if (joins && is_plain(p, *mesh))
                join_triangles(p, *mesh);
            else
                add_mesh(p, *mesh, p.render_from_node);
        t_.world_triangles = t_.triangle_count();
        for (const FlattenedShape* p : instanced) place_primitives<MeshInstance>(*p);
        for (const auto& [p, rectangles] : joined_) add_rectangles(*p, rectangles);
        add_all<Rectangle, Box>(rest, instanced, all);
        add_all<Sphere>(rest, instanced, all);
        add_all<Disk>(rest, instanced, all);
        add_all<CurvesInstance>(rest, instanced, all);
        add_all<PointsInstance>(rest, instanced, all);
        if (degenerate_ > 0)
            c_.warnings.add(fmt::format("{}: degenerate triangles, which have no area and are ignored", c_.scene.file),
                            degenerate_);
        if (opaque_ > 0) c_.warnings.add(fmt::format(alpha_unsupported, c_.scene.file), opaque_);
        fill_missing_attributes();
        contents_.shapes_end = t_.shapes.size();
        contents_.moving = t_.moving;
        return std::move(contents_);
    }

private:
    /// Adds primitives of these kinds: first the shapes in the world, then those of instances.
    template <class... Kinds>
    void add_all(const std::vector<const FlattenedShape*>& rest, const std::vector<const FlattenedShape*>& instanced,
                 const FlattenedScene& all)
    {
        for (const FlattenedShape* p : rest)
            if ((is_of<Kinds>(*p->shape) || ...))
                add_primitives(*p, p->motion >= 0 ? &all.motions[std::size_t(p->motion)] : nullptr);
        for (const FlattenedShape* p : instanced) (place_primitives<Kinds>(*p), ...);
    }

    /// Whether a shape becomes primitives of this kind. Displaced shapes are meshes.
    template <class Kind>
    bool is_of(const Shape& shape) const
    {
        if (c_.mesh_of(shape)) return std::is_same_v<Kind, MeshInstance>;
        return std::holds_alternative<Kind>(shape.geometry);
    }

    /// Adds the primitives of an instanced shape in its own space, once per content.
    template <class Kind>
    void place_primitives(const FlattenedShape& p)
    {
        if (!is_of<Kind>(*p.shape)) return;
        if (!contents_.shapes.emplace(shared_geometry(c_, *p.shape), std::uint32_t(t_.shapes.size())).second) return;
        FlattenedShape own = p;
        own.render_from_node = Transform();
        add_primitives(own, nullptr);
        t_.shapes.back().flags |= ShapeRecord::only_instanced;
    }

    void add_primitives(const FlattenedShape& p, const std::vector<NodeKey>* poses)
    {
        if (const Mesh* mesh = c_.mesh_of(*p.shape)) return add_mesh(p, *mesh, p.render_from_node);
        if (const auto* r = std::get_if<Rectangle>(&p.shape->geometry)) add_rectangles(p, {*r});
        if (const auto* b = std::get_if<Box>(&p.shape->geometry)) add_box(p, *b);
        if (const auto* s = std::get_if<Sphere>(&p.shape->geometry)) add_sphere(p, *s, poses);
        if (const auto* d = std::get_if<Disk>(&p.shape->geometry)) add_disk(p, *d);
        if (const auto* c = std::get_if<CurvesInstance>(&p.shape->geometry))
            add_curves(p, c_.scene.curves[std::size_t(c->curves)]);
        if (const auto* q = std::get_if<PointsInstance>(&p.shape->geometry))
            add_points(p, c_.scene.points[std::size_t(q->points)]);
    }

    /// Lists contents that are solid, and those that are hair, in any of their occurrences.
    void find_solids(const std::vector<FlattenedShape>& shapes)
    {
        for (const FlattenedShape& p : shapes) {
            const MaterialRecord& m = t_.materials[material_of(*p.shape)];
            if (m.has_inside()) solids_.insert(shared_geometry(c_, *p.shape));
            if (m.closure == ClosureKind::hair) fibers_.insert(shared_geometry(c_, *p.shape));
        }
    }

    /// Scenes with up to this many triangles merge pairs of them into parallelograms, as they may be traced as a flat
    /// list.
    static constexpr std::size_t max_joined_triangles = 192;

    std::size_t count_triangles(const std::vector<FlattenedShape>& shapes) const
    {
        std::size_t n = 0;
        for (const FlattenedShape& p : shapes)
            if (const Mesh* mesh = c_.mesh_of(*p.shape)) n += mesh->indices.size() / 3;
        return n;
    }

    /// Whether texture coordinates or tangents affect the appearance of a material.
    static bool shows_uv(const MaterialRecord& m)
    {
        using enum MaterialFeature;
        return m.features.has_any(textured | normal_mapped | bumped | needs_tangent | needs_uv);
    }

    /// Whether a parallelogram would look exactly like its two triangles: only positions matter.
    bool is_plain(const FlattenedShape& p, const Mesh& mesh) const
    {
        const MaterialRecord& m = t_.materials[material_of(*p.shape)];
        return (mesh.normals.empty() || has_flat_normals(mesh)) && mesh.motion.empty() && !shows_uv(m) &&
               m.alpha_mode == std::uint32_t(AlphaMode::opaque);
    }

    void join_triangles(const FlattenedShape& p, const Mesh& mesh)
    {
        Parallelograms pairs = pair_triangles(mesh);
        if (pairs.found.empty()) return add_mesh(p, mesh, p.render_from_node);
        joined_.emplace_back(&p, std::move(pairs.found));
        if (pairs.triangles.empty()) return;
        Mesh rest;
        rest.positions = mesh.positions;
        rest.indices = std::move(pairs.triangles);
        add_mesh(p, rest, p.render_from_node);
    }

    std::uint32_t material_of(const Shape& shape) const { return material_index(t_, shape); }

    bool has_alpha(std::uint32_t material) const
    {
        return t_.materials[material].alpha_mode != std::uint32_t(AlphaMode::opaque);
    }

    /// Spheres and disks that a transform distorts or that are alpha-tested become meshes: their hits do not provide
    /// texture coordinates for alpha tests.
    bool needs_tessellation(const FlattenedShape& p) const
    {
        const auto* sphere = std::get_if<Sphere>(&p.shape->geometry);
        if (!sphere && !std::holds_alternative<Disk>(p.shape->geometry)) return false;
        double factor;
        const bool moves = p.motion >= 0 || (sphere && sphere->center_end);
        return !is_similarity(p.render_from_node, factor) || (has_alpha(material_of(*p.shape)) && !moves);
    }

    /// Disables the alpha test of round primitives, which do not support it.
    void make_opaque(ShapeRecord& shape)
    {
        opaque_ += (shape.flags & ShapeRecord::alpha_tested) != 0;
        shape.flags &= ~std::uint32_t(ShapeRecord::alpha_tested);
    }

    ShapeRecord& add_shape(const FlattenedShape& p, std::uint32_t first_primitive, bool mirrored)
    {
        ShapeRecord shape;
        shape.material = material_of(*p.shape);
        if (has_alpha(shape.material)) shape.flags |= ShapeRecord::alpha_tested;
        if (mirrored) shape.flags |= ShapeRecord::flipped;
        shape.first_primitive = first_primitive;
        shape.object_id = p.object_id;
        t_.shapes.push_back(shape);
        return t_.shapes.back();
    }

    /// Sets the frame of round primitives, whose texture coordinates follow the axes of their node. The transform must
    /// be a similarity.
    void set_frame(ShapeRecord& shape, const Transform& node_from_render, double factor)
    {
        const MaterialRecord& m = t_.materials[shape.material];
        std::array<float, 9> rows;
        bool turned = false;
        for (std::size_t i = 0; i < 9; ++i) {
            const double number = node_from_render.m[i / 3][i % 3] * factor;
            rows[i] = float(number);
            turned |= std::abs(number - (i % 4 == 0)) > 1e-9;
        }
        if (!shows_uv(m) || !turned) return;
        shape.frame = std::uint32_t(t_.frames.size());
        t_.frames.push_back(rows);
    }

    void add_round_shape(const FlattenedShape& p, std::uint32_t first_primitive, double factor)
    {
        ShapeRecord& shape = add_shape(p, first_primitive, false);
        make_opaque(shape);
        set_frame(shape, p.render_from_node.inverse(), factor);
    }

    /// Appends `count` primitives to the last shape.
    void take_primitives(std::size_t count)
    {
        if (t_.shape_of_primitive.size() + count > 0x7fffffffu)
            throw Error(c_.scene.file, "", "the scene has more than 2^31 primitives");
        t_.shape_of_primitive.insert(t_.shape_of_primitive.end(), count, std::uint32_t(t_.shapes.size() - 1));
    }

    void add_mesh(const FlattenedShape& p, const Mesh& mesh, const Transform& transform)
    {
        const bool mirrored = transform.determinant() < 0;
        ShapeRecord& shape = add_shape(p, t_.triangle_count(), mirrored);
        const std::size_t base = t_.positions.size();
        if (base + mesh.positions.size() > 0x7fffffffu)
            throw Error(c_.scene.file, "", "the scene has more than 2^31 vertices");
        // Normals transform by the inverse transpose; they are normalized, so its scale does not matter.
        const Transform inverse = transform.inverse();
        const auto add_vertices = [&](const std::vector<Vec3f>& positions, const std::vector<Vec3f>& normals) {
            const std::size_t first = t_.positions.size();
            for (Vec3f q : positions) t_.positions.push_back(to_float(transform.point(to_double(q))));
            if (normals.empty()) return;
            shape.flags |= ShapeRecord::has_normals;
            pad(t_.normals, first);
            for (Vec3f n : normals) t_.normals.push_back(to_float(normal(inverse, to_double(n))));
        };
        const bool moves = instancing_.vertices_move(*p.shape);
        if (moves) shape.moving_vertices = std::uint32_t(mesh.positions.size());
        contents_.fixed_motion |= !mesh.motion.empty() && !mesh.movable;
        for_each_pose(t_, mesh, moves, add_vertices);
        if (!mesh.tangents.empty()) {
            shape.flags |= ShapeRecord::has_tangents;
            pad(t_.tangents, base);
            for (const Vec4f& v : mesh.tangents) t_.tangents.push_back(unit_tangent(v, transform));
        }
        copy(mesh.uvs[0], t_.uv0, base, shape, ShapeRecord::has_uv0);
        copy(mesh.uvs[1], t_.uv1, base, shape, ShapeRecord::has_uv1);
        copy(mesh.colors, t_.colors, base, shape, ShapeRecord::has_colors);
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
    static void pad(LargeVector<T>& v, std::size_t size)
    {
        if (v.size() < size) v.resize(size);
    }
    template <class T>
    static void copy(const std::vector<T>& from, LargeVector<T>& to, std::size_t base, ShapeRecord& shape,
                     std::uint32_t flag)
    {
        if (from.empty()) return;
        shape.flags |= flag;
        pad(to, base);
        to.insert(to.end(), from.begin(), from.end());
    }
    /// Extends attribute arrays that any mesh uses to the vertices of all meshes.
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

    /// Adds a quad in render space.
    void add_quad(const Vec3d& corner, const Vec3d& u, const Vec3d& v)
    {
        t_.quads.push_back({to_float(corner), to_float(u), to_float(v)});
        take_primitives(1);
    }
    void add_rectangles(const FlattenedShape& p, const std::vector<Rectangle>& rectangles)
    {
        add_shape(p, t_.first_quad() + std::uint32_t(t_.quads.size()), p.render_from_node.determinant() < 0);
        const Transform& t = p.render_from_node;
        for (const Rectangle& r : rectangles) add_quad(t.point(r.corner), t.vector(r.edge_u), t.vector(r.edge_v));
    }
    void add_box(const FlattenedShape& p, const Box& b)
    {
        add_shape(p, t_.first_quad() + std::uint32_t(t_.quads.size()), p.render_from_node.determinant() < 0);
        // Rounding each face separately would leave gaps through which light leaks. All corners are therefore placed on
        // a grid on which float addition is exact.
        const Transform& t = p.render_from_node;
        const Vec3d d = b.max - b.min;
        Vec3d corner = t.point(b.min), x = t.vector({d.x, 0, 0}), y = t.vector({0, d.y, 0}), z = t.vector({0, 0, d.z});
        double largest = 0;
        for (const Vec3d& v : {corner, corner + x, corner + y, corner + z, corner + x + y + z})
            largest = std::max({largest, std::abs(v.x), std::abs(v.y), std::abs(v.z)});
        const double grid = std::exp2(std::ceil(std::log2(largest)) - 22);
        for (Vec3d* v : {&corner, &x, &y, &z})
            if (largest > 0)
                *v = {std::round(v->x / grid) * grid, std::round(v->y / grid) * grid, std::round(v->z / grid) * grid};
        add_quad(corner, z, y);      // -x
        add_quad(corner + x, y, z);  // +x
        add_quad(corner, x, z);      // -y
        add_quad(corner + y, z, x);  // +y
        add_quad(corner, y, x);      // -z
        add_quad(corner + z, x, y);  // +z
    }
    /// poses: two poses between which the sphere moves linearly, or null.
    void add_sphere(const FlattenedShape& p, const Sphere& s, const std::vector<NodeKey>* poses)
    {
        double factor;
        is_similarity(p.render_from_node, factor);
        add_round_shape(p, t_.first_sphere() + std::uint32_t(t_.spheres.size()), factor);
        SphereRecord sphere;
        const Vec3d center = p.render_from_node.point(s.center);
        sphere.center = to_float(center);
        sphere.radius = float(s.radius * factor);
        if (s.center_end) {
            sphere.motion = to_float(p.render_from_node.point(*s.center_end) - center);
            t_.moving = contents_.fixed_motion = true;
        } else if (poses) {
            const NodeKey &a = poses->front(), &b = poses->back();
            const Vec3d motion = (b.parent_from_node.point(s.center) - center) * (1 / (b.time - a.time));
            sphere.center = to_float(center - motion * a.time);
            sphere.motion = to_float(motion);
            t_.moving = contents_.fixed_motion = true;
        }
        t_.spheres.push_back(sphere);
        take_primitives(1);
    }
    void add_disk(const FlattenedShape& p, const Disk& d)
    {
        double factor;
        is_similarity(p.render_from_node, factor);
        add_round_shape(p, t_.first_disk() + std::uint32_t(t_.disks.size()), factor);
        const Vec3d n = normal(p.render_from_node.inverse(), d.normal);
        t_.disks.push_back({to_float(p.render_from_node.point(d.center)), to_float(n), float(d.radius * factor)});
        take_primitives(1);
    }

    void add_curves(const FlattenedShape& p, const Curves& curves)
    {
        double factor;
        is_similarity(p.render_from_node, factor);
        ShapeRecord& shape = add_shape(p, t_.first_curve() + std::uint32_t(t_.curves.size()), false);
        make_opaque(shape);
        if (curves.basis == CurveBasis::linear) shape.flags |= ShapeRecord::linear_curves;
        if (curves.ribbons)
            shape.flags |= ShapeRecord::ribbons;
        else if (solids_.contains(shared_geometry(c_, *p.shape)))
            shape.flags |= ShapeRecord::solid_curves;
        else if (fibers_.contains(shared_geometry(c_, *p.shape)))
            shape.flags |= ShapeRecord::fibers;
        const bool moves = instancing_.vertices_move(*p.shape);
        contents_.fixed_motion |= !curves.motion.empty();
        const std::size_t points = t_.curve_points.size();
        take_primitives(fathom::add_curves(t_, curves, p.render_from_node, factor, moves));
        if (moves) shape.moving_vertices = std::uint32_t((t_.curve_points.size() - points) / t_.vertex_times.size());
        if (t_.curves.size() > CurveRecord::max_segments)
            throw Error(c_.scene.file, "", "the scene has more than 2^27 curve segments");
        if (t_.curve_points.size() > CurveRecord::max_points)
            throw Error(c_.scene.file, "",
                        "the scene has more than 2^29 control points of curves, counted once per motion key");
    }
    void add_points(const FlattenedShape& p, const Points& points)
    {
        double factor;
        is_similarity(p.render_from_node, factor);
        add_round_shape(p, t_.first_point() + std::uint32_t(t_.points.size()), factor);
        for (std::size_t i = 0; i < points.centers.size(); ++i) {
            const Vec3f c = to_float(p.render_from_node.point(to_double(points.centers[i])));
            t_.points.push_back({c.x, c.y, c.z, float(points.radii[i] * factor)});
        }
        take_primitives(points.centers.size());
    }

    Compiler& c_;
    SceneTables& t_;
    const Instancing instancing_;
    InstancedGeometry contents_;
    std::size_t degenerate_ = 0, opaque_ = 0;
    std::set<const void*> solids_, fibers_;  ///< geometry keys, as returned by shared_geometry()
    std::vector<std::pair<const FlattenedShape*, std::vector<Rectangle>>> joined_;  ///< shapes whose triangles became
                                                                                    ///< parallelograms
};

}  // namespace

InstancedGeometry compile_geometry(Compiler& c, FlattenedScene& occurrences)
{
    return GeometryCompiler(c, occurrences).run(occurrences);
}

bool replace_vertices(Compiler& c, const InstancedGeometry& contents, const Mesh& mesh)
{
    SceneTables& t = c.tables;
    const auto place = contents.shapes.find(&mesh);
    if (place == contents.shapes.end() || mesh.indices.empty()) return true;  // no shape refers to the mesh
    const ShapeRecord& shape = t.shapes[place->second];
    const bool moves = shape.moving_vertices > 0, has_normals = shape.flags & ShapeRecord::has_normals;
    if (moves != fathom::moves(mesh, t.shutter_open, t.shutter_close)) return false;
    std::size_t at = t.triangles[3 * std::size_t(shape.first_primitive)] - mesh.indices[0];
    bool fits = true;
    const std::size_t count = mesh.positions.size();
    for_each_pose(t, mesh, moves, [&](const std::vector<Vec3f>& positions, const std::vector<Vec3f>& normals) {
        fits = fits && normals.empty() != has_normals && at + count <= t.positions.size();
        if (!fits) return;
        std::copy(positions.begin(), positions.end(), t.positions.begin() + std::ptrdiff_t(at));
        for (std::size_t i = 0; i < normals.size(); ++i) t.normals[at + i] = to_float(normalize(to_double(normals[i])));
        at += count;
    });
    at = t.triangles[3 * std::size_t(shape.first_primitive)] - mesh.indices[0];
    for (std::size_t i = 0; fits && i < mesh.tangents.size(); ++i)
        t.tangents[at + i] = unit_tangent(mesh.tangents[i], {});
    return fits;
}

}  // namespace fathom
