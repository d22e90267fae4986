// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "scene/parameters.h"

namespace fathom {

/// Every kind of material, in the order in which documents list them.
std::span<const KindName<MaterialKind>> material_kinds();
/// Every parameter of materials. A key may appear several times, for different kinds.
std::span<const Parameter<Material>> material_parameters();

}  // namespace fathom
