// SPDX-License-Identifier: Apache-2.0
#include "kernel/kernel.h"

using namespace fathom;

extern "C" {
/// The only symbol of a kernel library. src/kernel/library looks it up.
extern FATHOM_API const KernelFunctions fathom_kernel;
const KernelFunctions fathom_kernel{FATHOM_VERSION,    make_kernel_scene,   pixels_with_surfaces, render_job,
                                    trace_light_paths, trace_pixel_centers, move_surface_points,  look_up_texture,
                                    kernel_lanes,      kernel_name};
}
