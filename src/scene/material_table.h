#pragma once
#include "scene/parameters.h"

namespace fathom {

/// Every kind of material, as a reader would list them.
std::span<const KindName<MaterialKind>> material_kinds();
/// Every parameter of materials. A key may stand there several times, for different kinds.
std::span<const Parameter<Material>> material_parameters();

}  // namespace fathom
