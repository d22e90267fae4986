#pragma once
#include <memory>
#include <string>

#include "fathom/api.h"

namespace fathom {

/// A display transform of an OpenColorIO configuration, for DisplayTransform::ocio.
class OcioView;

/// Which one.
struct OcioChoice {
    std::string config;         ///< a file, or the name of a built-in one (`ocio://...`); none: $OCIO
    std::string display, view;  ///< none: the configuration's default
    std::string look;           ///< instead of the view's own; none: the view's
    std::string input;          ///< what the configuration calls linear Rec.709; none: found by its usual names
};

/// Throws Error: where a name is not there, with those that are; in a build without OpenColorIO, how to get it.
FATHOM_API std::shared_ptr<const OcioView> open_ocio(const OcioChoice& choice);
/// Names of what was chosen, in a line.
FATHOM_API std::string ocio_text(const OcioView& view);

}  // namespace fathom
