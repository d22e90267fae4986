#pragma once
/// All closures: the list that the path loop is made from.
#include "shading/closures/diffuse.h"
#include "shading/closures/disney.h"
#include "shading/closures/fuzz_metal.h"
#include "shading/closures/glass.h"
#include "shading/closures/hair.h"
#include "shading/closures/layered.h"
#include "shading/closures/measured.h"
#include "shading/closures/metal.h"
#include "shading/closures/plastic.h"
#include "shading/closures/principled.h"

namespace fathom::inline FATHOM_LANES {

/// Of little code: neither of more than a MaterialPoint nor of fibres.
template <class Closure>
inline constexpr bool is_small = std::is_same_v<typename Closure::Point, MaterialPoint> && !Closure::is_fibre;

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

}  // namespace fathom::inline FATHOM_LANES
