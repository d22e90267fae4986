// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <nanobind/nanobind.h>

namespace fathom::python {

/// Adds fathom.Error, and translates exceptions of the library and of option parsing.
void bind_error(nanobind::module_& module);

}  // namespace fathom::python
