#pragma once
#include "geometry/records.h"
#include "light/records.h"
#include "media/records.h"
#include "shading/records.h"

namespace fathom {

/// The scene as the kernel reads it: what each floor owns, in one place.
struct SceneTables : GeometryTables, ShadingTables, MediaTables, LightTables {};

}  // namespace fathom
