#pragma once
#include "scene/parameters.h"

namespace fathom {

/// Every kind of material, in the order of MaterialKind.
std::span<const KindName<MaterialKind>> material_kinds();
/// Every parameter of materials. A key may stand there several times, for different kinds.
std::span<const Parameter<Material>> material_parameters();

}  // namespace fathom
