#pragma once
#include <optional>
#include <string>
#include <utility>

#include "options/arguments.h"

namespace fathom::cli {

/// Where the sun stands, in one of three ways.
struct SunOptions {
    std::optional<double> elevation_deg, azimuth_deg;
    std::optional<Vec3d> direction;
    std::optional<std::pair<double, double>> place_deg;  ///< latitude to the north, longitude to the east
    std::optional<double> julian_day;

    bool given() const;
};

void add_sun_options(Command& command, SunOptions& options);
/// Throws UsageError if they disagree.
void check_sun(const SunOptions& options);
/// Towards the sun. Of a place and a date: +x is east there, -z north.
Vec3d direction_to_sun(const SunOptions& options);

}  // namespace fathom::cli
