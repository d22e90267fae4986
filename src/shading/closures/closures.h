#pragma once
/// All closures: the list that the path loop is made from.
#include "shading/closures/diffuse.h"
#include "shading/closures/fuzz_metal.h"
#include "shading/closures/glass.h"
#include "shading/closures/metal.h"
#include "shading/closures/principled.h"

namespace fathom::inline FATHOM_LANES {

template <class... Closure>
struct ClosureList {
    static constexpr bool contains(MaterialKind kind) { return ((Closure::kind == kind) || ...); }
    static constexpr bool transmits(MaterialKind kind)
    {
        return ((Closure::kind == kind && Closure::transmits) || ...);
    }
    /// Calls f.template operator()<Closure>() for the closure of a kind, if it has one.
    template <class F>
    static void visit(MaterialKind kind, F&& f)
    {
        ((Closure::kind == kind ? f.template operator()<Closure>() : void()), ...);
    }
};

using Closures = ClosureList<DiffuseBsdf, MetalBsdf, FuzzMetalBsdf, GlassBsdf, PrincipledBsdf>;

}  // namespace fathom::inline FATHOM_LANES
