// SPDX-License-Identifier: Apache-2.0
#pragma once
/// The list of all closures, from which the path kernel is generated.
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

/// Whether a closure has little code: no record in a table of its own, and no support of fibers.
template <class Closure>
inline constexpr bool is_small =
    !is_layered<Closure> && !is_disney<Closure> && !is_measured<Closure> && !Closure::is_fiber;

/// A list of closure types with lookup by ClosureKind.
template <class... Closure>
struct ClosureList {
    static constexpr bool contains(ClosureKind kind) { return ((Closure::kind == kind) || ...); }
    static constexpr bool transmits(ClosureKind kind) { return ((Closure::kind == kind && Closure::transmits) || ...); }
    static constexpr bool is_small(ClosureKind kind)
    {
        return ((Closure::kind == kind && fathom::is_small<Closure>) || ...);
    }
    /// Calls f.template operator()<Closure>() for the closure of a kind, if there is one.
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
