// SPDX-License-Identifier: Apache-2.0
#include "materials/compile/measured.h"
#include "compile/compiler.h"
#include "fathom/error.h"
#include "materials/closures/measured_tables.h"
#include "materials/compile/inputs.h"
#include "scene/measured.h"

namespace fathom {

/// Adds the values of all measured surfaces to the tables.
void compile_measured_tables(Compiler& c)
{
    double count = 0;
    for (const MeasuredBrdf& brdf : c.scene.measured) count += measured_value_count(brdf);
    constexpr double most = 0x7fffffff;  // largest index that lanes of 32 bits address with a signed gather
    if (count > most) throw Error(c.scene.file, "", "its measured materials have more than 2,147,483,647 values");
    c.tables.measured_values.reserve(std::size_t(count));
    for (const MeasuredBrdf& brdf : c.scene.measured)
        c.tables.measured.push_back(add_measured(brdf, c.tables.measured_values));
}

void compile_measured(Compiler& c, const Material& m, MaterialRecord& t)
{
    const MeasuredBrdf& brdf = c.scene.measured[std::size_t(m.measured)];
    t.set_parameters(MeasuredSurfaceRecord{std::uint32_t(m.measured)});
    t.base_color = spectrum(reflectance_of(brdf));  // reflectance for albedo layers
    t.features.add(MaterialFeature::needs_tangent, !brdf.is_isotropic());
}

}  // namespace fathom
