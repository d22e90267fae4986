#pragma once

namespace fathom {

/// How the tree that rays walk through is built. The hits, and so the pictures, are the same.
///
/// fast      by Morton codes: previews of large scenes
/// standard  by the surface area heuristic
/// high      the same with large triangles cut in pieces where that is better, and the whole tree improved: takes
///           longer and more memory, casts rays faster
/// compact   the standard tree, whose leaves hold each vertex once: for scenes of tens of millions of triangles, which
///           else take a third more memory
enum class TreeBuild { fast, standard, high, compact };

}  // namespace fathom
