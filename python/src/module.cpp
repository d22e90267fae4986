// SPDX-License-Identifier: Apache-2.0
#include <nanobind/nanobind.h>

#include "bindings.h"
#include "error.h"
#include "fathom/render.h"

NB_MODULE(_fathom, module)
{
    module.doc() = "The C++ library behind the package fathom. Its names may change; use those of fathom.";
    module.attr("__version__") = FATHOM_VERSION;
    fathom::python::bind_error(module);
    fathom::python::bind_layers(module);
    fathom::python::bind_difference(module);
    fathom::python::bind_film(module);
    fathom::python::bind_run(module);
    fathom::python::bind_scene(module);
    fathom::python::bind_views(module);
    module.def("simd_name", &fathom::simd_name);
}
