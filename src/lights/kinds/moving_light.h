// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "geometry/motion.h"
#include "lights/light.h"

namespace fathom {
inline namespace FATHOM_LANES {

/// A light of each lane at a shutter time: static lights as LightReader reads them, moving ones at that time. It uses
/// the functions by which surfaces are read, so that light sampling and ray hits agree.
class MovingLight : public LightReader<false> {
public:
    MovingLight(const LightReader<false>& light, const GeometryTables& tables, Float time, Mask m)
        : LightReader<false>(light),
          position_(light.position()),
          edge_u_(light.edge_u()),
          edge_v_(light.edge_v()),
          normal_(light.normal()),
          motion_or_center_(light.center()),
          length_u_(light.length_u()),
          length_v_(light.length_v()),
          area_(light.area()),
          radius_(light.radius())
    {
        const UInt flags = light.motion_flags();
        const auto has = [&](std::uint32_t flag) { return m & ((flags & UInt(flag)) != UInt(0u)); };
        if (const Mask moving = has(LightRecord::vertices_move); any(moving))
            read_triangle(tables, time, has(LightRecord::flipped), moving);
        if (const Mask placed = has(LightRecord::placed); any(placed))
            place(object_from_render(tables, instance(), time, placed), time, placed);
        if (const Mask carried = has(LightRecord::has_poses); any(carried)) {
            const Affine to_render = pose_of(tables, instance(), time, carried);
            position_ = select(carried, to_render.shift, position_);
            const Mask beam = carried & is_kind(kind(), LightRecordKind::beam);
            const Vec3 u = to_render.vector(edge_u_);
            edge_u_ = select(carried, select(beam, u, normalize(u)), edge_u_);
            if (any(beam)) turn_beam(to_render, beam);
            const Mask pictured = carried & is_kind(kind(), LightRecordKind::pictured);
            if (any(pictured)) rotate_image_axes(to_render, pictured);
        }
    }

    Vec3 position() const { return position_; }
    Vec3 edge_u() const { return edge_u_; }
    Vec3 edge_v() const { return edge_v_; }
    Vec3 normal() const { return normal_; }
    Vec3 center() const { return motion_or_center_; }
    Vec3 motion() const { return motion_or_center_; }
    Float length_u() const { return length_u_; }
    Float length_v() const { return length_v_; }
    Float area() const { return area_; }
    Float radius() const { return radius_; }

private:
    /// Normalizes; zero stays zero: a light without a normal emits nothing.
    static Vec3 unit(const Vec3& v) { return v * inverse_sqrt(max(dot(v, v), Float(1e-37f))); }

    /// Rotates the axes of a light's image, and keeps them orthogonal; edge_u_ is transformed already.
    void rotate_image_axes(const Affine& to_render, Mask m)
    {
        const Vec3 right = to_render.vector(edge_v_), up = to_render.vector(normal_);
        const Vec3 across = unit(right - edge_u_ * dot(right, edge_u_)), top = cross(across, edge_u_);
        edge_v_ = select(m, across, edge_v_);
        normal_ = select(m, flip_sign(top, dot(top, up)), normal_);
    }

    /// Transforms a beam's area, which the node may stretch and mirror; edge_u_ is transformed already.
    void turn_beam(const Affine& to_render, Mask m)
    {
        const Vec3 v = to_render.vector(edge_v_), n = cross(edge_u_, v);
        edge_v_ = select(m, v, edge_v_);
        normal_ = select(m, flip_sign(unit(n), dot(n, to_render.vector(normal_))), normal_);
    }

    void read_triangle(const GeometryTables& tables, Float time, Mask flipped, Mask m)
    {
        const UInt first = primitive() * UInt(3u);
        const Vec3 corners = gather_vector(reinterpret_cast<const float*>(tables.triangles.data()), first, m);
        const UInt shape = gather(tables.shape_of_primitive.data(), primitive(), m);
        const UInt vertices = gather(tables.shapes, &ShapeRecord::moving_vertices, shape, m);
        const KeyTime key = vertex_key(tables, time);
        const auto corner = [&](Float number) {
            const UInt now = float_bits(number) + key.key * vertices;
            return mix(gather(tables.positions, now, m), gather(tables.positions, now + vertices, m), key.fraction);
        };
        const Vec3 a = corner(corners.x), u = corner(corners.y) - a, v = corner(corners.z) - a, n = cross(u, v);
        position_ = select(m, a, position_);
        edge_u_ = select(m, u, edge_u_);
        edge_v_ = select(m, v, edge_v_);
        normal_ = select(m, flip_sign(unit(n), select(flipped, Float(-1), Float(1))), normal_);
        area_ = select(m, Float(0.5f) * sqrt(dot(n, n)), area_);
    }

    /// Transforms from an instance's space to render space. Disks and spheres are lights only under similarities, which
    /// keep their shape.
    void place(const Affine& to_object, Float time, Mask m)
    {
        const Affine to_render = to_object.inverse();
        const Mask rectangle = is_kind(kind(), LightRecordKind::rectangle),
                   disk = is_kind(kind(), LightRecordKind::disk), sphere = is_kind(kind(), LightRecordKind::sphere),
                   triangle = is_kind(kind(), LightRecordKind::triangle);
        const auto edge = [&](const Vec3& e, Float length) {
            return to_render.vector(e * select(rectangle, length, Float(1)));
        };
        const Vec3 u = edge(edge_u_, length_u_), v = edge(edge_v_, length_v_), n = cross(u, v);
        const Vec3 start = select(sphere, fma(motion_or_center_, time, position_), position_);
        const Vec3 p = to_render.point(start);
        const Float length_u = sqrt(dot(u, u)), length_v = sqrt(dot(v, v));
        const Vec3 x{to_render.row[0].x, to_render.row[1].x, to_render.row[2].x};
        const Float factor2 = dot(x, x);
        const Vec3 diagonal = u + v, zero(Float(0), Float(0), Float(0));
        position_ = select(m, p, position_);
        edge_u_ = select(m, select(rectangle, u * (Float(1) / length_u), u), edge_u_);
        edge_v_ = select(m, select(rectangle, v * (Float(1) / length_v), v), edge_v_);
        normal_ = select(m, unit(to_object.transposed_vector(normal_)), normal_);
        length_u_ = select(m, length_u, length_u_);
        length_v_ = select(m, length_v, length_v_);
        area_ =
            select(m, select(disk | sphere, area_ * factor2, sqrt(dot(n, n)) * select(triangle, Float(0.5f), Float(1))),
                   area_);
        radius_ = select(m, select(rectangle, sqrt(dot(diagonal, diagonal)), radius_ * sqrt(factor2)), radius_);
        motion_or_center_ = select(m, select(sphere, zero, fma(diagonal, Float(0.5f), p)), motion_or_center_);
    }

    Vec3 position_, edge_u_, edge_v_, normal_, motion_or_center_;
    Float length_u_, length_v_, area_, radius_;
};

}  // namespace FATHOM_LANES
}  // namespace fathom
