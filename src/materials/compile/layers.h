// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "compile/compiler.h"

namespace fathom {

/// LayersRecord::Features of a principled material.
std::uint32_t layer_features(const Material& m);

/// Adds the LayersRecord of a principled material and sets the features that follow from it. Returns its index.
std::uint32_t add_layers(Compiler& c, const Material& m, MaterialRecord& t);

}  // namespace fathom
