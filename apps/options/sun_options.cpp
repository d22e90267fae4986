// SPDX-License-Identifier: Apache-2.0
#include "options/sun_options.h"

#include <fmt/format.h>
#include <cmath>
#include <cstdio>
#include <numbers>

#include "fathom/sun.h"
#include "options/arguments.h"

namespace fathom::cli {

namespace {

constexpr double radians_per_degree = std::numbers::pi / 180;

/// Offset from UTC in minutes of a time zone, `Z` or `+02:00`; nothing for an invalid one.
std::optional<int> parse_zone(const std::string& text)
{
    if (text == "Z") return 0;
    int hours = 0, minutes = 0, used = 0;
    if (text.size() != 6 || (text[0] != '+' && text[0] != '-') ||
        std::sscanf(text.c_str() + 1, "%2d:%2d%n", &hours, &minutes, &used) != 2 || used != 5 || hours > 14 ||
        minutes > 59)
        return {};
    return (text[0] == '-' ? -1 : 1) * (60 * hours + minutes);
}

struct Date {
    int year = 0, month = 0, day = 0, hour = 0, minute = 0, second = 0;
};

/// Whether the Gregorian calendar has the date, from 1900 on.
bool is_valid(const Date& d)
{
    const bool leap = d.year % 4 == 0 && (d.year % 100 != 0 || d.year % 400 == 0);
    const int days[] = {31, leap ? 29 : 28, 31, 30, 31, 30, 31, 31, 30, 31, 30, 31};
    const auto is_in = [](int value, int min, int max) { return value >= min && value <= max; };
    return d.year >= 1900 && is_in(d.month, 1, 12) && is_in(d.day, 1, days[d.month - 1]) && is_in(d.hour, 0, 23) &&
           is_in(d.minute, 0, 59) && is_in(d.second, 0, 59);
}

/// Julian day of `2026-06-21T12:00[:SS]ZONE`. Throws UsageError.
double parse_date(const std::string& text)
{
    Date d;
    int used = 0;
    const bool has_seconds = text.size() > 16 && text[16] == ':';
    const int found = has_seconds ? std::sscanf(text.c_str(), "%4d-%2d-%2dT%2d:%2d:%2d%n", &d.year, &d.month, &d.day,
                                                &d.hour, &d.minute, &d.second, &used)
                                  : std::sscanf(text.c_str(), "%4d-%2d-%2dT%2d:%2d%n", &d.year, &d.month, &d.day,
                                                &d.hour, &d.minute, &used);
    const bool is_read = found == (has_seconds ? 6 : 5) && used > 0;
    const std::optional<int> zone = is_read ? parse_zone(text.substr(std::size_t(used))) : std::nullopt;
    if (!zone || !is_valid(d))
        throw UsageError(fmt::format(
            "expected a date and time from 1900 on, such as 2026-06-21T12:00Z or 2026-06-21T14:00+02:00, found '{}'",
            text));
    return julian_day(d.year, d.month, d.day, d.hour * 3600 + (d.minute - *zone) * 60 + d.second);
}

Vec3d direction_from_angles(double elevation, double azimuth)
{
    return {std::sin(azimuth) * std::cos(elevation), std::sin(elevation), std::cos(azimuth) * std::cos(elevation)};
}

}  // namespace

bool SunOptions::given() const
{
    return direction || elevation_deg || azimuth_deg || place_deg || julian_day;
}

void add_sun_options(Command& command, SunOptions& options)
{
    command.add_value({"--sun-elevation", "DEGREES", "elevation of the sun above the horizon", "40"},
                      [&](const std::string& text) { options.elevation_deg = parse_number(text, -90, 90); });
    command.add_value({"--sun-azimuth", "DEGREES", "azimuth of the sun, from +z toward +x as in --orbit", "-35"},
                      [&](const std::string& text) { options.azimuth_deg = parse_number(text, -1e6, 1e6); });
    command.add_value({"--sun-direction", "X,Y,Z", "direction toward the sun, instead of both angles", ""},
                      [&](const std::string& text) {
                          options.direction = parse_vector(text);
                          if (!(length(*options.direction) > 0)) throw UsageError("expected a direction, found 0,0,0");
                      });
    command.add_value({"--sun-place", "LAT,LON",
                       "place on earth for --sun-date, in degrees north and east; -z is north, +x is east", ""},
                      [&](const std::string& text) {
                          const std::vector<double> n = parse_numbers(text, 2);
                          if (std::abs(n[0]) > 90 || std::abs(n[1]) > 360)
                              throw UsageError("the latitude is from -90 to 90, the longitude from -360 to 360");
                          options.place_deg = {n[0], n[1]};
                      });
    command.add_value({"--sun-date", "DATE",
                       "date and time for --sun-place, such as 2026-06-21T12:00Z or 2026-06-21T14:00+02:00", ""},
                      [&](const std::string& text) { options.julian_day = parse_date(text); });
}

void check_sun(const SunOptions& options)
{
    const bool by_angles = options.elevation_deg || options.azimuth_deg;
    if (options.direction && by_angles)
        throw UsageError("--sun-direction: leave out --sun-elevation and --sun-azimuth");
    if (options.place_deg.has_value() != options.julian_day.has_value())
        throw UsageError("--sun-place, --sun-date: give both, or neither");
    if (options.place_deg && (options.direction || by_angles))
        throw UsageError("--sun-place: leave out --sun-direction, --sun-elevation and --sun-azimuth");
}

Vec3d direction_to_sun(const SunOptions& options)
{
    if (options.direction) return *options.direction;
    if (!options.place_deg || !options.julian_day)
        return direction_from_angles(options.elevation_deg.value_or(40) * radians_per_degree,
                                     options.azimuth_deg.value_or(-35) * radians_per_degree);
    const auto [elevation, azimuth] =
        sun_position(options.place_deg->first, options.place_deg->second, *options.julian_day);
    // sun_position measures from north (-z) towards east (+x), --sun-azimuth from +z toward +x.
    return direction_from_angles(elevation * radians_per_degree, (180 - azimuth) * radians_per_degree);
}

}  // namespace fathom::cli
