#pragma once

namespace fathom::mitsuba {

/// Of light from everywhere below a rough boundary, the share that its facets throw back at once, as `roughplastic` has
/// it: the plain mean of 64 cosines from 0 to 1 with both ends, which is 1 to 2 % less than the integral.
double inner_reflectance(double alpha, bool beckmann, double ior);

}  // namespace fathom::mitsuba
