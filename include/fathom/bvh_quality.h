// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace fathom {

/// How the BVH is built. All of them give the same intersections, and so the same image.
enum class BvhQuality {
    fast,      ///< Sorts primitives by Morton codes. For previews of large scenes: quick to build, slower to trace.
    standard,  ///< Splits by the surface area heuristic.
    high,      ///< As standard, with spatial splits of large triangles and a subsequent optimization of the whole tree.
               ///< It takes more time and memory to build and is faster to trace.
    compact  ///< As standard, with leaves that store shared vertices once. It takes a third less memory, for scenes of
             ///< tens of millions of triangles.
};

}  // namespace fathom
