// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Compilation of texture nodes.
#include "textures/compile/images.h"

namespace fathom {

/// Adds the record of each texture of the scene.
void compile_textures(Compiler& c, const ImageStore& images);

}  // namespace fathom
