// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Surface properties at hits: position, normals, texture coordinates, tangent.
#include "geometry/motion.h"
#include "geometry/surface/curve_surface.h"
#include "geometry/surface/vertex_attributes.h"
#include "kernel/lane_scene.h"
#include "math/gather_member.h"
#include "textures/textures.h"

namespace fathom {
inline namespace FATHOM_LANES {

/// Computes surface properties at hits.
class SurfaceReader {
public:
    explicit SurfaceReader(const LaneScene& scene) : scene_(scene), t_(scene.tables) {}

    /// The shape that was hit: the instance's, or the primitive's own.
    UInt shape_of(UInt primitive, UInt instance, Mask m) const
    {
        const UInt own = gather(t_.shape_of_primitive.data(), primitive, m);
        if (t_.instances.empty()) return own;
        const Mask placed = m & (instance != UInt(no_index));
        return select(placed, gather(t_.instances, &InstanceRecord::shape, instance, placed), own);
    }

    /// Prefetches the vertex indices of the triangles hit in the lanes of m.
    void fetch_indices(UInt primitive, Mask m) const
    {
        if (!scene_.has(Feature::large_meshes)) return;
        std::uint32_t numbers[lanes];
        store(numbers, primitive);
        for_each_active(m & less(primitive, UInt(t_.first_quad())),
                        [&](int lane) { __builtin_prefetch(&t_.triangles[3 * std::size_t(numbers[lane])]); });
    }
    /// Prefetches the vertices of some triangles.
    void fetch_vertices(const std::uint32_t* primitives, std::size_t count) const
    {
        if (!scene_.has(Feature::large_meshes)) return;
        for (std::size_t i = 0; i < count; ++i) {
            if (primitives[i] >= t_.first_quad()) continue;
            const std::uint32_t* const vertex = &t_.triangles[3 * std::size_t(primitives[i])];
            const auto fetch = [&](const auto& table) {
                for (int k = 0; k < 3; ++k)
                    if (vertex[k] < table.size()) __builtin_prefetch(&table[vertex[k]]);
            };
            fetch(t_.positions), fetch(t_.normals), fetch(t_.uv0);
        }
    }

    /// Surface at the hits of the lanes of m, in render space.
    Surface read(const SurfaceHit& hit, Mask m) const
    {
        Surface s;
        s.p = fma(hit.d, hit.t, hit.o);
        // Instanced primitives are evaluated in object space.
        const Mask placed = t_.instances.empty() ? Mask(false) : m & (hit.instance != UInt(no_index));
        Affine to_object;
        Vec3 way = hit.d * hit.t;
        if (any(placed)) {
            to_object = object_from_render(t_, hit.instance, hit.time, placed);
            s.p = select(placed, to_object.point(s.p), s.p);
            way = select(placed, to_object.vector(way), way);
        }
        s.shape = shape_of(hit.primitive, hit.instance, m);
        s.tangent = Vec3(Float(0), Float(0), Float(0));
        s.bitangent_sign = Float(1);
        s.has_mesh_tangent = s.has_map_tangents = Mask(false);
        s.offset = s.radius = Float(0);
        for (Float& c : s.at.vertex_color) c = Float(1);
        for (int i = 0; i < 2; ++i) s.at.u[i] = hit.u, s.at.v[i] = hit.v;
        s.ng = Vec3(Float(0), Float(0), Float(1));
        if (scene_.has(Feature::surface_derivatives)) s.derivatives.clear();

        const RecordRow<ShapeRecord, 2> shape(t_.shapes, s.shape, m);
        s.material = shape.get(&ShapeRecord::material);
        if (scene_.has(Feature::mixtures))
            s.material = select(hit.material != UInt(no_index), hit.material, s.material);
        const UInt flags = shape.get(&ShapeRecord::flags);
        const Mask triangle = m & less(hit.primitive, UInt(t_.first_quad()));
        const Mask quad = m & !triangle & less(hit.primitive, UInt(t_.first_sphere()));
        const Mask sphere = m & !triangle & !quad & less(hit.primitive, UInt(t_.first_disk()));
        const Mask disk = m & !triangle & !quad & !sphere & less(hit.primitive, UInt(t_.first_curve()));
        const Mask curve =
            m & !less(hit.primitive, UInt(t_.first_curve())) & less(hit.primitive, UInt(t_.first_point()));
        const Mask point = m & !less(hit.primitive, UInt(t_.first_point()));
        s.is_curve = curve;
        s.is_ribbon = curve & ((flags & UInt(ShapeRecord::ribbons)) != UInt(0u));
        s.ns = s.ng;
        if (any(triangle)) read_triangle(hit, flags, triangle, s);
        if (any(quad)) read_quad(hit, way, quad, s);
        if (any(sphere)) read_sphere(hit, sphere, s);
        if (any(disk)) read_disk(hit, way, disk, s);
        if (any(curve)) {
            const Vec3 d = any(placed) ? select(placed, to_object.vector(hit.d), hit.d) : hit.d;
            read_curve(t_, hit.primitive - UInt(t_.first_curve()), flags, hit, normalize(d), curve, s);
        }
        if (any(point)) read_point(hit, point, s);
        if (any(placed)) place(to_object, placed, s);
        const Float side = select((flags & UInt(ShapeRecord::flipped)) != UInt(0), Float(-1), Float(1));
        s.ng = flip_sign(s.ng, side);
        // Vertex normals are already transformed; the geometric normal determines the side. The bitangent keeps its
        // direction.
        const Float agreement = dot(s.ns, s.ng);
        s.ns = flip_sign(s.ns, agreement);
        s.bitangent_sign = flip_sign(s.bitangent_sign, agreement);
        if (scene_.has(Feature::textures)) s.at.p_world = in_world(s.p), s.at.n_world = s.ng;
        return s;
    }

    /// World position of a point in render space.
    Vec3 in_world(const Vec3& p) const
    {
        return fma(p, Float(float(1 / t_.render_scale)),
                   Vec3(Float(float(t_.origin.x)), Float(float(t_.origin.y)), Float(float(t_.origin.z))));
    }

    /// Object id for the instance id AOV.
    UInt object_of(const SurfaceHit& hit, UInt shape, Mask m) const
    {
        const UInt own = gather(t_.shapes, &ShapeRecord::object_id, shape, m);
        if (t_.instances.empty()) return own;
        const Mask placed = m & (hit.instance != UInt(no_index));
        return select(placed, gather(t_.instances, &InstanceRecord::object_id, hit.instance, placed), own);
    }

    /// Light index of a primitive, or no_index.
    UInt light_of(UInt shape, UInt primitive, Mask m) const
    {
        const UInt base = gather(t_.shapes, &ShapeRecord::light_base, shape, m);
        const Mask is_light = m & (base != UInt(no_index));
        const UInt first = gather(t_.shapes, &ShapeRecord::first_primitive, shape, is_light);
        return select(is_light, base + (primitive - first), UInt(no_index));
    }
    UInt material_of(UInt shape, Mask m) const { return gather(t_.shapes, &ShapeRecord::material, shape, m); }

private:
    void read_triangle(const SurfaceHit& hit, UInt flags, Mask m, Surface& s) const
    {
        const UInt first = hit.primitive * UInt(3);
        const Vec3 corners_of = gather_vector(reinterpret_cast<const float*>(t_.triangles.data()), first, m);
        const UInt vertex[3] = {float_bits(corners_of.x), float_bits(corners_of.y), float_bits(corners_of.z)};
        Vec3 position[3];
        for (int k = 0; k < 3; ++k) position[k] = gather(t_.positions, vertex[k], m);
        KeyTime key{UInt(0u), Float(0)};
        UInt vertices(0u);  // number of vertices of a moving mesh; else 0
        if (!t_.vertex_times.empty()) {
            key = vertex_key(t_, hit.time);
            vertices = gather(t_.shapes, &ShapeRecord::moving_vertices, s.shape, m);
        }
        const Mask moving = m & (vertices != UInt(0u));
        // A vertex attribute at the path's time.
        const auto at_time = [&](const LargeVector<Vec3f>& table, UInt v, Mask which) {
            const UInt now = v + key.key * vertices, then = v + (key.key + UInt(1u)) * vertices;
            return mix(gather(table, now, which), gather(table, then, which), key.fraction);
        };
        if (any(moving))
            for (int k = 0; k < 3; ++k)
                position[k] = select(moving, at_time(t_.positions, vertex[k], moving), position[k]);
        const Float w = Float(1) - hit.u - hit.v;
        const auto interpolate = [&](Vec3 a, Vec3 b, Vec3 c) { return fma(a, w, fma(b, hit.u, c * hit.v)); };
        // Moves the point away from the edges by as much as rounding could put it beyond one, behind the adjacent
        // triangle.
        const auto inwards = [](Float weight) { return fma(Float(inward), Float(1.0f / 3) - weight, weight); };
        const Float inner_u = inwards(hit.u), inner_v = inwards(hit.v);
        const Vec3 p = fma(position[0], Float(1) - inner_u - inner_v, fma(position[1], inner_u, position[2] * inner_v));
        const Vec3 e1 = position[1] - position[0], e2 = position[2] - position[0];
        Vec3 n = cross(e1, e2), ns = n;
        const auto has = [&](std::uint32_t flag) { return m & ((flags & UInt(flag)) != UInt(0)); };

        if (const Mask smooth = has(ShapeRecord::has_normals); any(smooth)) {
            const auto at = [&](int k) {
                const Vec3 still = gather(t_.normals, vertex[k], smooth);
                const Mask changes = smooth & moving;
                return any(changes) ? select(changes, at_time(t_.normals, vertex[k], changes), still) : still;
            };
            const Vec3 interpolated = interpolate(at(0), at(1), at(2));
            // Interpolated normals that are zero are replaced by the geometric normal.
            ns = select(smooth & (dot(interpolated, interpolated) > Float(1e-12f)), interpolated, ns);
        }
        const TrianglePlace place{{vertex[0], vertex[1], vertex[2]}, hit.u, hit.v};
        place.read_uv(t_.uv0, has(ShapeRecord::has_uv0), s.at.u[0], s.at.v[0]);
        place.read_uv(t_.uv1, has(ShapeRecord::has_uv1), s.at.u[1], s.at.v[1]);
        if (scene_.has(Feature::surface_derivatives)) {
            s.derivatives.set_edges(e1, e2, m);
            s.derivatives.read_uv(t_.uv0, vertex, 0, has(ShapeRecord::has_uv0));
            s.derivatives.read_uv(t_.uv1, vertex, 1, has(ShapeRecord::has_uv1));
        }
        Vec3 tangent = uv_tangent(e1, e2, vertex, has(ShapeRecord::has_uv0), s.bitangent_sign);
        s.bitangent_sign = select(m, flip_sign(s.bitangent_sign, dot(n, ns)), s.bitangent_sign);
        if (const Mask given = has(ShapeRecord::has_tangents); any(given)) {
            const auto* table = reinterpret_cast<const float*>(t_.tangents.data());
            const auto at = [&](int k) { return gather_vector(table, vertex[k] << 2, given); };
            tangent = select(given, interpolate(at(0), at(1), at(2)), tangent);
            s.has_mesh_tangent = s.has_mesh_tangent | given;
            s.bitangent_sign = select(given, gather(table + 3, vertex[0] << 2, given), s.bitangent_sign);
        }
        if (const Mask colored = has(ShapeRecord::has_colors); any(colored)) {
            Float color[4];
            place.numbers(reinterpret_cast<const float*>(t_.colors.data()), colored, color);
            for (int c = 0; c < 4; ++c) s.at.vertex_color[c] = select(colored, color[c], s.at.vertex_color[c]);
        }
        // The rounding error of the interpolation grows with the weighted mean distance of the corners.
        const auto spread = [](Float weight) { return weight * (Float(2) - Float(2) * weight); };
        const Vec3 corners = fma(abs(e1), spread(hit.u), abs(e2) * spread(hit.v));
        const Vec3 ng = normalize(n);
        const Float rounding = fma(max_abs(corners), Float(rounding_of_shear), rounding_along(ng, p, corners));
        s.p = select(m, p, s.p);
        s.offset = select(m, rounding, s.offset);
        s.ng = select(m, ng, s.ng);
        s.ns = select(m, normalize(ns), s.ns);
        s.tangent = select(m, tangent, s.tangent);
    }

    /// Tangent dp/du of the first texture coordinate set, and the side of cross(cross(e1, e2), tangent) on which v
    /// decreases; for meshes without tangents.
    Vec3 uv_tangent(Vec3 e1, Vec3 e2, const UInt* vertex, Mask m, Float& sign) const
    {
        Vec3 tangent(Float(0), Float(0), Float(0));
        if (none(m) || !scene_.has(Feature::tangents)) return tangent;
        const auto* base = reinterpret_cast<const float*>(t_.uv0.data());
        Float u[3], v[3];
        for (int k = 0; k < 3; ++k) {
            u[k] = gather(base, vertex[k] << 1, m);
            v[k] = gather(base + 1, vertex[k] << 1, m);
        }
        const Float du1 = u[1] - u[0], du2 = u[2] - u[0], dv1 = v[1] - v[0], dv2 = v[2] - v[0];
        const Float det = fma(du1, dv2, -(du2 * dv1));
        tangent = flip_sign(e1 * dv2 - e2 * dv1, det);
        // In glTF, v grows downward in the image while normal maps have green up: the bitangent is opposite to v.
        sign = select(m, copysign(Float(1), -det), sign);
        return select(m & (det != Float(0)), tangent, Vec3(Float(0), Float(0), Float(0)));
    }

    /// Transforms a surface from object space to render space.
    void place(const Affine& to_object, Mask m, Surface& s) const
    {
        const Affine to_render = to_object.inverse();
        // Transformed normals are normalized again.
        const auto normal = [&](Vec3 n) { return normalize(to_object.transposed_vector(n)); };
        // scale: factor on lengths along the normal. Both transforms, to object space and back, round the coordinates
        // that they add.
        const Vec3 scaled_normal = to_object.transposed_vector(s.ng);
        const Float scale = inverse_sqrt(dot(scaled_normal, scaled_normal));
        const Vec3 p = to_render.point(s.p), ng = scaled_normal * scale;
        const Float rounding = rounding_along(ng, p, to_render.reach(s.p)) +
                               scale * (s.offset + rounding_along(s.ng, s.p, to_object.reach(p)));
        s.offset = select(m, rounding, s.offset);
        s.radius = select(m, s.radius * scale, s.radius);
        s.p = select(m, p, s.p);
        s.ng = select(m, ng, s.ng);
        s.ns = select(m, normal(s.ns), s.ns);
        s.tangent = select(m, to_render.vector(s.tangent), s.tangent);
        if (scene_.has(Feature::surface_derivatives))
            for (Vec3& way : s.derivatives.way) way = select(m, to_render.vector(way), way);
        s.bitangent_sign = select(m, flip_sign(s.bitangent_sign, to_object.determinant()), s.bitangent_sign);
    }

    /// way: vector from the ray's origin to the hit, in the quad's space.
    void read_quad(const SurfaceHit& hit, const Vec3& way, Mask m, Surface& s) const
    {
        // Other lanes may hold any primitive, even one before the first quad.
        const UInt quad = select(m, hit.primitive - UInt(t_.first_quad()), UInt(0u));
        s.p = select(m, fma(scene_.quads.center(quad) - s.p, Float(inward), s.p), s.p);
        s.ng = select(m, scene_.quads.normal(quad), s.ng);
        const Float rounding = rounding_along(s.ng, s.p, way) + scene_.quads.rounding(quad);
        s.offset = select(m, rounding, s.offset);
        s.ns = select(m, s.ng, s.ns);
        if (!scene_.has(Feature::texture_coordinates)) return;
        const Vec3 corner = gather(t_.quads, &QuadRecord::corner, quad, m),
                   u = gather(t_.quads, &QuadRecord::edge_u, quad, m),
                   v = gather(t_.quads, &QuadRecord::edge_v, quad, m);
        const Vec3 n = cross(u, v), r = s.p - corner;
        const Float scale = Float(1) / max(dot(n, n), Float(1e-30f));
        const Float uu = dot(r, cross(v, n)) * scale, vv = dot(r, cross(n, u)) * scale;
        for (int i = 0; i < 2; ++i) {
            s.at.u[i] = select(m, uu, s.at.u[i]);
            // Images are upright: edge_v points up, v grows downward.
            s.at.v[i] = select(m, Float(1) - vv, s.at.v[i]);
        }
        s.tangent = select(m, u, s.tangent);
        if (scene_.has(Feature::surface_derivatives)) s.derivatives.set(u, -v, m);
    }

    /// Axes of the nodes of round shapes, which orient their texture coordinates.
    struct NodeAxes {
        Vec3 row[3];
        bool turned;  ///< false if the axes are those of the current space, bitwise

        Vec3 to_node(Vec3 v) const { return turned ? Vec3(dot(row[0], v), dot(row[1], v), dot(row[2], v)) : v; }
        /// -1 if the node mirrors, else 1.
        Float handedness() const { return turned ? dot(row[0], cross(row[1], row[2])) : Float(1); }
        Vec3 from_node(Vec3 v) const { return turned ? fma(row[0], v.x, fma(row[1], v.y, row[2] * v.z)) : v; }
    };
    /// The axes of the nodes of shapes, from tables.frames.
    NodeAxes node_axes(UInt shape, Mask m) const
    {
        NodeAxes axes;
        axes.turned = false;
        if (t_.frames.empty()) return axes;
        const UInt frame = gather(t_.shapes, &ShapeRecord::frame, shape, m);
        const Mask turned = m & (frame != UInt(no_index));
        axes.turned = any(turned);
        const float* rows = t_.frames[0].data();
        for (int i = 0; i < 3; ++i) {
            const auto number = [&](int k) {
                return select(turned, gather(rows + 3 * i + k, frame * UInt(9u), turned), Float(i == k ? 1.f : 0.f));
            };
            axes.row[i] = {number(0), number(1), number(2)};
        }
        return axes;
    }

    void read_sphere(const SurfaceHit& hit, Mask m, Surface& s) const
    {
        const UInt at = hit.primitive - UInt(t_.first_sphere());
        const Vec3 center = fma(gather(t_.spheres, &SphereRecord::motion, at, m), hit.time,
                                gather(t_.spheres, &SphereRecord::center, at, m));
        read_ball(center, gather(t_.spheres, &SphereRecord::radius, at, m), m, s);
    }

    void read_disk(const SurfaceHit& hit, const Vec3& way, Mask m, Surface& s) const
    {
        const UInt at = hit.primitive - UInt(t_.first_disk());
        const Vec3 center = gather(t_.disks, &DiskRecord::center, at, m),
                   n = gather(t_.disks, &DiskRecord::normal, at, m);
        const Float radius = gather(t_.disks, &DiskRecord::radius, at, m);
        s.ng = select(m, n, s.ng);
        s.ns = select(m, n, s.ns);
        s.offset = select(m, rounding_along(n, s.p, abs(way) + abs(s.p - center)), s.offset);
        if (!scene_.has(Feature::texture_coordinates)) return;
        const NodeAxes axes = node_axes(s.shape, m);
        const Frame frame(axes.to_node(n));
        const Vec3 r = axes.to_node(s.p - center);
        const Float scale = Float(0.5f) / radius;
        for (int i = 0; i < 2; ++i) {
            s.at.u[i] = select(m, fma(dot(r, frame.s), scale, Float(0.5f)), s.at.u[i]);
            s.at.v[i] = select(m, fma(dot(r, frame.t), -scale, Float(0.5f)), s.at.v[i]);
        }
        s.tangent = select(m, axes.from_node(frame.s), s.tangent);
        if (scene_.has(Feature::surface_derivatives)) {
            const Float width = radius + radius;
            s.derivatives.set(axes.from_node(frame.s) * width, axes.from_node(frame.t) * -width, m);
        }
        s.bitangent_sign = select(m, axes.handedness(), s.bitangent_sign);
    }

    void read_point(const SurfaceHit& hit, Mask m, Surface& s) const
    {
        const float* base = reinterpret_cast<const float*>(t_.points.data());
        const UInt at = (hit.primitive - UInt(t_.first_point())) << 2;
        read_ball(gather_vector(base, at, m), gather(base + 3, at, m), m, s);
    }

    /// radius: negative if the normal points inward.
    void read_ball(const Vec3& center, Float radius, Mask m, Surface& s) const
    {
        const Vec3 out = normalize(s.p - center);
        s.p = select(m, fma(out, abs(radius), center), s.p);
        // The offset grows with the radius because the intersection test subtracts squares of lengths of about the
        // radius.
        s.offset =
            select(m, fma(abs(radius), Float(0x1p-20f), rounding_along(out, s.p, Vec3(Float(0), Float(0), Float(0)))),
                   s.offset);
        s.ng = select(m, flip_sign(out, radius), s.ng);
        s.ns = select(m, s.ng, s.ns);
        if (!scene_.has(Feature::texture_coordinates)) return;
        // Texture coordinates of balls: u runs around +y, v from the pole at +y down.
        const NodeAxes axes = node_axes(s.shape, m);
        const Vec3 to = axes.to_node(out);
        const Float u = atan2(-to.z, to.x) * Float(0.5f * inv_pi);
        const Float v = acos(clamp(to.y, Float(-1), Float(1))) * Float(inv_pi);
        for (int i = 0; i < 2; ++i) {
            s.at.u[i] = select(m, select(u < Float(0), u + Float(1), u), s.at.u[i]);
            s.at.v[i] = select(m, v, s.at.v[i]);
        }
        s.tangent = select(m, axes.from_node({to.z, Float(0), -to.x}), s.tangent);
        if (scene_.has(Feature::surface_derivatives)) {
            const Float half_turn = abs(radius) * Float(float(pi));
            // At the poles the direction of u is undefined.
            const Float from_axis = max(sqrt(fma(to.x, to.x, to.z * to.z)), Float(1e-4f)), slant = to.y / from_axis;
            s.derivatives.set(axes.from_node({to.z, Float(0), -to.x}) * (half_turn + half_turn),
                              axes.from_node({to.x * slant, -from_axis, to.z * slant}) * half_turn, m);
        }
        s.bitangent_sign = select(m, flip_sign(axes.handedness(), radius), s.bitangent_sign);
    }

    /// Points of flat primitives are moved towards the center by this fraction of their distance to it; see
    /// read_triangle().
    static constexpr float inward = 0x1p-21f;

    const LaneScene& scene_;
    const SceneTables& t_;
};

}  // namespace FATHOM_LANES
}  // namespace fathom
