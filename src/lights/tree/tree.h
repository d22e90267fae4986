// SPDX-License-Identifier: Apache-2.0
#pragma once
/// The light tree: selects lights with a position roughly in proportion to their contribution at a point.
///
/// Conty Estevez and Kulla 2018, "Importance Sampling of Many Lights with Adaptive Tree Splitting": a hierarchy of
/// bounds on position, normals and intensity. Traversal selects a child by a bound on its contribution until it reaches
/// a light. Here nodes have up to 16 children, and importances are rounded to integer weights, whose sum has the same
/// bits in any order. Children that may reach the point have a weight of at least 1, so that no contributing light has
/// probability 0.
#include <algorithm>
#include <bit>

#include "lights/records.h"
#include "math/vec3.h"

namespace fathom {
inline namespace FATHOM_LANES {

namespace detail {

/// Largest weight: a node's weights sum to less than 2^20, so that products with numbers in [0, 1) stay exact enough.
inline constexpr float max_weight = 65535;

/// Bounds of a light or a node, one per lane of F. Lanes are either the children of one node (native lanes) or points
/// (Float).
template <class F>
struct LightBounds {
    F x, y, z, radius, axis_x, axis_y, axis_z, cos_normals, sin_normals, cos_emission, back, intensity;

    /// Loads bounds; read(column) loads a column of the node.
    template <class Read>
    [[gnu::always_inline]] static LightBounds of(const LightNode& n, Read&& read)
    {
        return {read(n.x),      read(n.y),        read(n.z),           read(n.radius),      read(n.axis_x),
                read(n.axis_y), read(n.axis_z),   read(n.cos_normals), read(n.sin_normals), read(n.cos_emission),
                read(n.back),   read(n.intensity)};
    }
};

/// Normals within an angle of this sine are treated as parallel; the effect on importances is negligible.
inline constexpr float narrow_normals = 1.f / 256;

/// A bound on contribution, and whether any light can reach the point at all.
template <class F, class M>
struct Importance {
    F value;  ///< not negative
    M reaches;
};

/// Simplifications that the bounds allow.
struct BoundsHints {
    bool wide_emission;   ///< emission covers the hemisphere above each normal
    bool narrow_normals;  ///< additionally, all normals are within narrow_normals of the axis
};

/// Upper bound on the contribution of lights within the bounds to a point: section 4 of the paper, without the
/// receiver's cosine.
///
/// Lengths along normals replace angles, which saves all but one square root and one division. The normal of the cone
/// that is closest to the point's direction is used, as seen from the ball's center; lights are at most the ball's
/// radius below the plane through the center. For narrow emission this bound is too loose, so the angle that the ball
/// subtends is taken into account.
template <class M, class F>
[[gnu::always_inline]] inline Importance<F, M> importance(const LightBounds<F>& b, F px, F py, F pz, BoundsHints hints)
{
    const F x = px - b.x, y = py - b.y, z = pz - b.z;
    const F distance2 = fma(x, x, fma(y, y, z * z)), radius2 = b.radius * b.radius;
    // For points inside the ball, the radius is used as the distance.
    const F distance = sqrt(max(distance2, radius2)), inverse = F(1.f) / distance;
    const F axial = fma(x, b.axis_x, fma(y, b.axis_y, z * b.axis_z)), along = max(axial, axial * b.back);
    const F across = hints.narrow_normals ? distance : sqrt(max(fma(-along, along, distance2), F(0.f)));
    const F height = fma(along, b.cos_normals, across * b.sin_normals);
    M facing = (distance2 <= radius2) | (along >= b.cos_normals * distance);
    F cosine = min((height + b.radius) * inverse, F(1.f));
    if (!hints.wide_emission) {
        const F sin_ball = min(b.radius * inverse, F(1.f)), cos_ball = sqrt(fma(-sin_ball, sin_ball, F(1.f)));
        const F middle = min(height * inverse, F(1.f)), sin_middle = sqrt(max(fma(-middle, middle, F(1.f)), F(0.f)));
        facing = facing | (middle >= cos_ball);
        cosine = fma(middle, cos_ball, sin_middle * sin_ball);
    }
    cosine = select(facing, F(1.f), cosine);
    const M reaches = (b.intensity > F(0.f)) & (facing | (cosine > b.cos_emission));
    return {b.intensity * max(cosine, F(0.f)) * inverse * inverse, reaches};
}

/// Rounds an importance to an integer weight, which is at least 1 for lights that reach the point.
template <class U, class F, class M>
[[gnu::always_inline]] inline U light_weight(const Importance<F, M>& i, F scale)
{
    const U w = to_uint(min(i.value * scale, F(max_weight)));
    return select(i.reaches, select(less(w, U(1u)), U(1u), w), U(0u));
}

/// Scale that maps the largest importance to max_weight.
template <class F>
[[gnu::always_inline]] inline F weight_scale(F largest)
{
    return F(max_weight) / max(largest, F(1e-30f));
}

/// Prefix sums of a node's weights for one point.
class LightWeights {
public:
    static constexpr int parts = LightNode::width / native::lanes;

    LightWeights() {}  // values are uninitialized: arrays of weights are created first and assigned later
    explicit LightWeights(const native::UInt (&weights)[parts])
    {
        std::uint32_t before = sums_[LightNode::width - 1] = 0;
        for (int i = 0; i < parts; ++i) {
            native::store(up_to(i), native::prefix_sums(weights[i]) + native::UInt(before));
            before = *(up_to(i + 1) - 1);
        }
    }

    std::uint32_t total() const { return sums_[2 * LightNode::width - 1]; }
    /// Sum of the weights of the children before `slot`.
    std::uint32_t before(std::uint32_t slot) const { return sums_[LightNode::width - 1 + slot]; }
    std::uint32_t weight(std::uint32_t slot) const { return before(slot + 1) - before(slot); }
    double share(std::uint32_t slot) const { return double(weight(slot)) / double(total()); }
    /// The child whose interval of the prefix sums contains `number`, which is below the total.
    std::uint32_t slot_of(std::uint32_t number) const
    {
        int slot = 0;
        for (int i = 0; i < parts; ++i)
            slot += native::lanes -
                    std::popcount(native::mask_bits(native::less(native::UInt(number), native::load(up_to(i)))));
        return std::uint32_t(slot);
    }

private:
    /// Prefix sums from the child `lanes * native::lanes` on, each including its own weight. A zero precedes the first.
    std::uint32_t* up_to(int lanes) { return sums_ + LightNode::width + lanes * native::lanes; }
    const std::uint32_t* up_to(int lanes) const { return sums_ + LightNode::width + lanes * native::lanes; }

    /// The alignment lets vectors be stored and then read back as scalars without a stall.
    alignas(64) std::uint32_t sums_[2 * LightNode::width];
};

/// Weights of a node's children at a point; children are the lanes.
inline LightWeights light_weights(const LightNode& n, const float (&p)[3])
{
    constexpr int parts = LightWeights::parts;
    const native::Float x(p[0]), y(p[1]), z(p[2]);
    Importance<native::Float, native::Mask> seen[parts];
    native::Float most(0.f);
    for (int i = 0; i < parts; ++i) {
        const auto read = [&](const LightNode::Column& c) { return native::load(c + i * native::lanes); };
        seen[i] = importance<native::Mask>(LightBounds<native::Float>::of(n, read), x, y, z, {!n.has_narrow, false});
        most = max(most, native::select(seen[i].reaches, seen[i].value, native::Float(0.f)));
    }
    const native::Float scale = weight_scale(native::Float(-native::least(-most)));
    native::UInt weight[parts];
    for (int i = 0; i < parts; ++i) weight[i] = light_weight<native::UInt>(seen[i], scale);
    const LightWeights w(weight);
    if (w.total() > 0) return w;
    // If no light reaches the point, children become equally likely, so that select() always returns a light.
    for (int i = 0; i < parts; ++i) {
        const native::UInt slot = native::iota() + native::UInt(std::uint32_t(i * native::lanes));
        weight[i] = native::select(native::less(slot, native::UInt(n.count)), native::UInt(1u), native::UInt(0u));
    }
    return LightWeights(weight);
}

}  // namespace detail

/// Selects lights by traversal of the light tree.
class LightTree {
public:
    struct Choice {
        UInt light;
        Float pmf;
    };

    explicit LightTree(const LightTables& tables) : tables_(tables) {}

    /// Selects a light for a vertex at p by a number u in [0, 1) of 24 bits; `noise`, also in [0, 1), provides further
    /// bits.
    [[gnu::noinline]] Choice select(Vec3 p, Float u, Float noise, Mask m) const
    {
        const LightNode& root = tables_.light_tree.front();
        const RootWeights w(root, p);
        const UInt slot = w.slot_of(u);
        const UInt child = lookup(root.child, LightNode::width, slot);
        const Choice c{child & UInt(~LightNode::is_light), w.share(slot)};
        const Mask deeper = m & (child == c.light);
        return any(deeper) ? descend(p, below_root(w, slot, u, noise), c, deeper) : c;
    }

    /// Probability with which select() returns the light at a position of the tree, for the lanes of m.
    [[gnu::noinline]] Float pmf(UInt place, Vec3 p, Mask m) const
    {
        const RootWeights w(tables_.light_tree.front(), p);
        const Mask deeper = m & !less(place, UInt(LightNode::width));
        if (!any(deeper)) return w.share(place);
        const Climb up = climb(place, p, deeper);
        return w.share(up.slot) * up.chance;
    }

private:
    /// Weights of the root's children with points as lanes: every lane starts at the root, so no lane is idle.
    class RootWeights {
    public:
        RootWeights(const LightNode& root, Vec3 p) : count_(root.count)
        {
            detail::Importance<Float, Mask> seen[LightNode::width];
            Float most(0.f);
            for (std::uint32_t i = 0; i < count_; ++i) {
                const auto read = [&](const LightNode::Column& c) { return Float(c[i]); };
                const bool wide = !(root.cos_emission[i] > 0);
                const bool flat = wide && root.sin_normals[i] < detail::narrow_normals;
                const auto bounds = detail::LightBounds<Float>::of(root, read);
                seen[i] = detail::importance<Mask>(bounds, p.x, p.y, p.z, {wide, flat});
                most = max(most, fathom::select(seen[i].reaches, seen[i].value, Float(0.f)));
            }
            const Float scale = detail::weight_scale(most);
            for (std::uint32_t i = 0; i < count_; ++i)
                total_ += weight_[i] = detail::light_weight<UInt>(seen[i], scale);
            const Mask nothing = total_ == UInt(0u);
            if (!any(nothing)) return;
            for (std::uint32_t i = 0; i < count_; ++i) weight_[i] = fathom::select(nothing, UInt(1u), weight_[i]);
            total_ = fathom::select(nothing, UInt(count_), total_);
        }

        UInt total() const { return total_; }
        /// The child whose interval of the prefix sums contains u times the total.
        UInt slot_of(Float u) const
        {
            UInt x = to_uint(u * to_float(total_));
            x = fathom::select(less(x, total_), x, total_ - UInt(1u));
            UInt slot(0u), up_to(0u);
            for (std::uint32_t i = 1; i < count_; ++i) {
                up_to += weight_[i - 1];
                slot = fathom::select(less(x, up_to), slot, UInt(i));
            }
            return slot;
        }
        UInt weight(UInt slot) const
        {
            UInt weight(0u);
            for (std::uint32_t i = 0; i < count_; ++i) weight = fathom::select(slot == UInt(i), weight_[i], weight);
            return weight;
        }
        /// Sum of the weights of the children before `slot`.
        UInt before(UInt slot) const
        {
            UInt sum(0u);
            for (std::uint32_t i = 0; i < count_; ++i) sum += fathom::select(less(UInt(i), slot), weight_[i], UInt(0u));
            return sum;
        }
        Float share(UInt slot) const { return to_float(weight(slot)) / to_float(total_); }

    private:
        std::uint32_t count_;
        UInt weight_[LightNode::width], total_ = UInt(0u);
    };

    struct Points {
        float x[lanes], y[lanes], z[lanes];
        explicit Points(Vec3 p) { store(x, p.x), store(y, p.y), store(z, p.z); }
    };

    /// State of a descent through the tree.
    struct Descent {
        double x;       ///< the random number, rescaled to the interval of the current child
        double chance;  ///< probability of reaching the current child
        std::uint32_t child;
    };

    static void step(Descent& d, const LightNode& n, const detail::LightWeights& w)
    {
        const double at = d.x * double(w.total());
        const std::uint32_t slot = w.slot_of(std::min(std::uint32_t(at), w.total() - 1)), weight = w.weight(slot);
        d = {within(at, w.before(slot), weight), d.chance * (double(weight) / double(w.total())), n.child[slot]};
    }

    /// Position of a number within a child's interval, rescaled to [0, 1).
    static double within(double at, std::uint32_t before, std::uint32_t weight)
    {
        return std::clamp((at - double(before)) / double(weight), 0.0, 1 - 0x1p-53);
    }

    struct Numbers {
        double of[lanes];
    };

    /// Returns u and noise rescaled after the root's child is selected. They have 48 bits in all, since 24 would not
    /// suffice for many lights.
    static Numbers below_root(const RootWeights& w, UInt slot, Float u, Float noise)
    {
        float high[lanes], low[lanes];
        std::uint32_t total[lanes], before[lanes], weight[lanes];
        store(high, u), store(low, noise);
        store(total, w.total()), store(before, w.before(slot)), store(weight, w.weight(slot));
        Numbers x;
        for (int k = 0; k < lanes; ++k)
            x.of[k] = within((double(high[k]) + double(low[k]) * 0x1p-24) * double(total[k]), before[k], weight[k]);
        return x;
    }

    /// Descends from the root's children in c. All lanes go down one level per iteration, and weights of all lanes are
    /// computed before any lane steps, so that their memory latencies overlap.
    Choice descend(Vec3 p, const Numbers& x, const Choice& c, Mask m) const
    {
        const Points points(p);
        float pmf[lanes];
        std::uint32_t light[lanes];
        Descent down[lanes];
        detail::LightWeights weights[lanes];
        store(light, c.light), store(pmf, c.pmf);
        for_each_active(m, [&](int k) { down[k] = {x.of[k], double(pmf[k]), light[k]}; });
        while (any(m)) {
            std::uint32_t inner = 0;
            for_each_active(m, [&](int k) {
                const LightNode& n = tables_.light_tree[down[k].child];
                weights[k] = detail::light_weights(n, {points.x[k], points.y[k], points.z[k]});
            });
            for_each_active(m, [&](int k) {
                step(down[k], tables_.light_tree[down[k].child], weights[k]);
                inner |= std::uint32_t(!(down[k].child & LightNode::is_light)) << k;
                light[k] = down[k].child & ~LightNode::is_light, pmf[k] = float(down[k].chance);
            });
            m = mask_from_bits(inner);
        }
        return {load(light), load(pmf)};
    }

    struct Climb {
        UInt slot;     ///< child of the root that contains the position
        Float chance;  ///< probability of the position, given that child
    };

    Climb climb(UInt place, Vec3 p, Mask m) const
    {
        const Points points(p);
        std::uint32_t at[lanes];
        float chances[lanes];
        store(at, place), store(chances, Float(1.f));
        for_each_active(m, [&](int k) {
            double chance = 1;
            while (at[k] >= LightNode::width) {
                const LightNode& n = tables_.light_tree[at[k] / LightNode::width];
                chance *=
                    detail::light_weights(n, {points.x[k], points.y[k], points.z[k]}).share(at[k] % LightNode::width);
                at[k] = n.parent;
            }
            chances[k] = float(chance);
        });
        return {load(at), load(chances)};
    }

    const LightTables& tables_;
};

}  // namespace FATHOM_LANES
}  // namespace fathom
