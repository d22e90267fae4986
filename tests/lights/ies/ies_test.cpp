// SPDX-License-Identifier: Apache-2.0
#include "lights/ies/ies.h"

#include <gtest/gtest.h>

#include <fstream>

#include "image/pictures.h"
#include "support/error_message.h"

namespace fathom {
namespace {

/// An IES file with a header and these numbers, from the number of lamps onward.
std::string file_of(const std::string& numbers, const std::string& head = "IESNA:LM-63-2002\n[TEST] x\nTILT=NONE\n")
{
    return head + numbers;
}

std::string error_of(const std::string& text)
{
    return test::error_in_file("a.ies", [&] { parse_ies("a.ies", text); });
}

/// Numbers may be split over lines anywhere; candela values are scaled by the file's factors.
TEST(Ies, CandelaByAngles)
{
    const IesProfile p = parse_ies(
        "a.ies", file_of("1 1000 2.5\n3 2 1 2 0 0 0\n 0.5 1 60\r\n0 45\n90\n0 180 10 20 30\n40, 50 6.0e+1\n"));
    EXPECT_EQ(p.polar_deg, (std::vector<double>{0, 45, 90}));
    EXPECT_EQ(p.azimuth_deg, (std::vector<double>{0, 180}));
    EXPECT_EQ(p.candela, (std::vector<double>{12.5, 25, 37.5, 50, 62.5, 75}));
    EXPECT_DOUBLE_EQ(p.at(0, 0), 12.5);
    EXPECT_DOUBLE_EQ(p.at(45, 180), 62.5);
    EXPECT_DOUBLE_EQ(p.at(22.5, 0), 18.75);
    EXPECT_DOUBLE_EQ(p.at(90, 90), 56.25);
    EXPECT_EQ(p.at(90.001, 0), 0);
}

/// Missing horizontal angles are restored by symmetry: rotational, quarter, half about either plane, and the last step
/// to 360 degrees.
TEST(Ies, Symmetry)
{
    const auto at = [](const std::string& azimuths, const std::string& values, double azimuth) {
        const auto count = std::to_string(std::count(azimuths.begin(), azimuths.end(), ' ') + 1);
        return parse_ies("a.ies", file_of("1 1 1 2 " + count + " 1 1 0 0 0 1 1 1  0 90 " + azimuths + " " + values))
            .at(0, azimuth);
    };
    for (const double azimuth : {0.0, 77.0, 181.0, 359.0}) EXPECT_EQ(at("0", "7 8", azimuth), 7);
    for (const double azimuth : {30.0, 150.0, 210.0, 330.0, -30.0, 390.0})
        EXPECT_NEAR(at("0 30 90", "1 0 2 0 3 0", azimuth), 2, 1e-12) << azimuth;
    for (const double azimuth : {30.0, 330.0}) EXPECT_NEAR(at("0 30 180", "1 0 2 0 3 0", azimuth), 2, 1e-12) << azimuth;
    EXPECT_NEAR(at("0 30 180", "1 0 2 0 3 0", 255), 2.5, 1e-12);
    for (const double azimuth : {120.0, 60.0}) EXPECT_NEAR(at("90 120 270", "1 0 2 0 3 0", azimuth), 2, 1e-12);
    for (const double azimuth : {270.0}) EXPECT_NEAR(at("90 120 270", "1 0 2 0 3 0", azimuth), 3, 1e-12);
    EXPECT_NEAR(at("90 120 270", "1 0 2 0 3 0", 300), at("90 120 270", "1 0 2 0 3 0", 240), 1e-12);
    EXPECT_NEAR(at("0 90 180 270 360", "1 0 2 0 3 0 4 0 1 0", 270), 4, 1e-12);
    EXPECT_NEAR(at("0 90 180 270 360", "1 0 2 0 3 0 4 0 1 0", 315), 2.5, 1e-12);
    EXPECT_NEAR(at("0 90 180 270", "1 0 2 0 3 0 4 0", 315), 2.5, 1e-12);
}

TEST(Ies, HeadsOfAllYears)
{
    const std::string numbers = "1 1 2 2 1 1 1 0 0 0  3 5 60  0 90  0  1 1\n";
    const auto factor = [&](const std::string& head) { return parse_ies("a", file_of(numbers, head)).candela[0]; };
    // Before 1995 the second factor is a photometric factor; later it describes how the file was made.
    EXPECT_EQ(factor("a lamp of 1986\nTILT=NONE\n"), 30);
    EXPECT_EQ(factor("IESNA91\n[TEST] x\nTILT=NONE\r\n"), 30);
    EXPECT_EQ(factor("\xef\xbb\xbfIESNA:LM-63-1995\nTILT=NONE\n"), 6);
    EXPECT_EQ(factor("IES:LM-63-2019\nTILT=lamp.tlt\n"), 6);
    EXPECT_EQ(factor("IESNA:LM-63-2002\nTILT=INCLUDE\n1\n3\n0 45 90\n1 0.9 0.8\n"), 6);
}

TEST(Ies, DamageIsNamed)
{
    EXPECT_EQ(error_of(""), "IES: no line begins with TILT=: it is not a photometric file");
    EXPECT_EQ(error_of("IESNA:LM-63-2002\n1 2 3\n"), "IES: no line begins with TILT=: it is not a photometric file");
    EXPECT_EQ(error_of(file_of("")), "IES: it ends where its number of lamps should be");
    EXPECT_EQ(error_of(file_of("1 1 1 2 1 1 1 0 0 0 1 1 1 0 90 0 5")),
              "IES: it ends where its candela value should be");
    EXPECT_EQ(error_of(file_of("1 1 1 2 1 1 1 0 0 0 1 1 1 0 90 0 5 -3")), "IES: the candela value 2 of 2 is negative");
    EXPECT_EQ(error_of(file_of("1 1 1e300 2 1 1 1 0 0 0 1 1 1 0 90 0 5 3e20")),
              "IES: the candela value 1 of 2 is 5e+300, which is too large");
    EXPECT_EQ(error_of(file_of("1 1 -1 2 1 1 1 0 0 0 1 1 1 0 90 0 5 3")),
              "IES: its candela multiplier is -1; it must be above 0");
    EXPECT_EQ(error_of(file_of("1 1 1 -2 1 1 1 0 0 0 1 1 1 0 90 0 5 3")),
              "IES: its number of vertical angles is -2; it must be a whole number above 0");
    EXPECT_EQ(error_of(file_of("1 1 1 2.5 1 1 1 0 0 0 1 1 1 0 90 0 5 3")),
              "IES: its number of vertical angles is 2.5; it must be a whole number above 0");
    EXPECT_EQ(error_of(file_of("1 1 1 900000000 900000000 1 1 0 0 0 1 1 1 0 90 0 5 3")),
              "IES: its header says 900000000 by 900000000 values, but it ends after 88 bytes");
    EXPECT_EQ(error_of(file_of("1 1 1 1 1 1 1 0 0 0 1 1 1 0 0 5")), "IES: it has fewer than two vertical angles");
    EXPECT_EQ(error_of(file_of("1 1 1 2 1 2 1 0 0 0 1 1 1 0 90 0 5 3")),
              "IES: is of type B photometry; only type C is read");
    EXPECT_EQ(error_of(file_of("1 1 1 2 1 1 1 0 0 0 1 1 1 90 0 0 5 3")),
              "IES: the vertical angle 0 follows 90: they must increase");
    EXPECT_EQ(error_of(file_of("1 1 1 2 1 1 1 0 0 0 1 1 1 0 190 0 5 3")),
              "IES: the vertical angle 190 is not within 0 and 180 degrees");
    EXPECT_EQ(error_of(file_of("1 1 1 2 1 1 1 0 0 0 1 1 1 0 nan 0 5 3")), "IES: its vertical angles is not a number");
    EXPECT_EQ(error_of(file_of("1 1 1 2 1 1 1 0 0 0 1 1 x 0 90 0 5 3")), "IES: its input watts is not a number");
}

TEST(Ies, Files)
{
    EXPECT_TRUE(is_ies_name("a/b.IES"));
    EXPECT_TRUE(is_ies_name("lamp.ies"));
    EXPECT_FALSE(is_ies_name("ies"));
    EXPECT_FALSE(is_ies_name("lamp.ies.png"));
    const test::TemporaryFolder folder;
    EXPECT_THROW(read_ies(folder.path() / "missing.ies"), Error);
    EXPECT_THROW(read_ies(folder.path()), Error);
    std::ofstream(folder.path() / "a.ies") << file_of("1 1 1 2 1 1 1 0 0 0 1 1 1 0 90 0 5 3");
    EXPECT_EQ(read_ies(folder.path() / "a.ies").candela, (std::vector<double>{5, 3}));
}

}  // namespace
}  // namespace fathom
