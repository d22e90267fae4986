// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>
#include <string>
#include <utility>

#include "fathom/description.h"
#include "options/command.h"

namespace fathom::cli {

/// Position of the sun: by two angles, by a direction, or by place and date.
struct SunOptions {
    std::optional<double> elevation_deg, azimuth_deg;
    std::optional<Vec3d> direction;
    std::optional<std::pair<double, double>> place_deg;  ///< latitude (north), longitude (east)
    std::optional<double> julian_day;

    /// Whether any of the options was given.
    bool given() const;
};

void add_sun_options(Command& command, SunOptions& options);
/// Throws UsageError for options that contradict each other.
void check_sun(const SunOptions& options);
/// Direction towards the sun. For a place and a date, +x is east and -z is north.
Vec3d direction_to_sun(const SunOptions& options);

}  // namespace fathom::cli
