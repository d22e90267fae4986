// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <vector>

#include "fathom/description.h"
#include "fathom/profile.h"

namespace fathom::cli {

/// A table of a profile with its title.
struct NamedTable {
    const char* key;    ///< in JSON: "materials"
    const char* title;  ///< "material"
    const std::vector<ProfileRow>& rows;
    bool has_work = true;  ///< whether rows have time and rays
};
std::vector<NamedTable> tables_of(const RenderProfile& profile);

/// Names what rows of a profile stand for.
class CauseNames {
public:
    CauseNames(const SceneDescription& scene, std::vector<SceneObject> objects);

    /// Name of the cause, for example "glass 'shade'", "environment" or "EDTTL by rays".
    std::string name(const ProfileRow& row) const;
    const std::vector<SceneObject>& objects() const { return objects_; }

private:
    std::string cause_name(ProfileCause cause, int index) const;

    std::vector<std::string> materials_, lights_;
    std::vector<SceneObject> objects_;
};

/// The largest causes in words, the largest first: of noise, then of time.
std::vector<std::string> largest_causes(const RenderProfile& profile, const CauseNames& names);

/// Text of a share, such as "61 %" or "0.3 %".
std::string percent(double share);

}  // namespace fathom::cli
