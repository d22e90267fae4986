// SPDX-License-Identifier: Apache-2.0
#include "formats/json/json_text.h"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <numbers>
#include <random>

namespace fathom {
namespace {

double read(const Json& json)
{
    return parse_json("text", json_text(json), DuplicateKeys::error).get<double>();
}

TEST(JsonText, NumbersAreShort)
{
    EXPECT_EQ(json_text(number_json(0.8f)), "0.8\n");
    EXPECT_EQ(json_text(number_json(1.0)), "1\n");
    EXPECT_EQ(json_text(number_json(-0.0)), "-0.0\n");
    EXPECT_EQ(json_text(number_json(1e30f)), "1e+30\n");
    EXPECT_EQ(json_text(number_json(40 * (std::numbers::pi / 180), std::numbers::pi / 180)), "40\n");
}

TEST(JsonText, FloatsComeBackWithTheirBits)
{
    std::mt19937 random(1);
    for (int i = 0; i < 20000; ++i) {
        const float value = std::bit_cast<float>(std::uint32_t(random()));
        if (!std::isfinite(value)) continue;
        ASSERT_EQ(std::bit_cast<std::uint32_t>(float(read(number_json(value)))), std::bit_cast<std::uint32_t>(value))
            << value;
    }
}

TEST(JsonText, DoublesComeBackWithTheirBits)
{
    std::mt19937_64 random(2);
    for (int i = 0; i < 20000; ++i) {
        const double value = std::bit_cast<double>(std::uint64_t(random()));
        if (!std::isfinite(value)) continue;
        ASSERT_EQ(std::bit_cast<std::uint64_t>(read(number_json(value))), std::bit_cast<std::uint64_t>(value)) << value;
    }
}

/// Angles are printed in degrees: those that came from degrees are restored exactly, others within one unit in the last
/// place.
TEST(JsonText, AnglesComeBack)
{
    constexpr double unit = std::numbers::pi / 180;
    std::mt19937_64 random(3);
    for (int i = 0; i < 20000; ++i) {
        const double degrees = double(random() >> 11) * 0x1p-53 * 180, radians = degrees * unit;
        ASSERT_EQ(read(number_json(radians, unit)) * unit, radians);
        const double any = std::nextafter(radians, 4);
        ASSERT_NEAR(read(number_json(any, unit)) * unit, any, 4.5e-16 * any);
        const float single = float(radians);
        ASSERT_EQ(float(read(number_json(single, unit)) * unit), single);
    }
}

TEST(JsonText, LinesAreAsLongAsPeopleRead)
{
    Json json = {{"a", Json::array()}, {"short", {1, 2, 3}}};
    for (int i = 0; i < 40; ++i) json["a"].push_back(Json{{"number", i}, {"same", i}});
    std::string line;
    std::istringstream lines(json_text(json));
    for (int i = 0; std::getline(lines, line); ++i) EXPECT_LE(line.size(), 124u) << i;
    EXPECT_NE(json_text(json).find("\n  \"short\": [1, 2, 3]\n"), std::string::npos);
    EXPECT_EQ(parse_json("text", json_text(json), DuplicateKeys::error), json);
}

/// Each level is formatted once: trying a single line at every level would take exponential time.
TEST(JsonText, DeepThingsTakeNoTime)
{
    Json json = std::string(200, 'x');
    for (int i = 0; i < 300; ++i) json = Json{{"children", Json::array({std::move(json)})}};
    EXPECT_EQ(parse_json("text", json_text(json), DuplicateKeys::error), json);
}

}  // namespace
}  // namespace fathom
