// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "session/trial_image.h"

namespace fathom {

/// Adds a splat for each photon of the light samples whose place is within the camera's view: about what the photon
/// brings to the image if camera paths come to it through glass or over mirrors, which turn them a little. Whether they
/// do is not known.
void add_seen_photons(LightSamples& samples, const CameraRecord& camera, const TrialImage& image);

}  // namespace fathom
