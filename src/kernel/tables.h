// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "geometry/records.h"
#include "lights/records.h"
#include "materials/records.h"
#include "media/records.h"

namespace fathom {

/// The compiled scene as the kernel reads it: the tables of geometry, shading, media and lights.
struct SceneTables : GeometryTables, ShadingTables, MediaTables, LightTables {};

}  // namespace fathom
