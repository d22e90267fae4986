// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <memory>
#include <string>

#include "fathom/api.h"

namespace fathom {

/// A display transform of an OpenColorIO configuration, for DisplayTransform::ocio.
class OcioView;

/// Selects a display transform of an OpenColorIO configuration.
struct OcioChoice {
    /// File, or name of a built-in configuration (`ocio://...`); empty: the environment variable OCIO.
    std::string config;
    std::string display, view;  ///< Names of display and view; empty: the defaults of the configuration.
    std::string look;           ///< Replaces the looks of the view; empty: those of the view.
    std::string input;          ///< Name of the color space that is linear Rec.709; empty: found by its usual names, or
                                ///< else by way of the configuration's ACES interchange role.
};

/// Opens a display transform. Throws Error if a name doesn't exist, listing those that do, or if the library was built
/// without OpenColorIO.
FATHOM_API std::shared_ptr<const OcioView> open_ocio(const OcioChoice& choice);
/// Returns a line that names the configuration, display, view, look and input color space in use.
FATHOM_API std::string ocio_text(const OcioView& view);

}  // namespace fathom
