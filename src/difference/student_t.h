// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace fathom {

/// Probability that the magnitude of a value of Student's t distribution is at least `t`.
///
/// freedom  degrees of freedom, above 0; need not be a whole number
double student_t_two_sided(double t, double freedom);

}  // namespace fathom
