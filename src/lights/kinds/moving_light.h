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
        : LightReader<false>(light)
    {
        load_own(own_);
        const UInt flags = motion_flags();
        const auto has = [&](std::uint32_t flag) { return m & ((flags & UInt(flag)) != UInt(0u)); };
        if (const Mask moving = has(LightRecord::vertices_move); any(moving))
            read_triangle(tables, time, has(LightRecord::flipped), moving);
        if (const Mask placed = has(LightRecord::placed); any(placed)) {
            const Affine to_object = object_from_render(tables, instance(), time, placed);
            place({to_object.inverse(), to_object, time}, placed);
        }
        if (const Mask carried = has(LightRecord::has_poses); any(carried))
            place({pose_of(tables, instance(), time, carried), {}, time}, carried);
    }

    template <class Own>
    Float get(float Own::* member) const
    {
        return own_[detail::word_of(member)];
    }
    template <class Own>
    UInt get(std::uint32_t Own::* member) const
    {
        return float_bits(own_[detail::word_of(member)]);
    }
    template <class Own>
    Vec3 get(float (Own::*member)[3]) const
    {
        const Float* const first = own_ + detail::word_of(member);
        return {first[0], first[1], first[2]};
    }

    /// Sets members of the record of a kind in the lanes of m.
    template <class Own>
    void set(float Own::* member, Float value, Mask m)
    {
        Float& word = own_[detail::word_of(member)];
        word = select(m, value, word);
    }
    template <class Own>
    void set(float (Own::*member)[3], const Vec3& value, Mask m)
    {
        Float* const first = own_ + detail::word_of(member);
        first[0] = select(m, value.x, first[0]);
        first[1] = select(m, value.y, first[1]);
        first[2] = select(m, value.z, first[2]);
    }

private:
    void place(const LightPlace& at, Mask m)
    {
        LightKinds::for_each([&]<class Kind>() {
            if constexpr (requires { Kind::place(*this, at, m); }) {
                const Mask mine = m & is_kind(kind(), Kind::Record::kind);
                if (any(mine)) Kind::place(*this, at, mine);
            }
        });
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
        using Record = TriangleLightRecord;
        set(&Record::corner, a, m);
        set(&Record::edge_u, u, m);
        set(&Record::edge_v, v, m);
        set(&FlatLightRecord::normal, flip_sign(unit_or_zero(n), select(flipped, Float(-1), Float(1))), m);
        set(&FlatLightRecord::area, Float(0.5f) * sqrt(dot(n, n)), m);
    }

    Float own_[LightRecord::own_words];  ///< the record of each lane's kind, in render space
};

}  // namespace FATHOM_LANES
}  // namespace fathom
