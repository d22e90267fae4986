#pragma once
#include <string>

#include "fathom/ocio.h"

namespace fathom {

class OcioView {
public:
    OcioView() = default;
    OcioView(const OcioView&) = delete;
    virtual ~OcioView() = default;

    /// Linear Rec.709 becomes what the display is sent, 0 to 1. From any thread.
    virtual void apply(float rgb[3]) const = 0;
    /// Names of what was chosen, in a line.
    virtual std::string text() const = 0;
};

}  // namespace fathom
