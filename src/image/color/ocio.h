// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>

#include "fathom/ocio.h"

namespace fathom {

/// A display transform by OpenColorIO: a view of a display in a configuration.
class OcioView {
public:
    OcioView() = default;
    OcioView(const OcioView&) = delete;
    virtual ~OcioView() = default;

    /// Transforms linear Rec.709 to encoded display values in [0, 1], in place. Thread-safe.
    virtual void apply(float rgb[3]) const = 0;
    /// Names of configuration, display, view and look in one line, for messages.
    virtual std::string text() const = 0;
};

}  // namespace fathom
