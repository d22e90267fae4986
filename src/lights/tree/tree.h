#pragma once
/// The light tree: each light that has a place is chosen by about as much as it brings to a point.
///
/// Conty Estevez and Kulla 2018, "Importance Sampling of Many Lights with Adaptive Tree Splitting": bounds of position,
/// normals and intensity; a child is chosen by a bound on what it may bring, so down to one light. Here nodes have up
/// to 16 children, and importances become integers before they are added: their sum has the same bits in any order.
/// What may reach the point has a weight of 1 at least, so that nothing that counts is never chosen.
#include <algorithm>
#include <bit>

#include "lights/records.h"
#include "math/vec3.h"

namespace fathom {
inline namespace FATHOM_LANES {

namespace detail {

/// The largest weight: sums of a node's stay below 2^20, so that products with numbers in [0, 1) lose nothing.
inline constexpr float largest_weight = 65535;

/// Bounds of a light or a node, one for each lane of F: native lanes, which are children, or Float, which are points.
template <class F>
struct LightBounds {
    F x, y, z, radius, axis_x, axis_y, axis_z, cos_normals, sin_normals, cos_emission, back, intensity;

    /// read(column)
    template <class Read>
    [[gnu::always_inline]] static LightBounds of(const LightNode& n, Read&& read)
    {
        return {read(n.x),      read(n.y),        read(n.z),           read(n.radius),      read(n.axis_x),
                read(n.axis_y), read(n.axis_z),   read(n.cos_normals), read(n.sin_normals), read(n.cos_emission),
                read(n.back),   read(n.intensity)};
    }
};

/// Sine of an angle that makes no difference to importances.
inline constexpr float narrow_normals = 1.f / 256;

template <class F, class M>
struct Importance {
    F value;  ///< at least 0
    M reaches;
};

/// What need not be asked of bounds.
struct BoundsHints {
    bool wide_emission;   ///< light goes to all directions above its surface
    bool narrow_normals;  ///< besides, no normal is farther than narrow_normals from the axis
};

/// A bound on what lights within the bounds bring to a point: paper section 4, without the receiver's cosine.
///
/// In lengths along normals instead of angles, one root and one division do: of the normals the one that is nearest to
/// the point's direction, as the middle of the ball sees it; and no light is farther behind that plane than the ball's
/// radius. Where light goes to few directions only, that is too rough: there the angle under which the ball is seen
/// counts.
template <class M, class F>
[[gnu::always_inline]] inline Importance<F, M> importance(const LightBounds<F>& b, F px, F py, F pz, BoundsHints hints)
{
    const F x = px - b.x, y = py - b.y, z = pz - b.z;
    const F distance2 = fma(x, x, fma(y, y, z * z)), radius2 = b.radius * b.radius;
    // Within the ball as on it.
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

template <class U, class F, class M>
[[gnu::always_inline]] inline U light_weight(const Importance<F, M>& i, F scale)
{
    const U w = to_uint(min(i.value * scale, F(largest_weight)));
    return select(i.reaches, select(less(w, U(1u)), U(1u), w), U(0u));
}

/// What importances are multiplied by to become weights.
template <class F>
[[gnu::always_inline]] inline F weight_scale(F largest)
{
    return F(largest_weight) / max(largest, F(1e-30f));
}

/// A node's weights as a point sees them, added up child by child.
class LightWeights {
public:
    static constexpr int parts = LightNode::width / native::lanes;

    LightWeights() {}  // nothing: many are made, and then assigned to
    explicit LightWeights(const native::UInt (&weights)[parts])
    {
        std::uint32_t before = sums_[LightNode::width - 1] = 0;
        for (int i = 0; i < parts; ++i) {
            native::store(up_to(i), native::running_sums(weights[i]) + native::UInt(before));
            before = *(up_to(i + 1) - 1);
        }
    }

    std::uint32_t total() const { return sums_[2 * LightNode::width - 1]; }
    /// Of the children before one.
    std::uint32_t before(std::uint32_t slot) const { return sums_[LightNode::width - 1 + slot]; }
    std::uint32_t weight(std::uint32_t slot) const { return before(slot + 1) - before(slot); }
    double share(std::uint32_t slot) const { return double(weight(slot)) / double(total()); }
    /// The child within whose weight a number below the total is.
    std::uint32_t slot_of(std::uint32_t number) const
    {
        int slot = 0;
        for (int i = 0; i < parts; ++i)
            slot += native::lanes -
                    std::popcount(native::mask_bits(native::less(native::UInt(number), native::load(up_to(i)))));
        return std::uint32_t(slot);
    }

private:
    /// From a lane's child on: the sums up to each, with it. Before the first is a 0.
    std::uint32_t* up_to(int lanes) { return sums_ + LightNode::width + lanes * native::lanes; }
    const std::uint32_t* up_to(int lanes) const { return sums_ + LightNode::width + lanes * native::lanes; }

    /// Aligned, so that what is stored as lanes can be read as numbers at once.
    alignas(64) std::uint32_t sums_[2 * LightNode::width];
};

/// Children as lanes.
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
    // Nothing reaches: each as likely as another, so that there is always a light.
    for (int i = 0; i < parts; ++i) {
        const native::UInt slot = native::iota() + native::UInt(std::uint32_t(i * native::lanes));
        weight[i] = native::select(native::less(slot, native::UInt(n.count)), native::UInt(1u), native::UInt(0u));
    }
    return LightWeights(weight);
}

}  // namespace detail

/// Choice of a light by a tree.
class LightTree {
public:
    struct Choice {
        UInt light;
        Float pmf;
    };

    explicit LightTree(const LightTables& tables) : tables_(tables) {}

    /// The light for a number u in [0, 1) of 24 bits and more bits of chance, `noise`, in [0, 1) too.
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

    /// The probability with which select() gives the light at a place of the tree, for the lanes of m.
    [[gnu::noinline]] Float pmf(UInt place, Vec3 p, Mask m) const
    {
        const RootWeights w(tables_.light_tree.front(), p);
        const Mask deeper = m & !less(place, UInt(LightNode::width));
        if (!any(deeper)) return w.share(place);
        const Climb up = climb(place, p, deeper);
        return w.share(up.slot) * up.chance;
    }

private:
    /// Weights of the root's children with points as lanes: all start there, so that none waits for another.
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
        /// The child within whose weight u of the total is.
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
        /// Of the children before one.
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

    /// Where a point is on its way down.
    struct Descent {
        double x;       ///< what is left of its number
        double chance;  ///< to have come here
        std::uint32_t child;
    };

    static void step(Descent& d, const LightNode& n, const detail::LightWeights& w)
    {
        const double at = d.x * double(w.total());
        const std::uint32_t slot = w.slot_of(std::min(std::uint32_t(at), w.total() - 1)), weight = w.weight(slot);
        d = {within(at, w.before(slot), weight), d.chance * (double(weight) / double(w.total())), n.child[slot]};
    }

    /// Where a number is within a child's weight, in [0, 1).
    static double within(double at, std::uint32_t before, std::uint32_t weight)
    {
        return std::clamp((at - double(before)) / double(weight), 0.0, 1 - 0x1p-53);
    }

    struct Numbers {
        double of[lanes];
    };

    /// What is left of u and noise once the root's child is known. 48 bits of chance: 24 are soon used up by many
    /// lights.
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

    /// From the root's children, which c tells with their chances. All lanes go down a level before one goes further,
    /// and all are weighted before one is: what one waits for does not keep the others.
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
        UInt slot;     ///< of the root, below which the place is
        Float chance;  ///< of the place, once that slot is chosen
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
