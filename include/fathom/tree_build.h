#pragma once

namespace fathom {

/// How much work goes into the tree that rays walk through. The hits, and so the pictures, are the same.
///
/// fast      by Morton codes: previews of large scenes
/// standard  by the surface area heuristic
/// high      the same with large triangles cut in pieces where that is better, and the whole tree improved: takes
/// longer
///           and more memory, casts rays faster
enum class TreeBuild { fast, standard, high };

}  // namespace fathom
