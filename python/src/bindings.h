// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <nanobind/nanobind.h>

/// Functions that add the parts of the module; each is defined in a file of that name.
namespace fathom::python {

/// Adds Scene, load() and render_options().
void bind_scene(nanobind::module_& module);
/// Adds Film.
void bind_film(nanobind::module_& module);
/// Adds Comparable and compare().
void bind_difference(nanobind::module_& module);
/// Adds Layers, an image in memory.
void bind_layers(nanobind::module_& module);
/// Adds Views, ViewArrays and prepare_views().
void bind_views(nanobind::module_& module);
/// Adds Run, render() and Pass.
void bind_run(nanobind::module_& module);

}  // namespace fathom::python
