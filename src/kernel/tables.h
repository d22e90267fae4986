#pragma once
#include "geometry/records.h"
#include "lights/records.h"
#include "materials/records.h"
#include "media/records.h"

namespace fathom {

/// The scene as the kernel reads it: what each floor owns, in one place.
struct SceneTables : GeometryTables, ShadingTables, MediaTables, LightTables {};

}  // namespace fathom
