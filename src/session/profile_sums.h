// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>
#include <map>
#include <tuple>
#include <vector>

#include "fathom/profile.h"
#include "kernel/kernel.h"

namespace fathom {

/// Tables of a profile, by what their rows stand for.
enum class ProfileTable { lights, materials, objects, paths, depths, combinations };
inline constexpr std::size_t profile_table_count = 6;

/// A cause that has an index.
struct IndexedCause {
    ProfileCause cause = ProfileCause::camera;
    std::uint64_t index = 0;

    auto operator<=>(const IndexedCause&) const = default;
};

/// Identifies a row of a table.
struct ProfileKey {
    ProfileCause cause = ProfileCause::camera;
    std::uint64_t value = 0;  ///< index, or the word of a path
    bool is_sampled = false;
    IndexedCause light{}, place{};  ///< of combinations

    auto operator<=>(const ProfileKey&) const = default;
};

/// Names of the compiled scene's numbers in the description.
class ProfileNames {
public:
    ProfileNames(const SceneTables& tables, const std::vector<SceneObject>& objects);

    using Keys = std::array<ProfileKey, profile_table_count>;
    /// Rows that light belongs to.
    Keys keys_of(const PathContribution& contribution) const;
    /// Rows that work belongs to, apart from the light of its shadow ray. Work for both light samples and rays counts
    /// as that of sampled paths.
    Keys keys_of(const PathCost& cost) const;
    ProfileKey light_key(std::uint32_t light) const;

private:
    ProfileKey emitter_key(std::uint32_t object) const;
    Keys keys_of(const PathPlace& place, ProfileKey light, bool is_sampled) const;

    const SceneTables& tables_;
    std::vector<std::uint32_t> object_of_shape_;
    std::size_t objects_;
};

/// Sums of a row: what it adds to the image's squared relative error, to its light and its work.
struct ProfileSums {
    double noise = 0;
    std::array<double, profile_sets> without{};  ///< noise by all sets except one
    double light = 0;
    double nanoseconds = 0;
    std::uint64_t rays = 0, shadow_rays = 0;

    void add(const ProfileSums& o);
};

/// A pixel of a profile.
struct ProfilePixel {
    std::array<double, 3> mean{};
    double noise = 0;  ///< squared relative error
    double nanoseconds = 0;
};

/// Sums of some pixels.
struct ProfileTileSums {
    std::array<std::map<ProfileKey, ProfileSums>, profile_table_count> tables;
    ProfileSums total;
    std::vector<ProfilePixel> pixels;
};

/// Computes the sums of a tile. sets: the records of each set of samples; paths are numbered pixel by pixel.
ProfileTileSums sum_profile(const ProfileNames& names, const std::array<PathProfile, profile_sets>& sets,
                            std::size_t pixels, int set_samples);

}  // namespace fathom
