// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "compile/scene_data.h"

namespace fathom::test {

/// Renders a scene of quads by the general loop from now on, as if the loop for such scenes did not exist.
inline void force_general_loop(const Scene& scene)
{
    scene.data().kernel->force_general_loop();
}

}  // namespace fathom::test
