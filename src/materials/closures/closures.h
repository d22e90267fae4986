#pragma once
/// All closures: the list that the path loop is made from.
#include "materials/closures/diffuse.h"
#include "materials/closures/disney.h"
#include "materials/closures/fuzz_metal.h"
#include "materials/closures/glass.h"
#include "materials/closures/hair.h"
#include "materials/closures/layered.h"
#include "materials/closures/measured.h"
#include "materials/closures/metal.h"
#include "materials/closures/plastic.h"
#include "materials/closures/principled.h"

namespace fathom {
inline namespace FATHOM_LANES {

/// Of little code: neither of more than a MaterialPoint nor of fibres.
template <class Closure>
inline constexpr bool is_small = std::is_same_v<typename Closure::Point, MaterialPoint> && !Closure::is_fiber;

template <class... Closure>
struct ClosureList {
    static constexpr bool contains(ClosureKind kind) { return ((Closure::kind == kind) || ...); }
    static constexpr bool transmits(ClosureKind kind) { return ((Closure::kind == kind && Closure::transmits) || ...); }
    static constexpr bool is_small(ClosureKind kind)
    {
        return ((Closure::kind == kind && fathom::is_small<Closure>) || ...);
    }
    /// Calls f.template operator()<Closure>() for the closure of a kind, if it has one.
    template <class F>
    static void visit(ClosureKind kind, F&& f)
    {
        ((Closure::kind == kind ? f.template operator()<Closure>() : void()), ...);
    }
};

using Closures = ClosureList<DiffuseBsdf, MetalBsdf, FuzzMetalBsdf, GlassBsdf, PlasticBsdf, HairBsdf, PrincipledBsdf,
                             DisneyBsdf<false>, DisneyBsdf<true>, LayeredBsdf<false>, LayeredBsdf<true>, MeasuredBsdf>;

}  // namespace FATHOM_LANES
}  // namespace fathom
