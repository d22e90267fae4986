// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <memory>

#include "fathom/image.h"
#include "run.h"

namespace fathom::python {

/// An image that never changes, with the conversion for displays. Arrays of its layers keep it alive.
struct Layers {
    std::shared_ptr<const Image> image;
    DisplayChoice display;
};

}  // namespace fathom::python
