// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <atomic>
#include <string>
#include <vector>

#include "fathom/editable_scene.h"
#include "why/causes.h"
#include "why/trial.h"

namespace fathom::cli {

/// Something that a user can change, and what it brought when it was tried.
struct Remedy {
    std::string cause;   ///< what it is against: "caustics: 61 % of the noise"
    double share = 0;    ///< of noise or time that the cause has
    std::string action;  ///< "--caustics on"
    std::string price;   ///< what else changes, such as a bias; may be empty
    Gain gain;

    /// Whether the gain is above 1 even at the low end of its interval.
    bool helps() const;
};

/// The scene as it was profiled.
struct ProfiledScene {
    EditableScene& edit;
    const RenderJob& job;
    const RenderProfile& profile;
    const CauseNames& names;
    bool has_refracted_light = false;  ///< LitScene::refracted_light
    double exposure_ev = 0;
};

/// Tries what could help against the causes of noise and time, and measures each. Remedies that help come first, by the
/// share of their cause. A scene that was changed is restored.
///
/// samples  per pixel of each trial
std::vector<Remedy> try_remedies(ProfiledScene scene, int samples, const std::atomic<bool>& cancel);

}  // namespace fathom::cli
