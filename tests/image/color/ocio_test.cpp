// SPDX-License-Identifier: Apache-2.0
#include "fathom/ocio.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <fstream>

#include "fathom/error.h"
#include "image/color/tonemap.h"
#include "image/pictures.h"

// Tests of displays of small OpenColorIO configurations with known values.
namespace fathom {
namespace {

using test::TemporaryFolder;

constexpr const char* colors = R"(
  - !<ColorSpace>
    name: plain
    aliases: [INPUT]
  - !<ColorSpace>
    name: squared
    from_scene_reference: !<ExponentTransform> {value: [2, 2, 2, 1]}
  - !<ColorSpace>
    name: turned
    from_scene_reference: !<MatrixTransform> {matrix: [0, 1, 0, 0,  0, 0, 1, 0,  0.5, 0, 0, 0,  0, 0, 0, 1]}
  - !<ColorSpace>
    name: quarter
    to_scene_reference: !<MatrixTransform> {matrix: [4, 0, 0, 0,  0, 4, 0, 0,  0, 0, 4, 0,  0, 0, 0, 1]}
)";

/// A configuration with the reference space `input`, also assigned to the given roles.
std::string configuration(const std::string& input, const std::string& roles = "")
{
    std::string spaces = colors;
    spaces.replace(spaces.find("INPUT"), 5, input);
    return "ocio_profile_version: 2\nroles:\n  scene_linear: plain\n  default: plain\n" + roles +
           R"(file_rules:
  - !<Rule> {name: Default, colorspace: plain}
displays:
  screen:
    - !<View> {name: square, colorspace: squared}
    - !<View> {name: turn, colorspace: turned}
    - !<View> {name: dim, colorspace: plain, looks: half}
    - !<View> {name: as it is, colorspace: plain}
  wall:
    - !<View> {name: turn, colorspace: turned}
looks:
  - !<Look>
    name: half
    process_space: plain
    transform: !<CDLTransform> {slope: [0.5, 0.5, 0.5]}
  - !<Look>
    name: red
    process_space: plain
    transform: !<CDLTransform> {slope: [1, 0, 0], offset: [0, 0.25, 0]}
colorspaces:)" +
           spaces;
}

class Ocio : public ::testing::Test {
protected:
    void SetUp() override
    {
        if (!FATHOM_TESTS_OCIO) GTEST_SKIP() << "this build has no OpenColorIO";
        write(configuration("lin_rec709"));
    }
    void write(const std::string& text) { std::ofstream(choice_.config) << text; }
    std::array<std::uint16_t, 3> codes(const Color& color, double exposure_ev = 0)
    {
        return DisplayMap({exposure_ev, Tonemap::agx, open_ocio(choice_)}).codes16(color);
    }
    void expect_codes(const Color& color, const Color& expected)
    {
        const auto found = codes(color);
        EXPECT_NEAR(found[0] / 65535.0, expected.r, 1e-5);
        EXPECT_NEAR(found[1] / 65535.0, expected.g, 1e-5);
        EXPECT_NEAR(found[2] / 65535.0, expected.b, 1e-5);
    }
    std::string error()
    {
        try {
            open_ocio(choice_);
        } catch (const Error& e) {
            EXPECT_EQ(std::string(e.what()).find('\n'), std::string::npos) << e.what();
            return e.message();
        }
        return "opened";
    }

    TemporaryFolder folder_;
    OcioChoice choice_{(folder_.path() / "config.ocio").string(), "", "", "", ""};
};

TEST_F(Ocio, ViewsAreThoseOfTheConfiguration)
{
    expect_codes({0.5f, 0.25f, 0.75f}, {0.25f, 0.0625f, 0.5625f});
    choice_.view = "turn";
    expect_codes({0.5f, 0.25f, 0.75f}, {0.25f, 0.75f, 0.25f});
    choice_.view = "dim";
    expect_codes({0.5f, 0.25f, 0.75f}, {0.25f, 0.125f, 0.375f});
    choice_.display = "wall";
    choice_.view = "";
    expect_codes({0.5f, 0.25f, 0.75f}, {0.25f, 0.75f, 0.25f});
    EXPECT_EQ(ocio_text(*open_ocio(choice_)),
              choice_.config + ": display 'wall', view 'turn', from linear Rec.709 as 'plain'");
}

TEST_F(Ocio, LooksStandInThePlaceOfTheViews)
{
    choice_.view = "dim";
    choice_.look = "red";
    expect_codes({0.5f, 0.25f, 0.75f}, {0.5f, 0.25f, 0});
    choice_.view = "square";
    choice_.look = "half";
    expect_codes({0.5f, 0.25f, 1}, {0.0625f, 0.015625f, 0.25f});
}

TEST_F(Ocio, ExposureComesFirstAndWhatNoDisplayShowsLast)
{
    EXPECT_EQ(codes({0.25f, 0.125f, 0.5f}, 1)[0], 16384);
    EXPECT_EQ(codes({9, NAN, -1}), (std::array<std::uint16_t, 3>{65535, 0, 0}));
    const DisplayMap map({0, Tonemap::agx, open_ocio(choice_)});
    EXPECT_EQ(map.codes8({0.5f, 1, 0}), (std::array<unsigned char, 3>{64, 255, 0}));
}

TEST_F(Ocio, InputIsFoundOrNamed)
{
    for (const char* const usual : {"Linear Rec.709 (sRGB)", "Utility - Linear - sRGB", "lin_srgb"}) {
        write(configuration(usual));
        expect_codes({0.5f, 0.25f, 0.75f}, {0.25f, 0.0625f, 0.5625f});
    }
    write(configuration("lin_ap1"));
    EXPECT_EQ(
        error(),
        "none of its color spaces is known to be linear Rec.709; choose it with --ocio-input: plain, squared, turned, "
        "quarter");
    choice_.view = "as it is";
    choice_.input = "lin_ap1";
    expect_codes({0.5f, 0.25f, 0.75f}, {0.5f, 0.25f, 0.75f});
    choice_.input = "quarter";
    expect_codes({0.125f, 0.0625f, 0.25f}, {0.5f, 0.25f, 1});
}

/// The input is found by the role of ACES2065-1, through the matrix from Rec.709 that ACES publishes (SMPTE ST 2065-1).
TEST_F(Ocio, InputByTheRoleForInterchange)
{
    write(configuration("ACES2065-1", "  aces_interchange: plain\n"));
    choice_.view = "as it is";
    expect_codes({1, 1, 1}, {1, 1, 1});
    expect_codes({1, 0, 0}, {0.4396330f, 0.0897764f, 0.0175411f});
    expect_codes({0, 1, 0}, {0.3829887f, 0.8134394f, 0.1115465f});
    EXPECT_EQ(ocio_text(*open_ocio(choice_)),
              choice_.config + ": display 'screen', view 'as it is', from linear Rec.709 by way of 'plain'");
}

TEST_F(Ocio, ListsAvailableNamesForUnknownOnes)
{
    choice_.display = "tv";
    EXPECT_EQ(error(), "there is no display 'tv'; there are: screen, wall");
    choice_.display = "wall";
    choice_.view = "square";
    EXPECT_EQ(error(), "there is no view 'square'; there are: turn");
    choice_.view = "";
    choice_.look = "blue";
    EXPECT_EQ(error(), "there is no look 'blue'; there are: half, red");
    choice_.look = "";
    choice_.input = "lin";
    EXPECT_EQ(error(), "there is no color space 'lin'; there are: plain, squared, turned, quarter");
    write("ocio_profile_version: 2\nroles: [");
    EXPECT_EQ(error().rfind("this OpenColorIO configuration can't be used: ", 0), 0u) << error();
    choice_.config = (folder_.path() / "none.ocio").string();
    EXPECT_EQ(error().rfind("this OpenColorIO configuration can't be used: ", 0), 0u) << error();
}

TEST_F(Ocio, OfTheEnvironment)
{
    const std::string config = std::exchange(choice_.config, "");
    unsetenv("OCIO");
    EXPECT_EQ(error(), "this variable is not set: give an OpenColorIO configuration with --ocio CONFIG");
    setenv("OCIO", config.c_str(), 1);
    expect_codes({0.5f, 0.25f, 0.75f}, {0.25f, 0.0625f, 0.5625f});
    unsetenv("OCIO");
}

/// All file formats contain equal codes, and none is tagged as sRGB.
TEST_F(Ocio, PicturesAreMadeByIt)
{
    Image image = test::make_test_image(8, 8);
    for (std::size_t i = 0; i < image.layers[0].pixels.size(); ++i)
        image.layers[0].pixels[i] = i % 3 == 0 ? 0.5f : i % 3 == 1 ? 0.25f : 0.75f;
    WriteOptions options;
    options.display.ocio = open_ocio(choice_);
    options.avif_quality = 100;
    for (const char* const name : {"a.png", "a.webp", "a.avif", "a.jpg"}) {
        write_image(folder_.path() / name, image, options);
        const Image read = read_image(folder_.path() / name);
        const double tolerance = std::string(name) == "a.jpg" ? 0.02 : 0.5 / 255;
        EXPECT_NEAR(read.layers[0].pixels.at(0), 0.25, tolerance) << name;
        EXPECT_NEAR(read.layers[0].pixels.at(1), 0.0625, tolerance) << name;
        EXPECT_NEAR(read.layers[0].pixels.at(2), 0.5625, tolerance) << name;
    }
    const std::vector<char> png = test::bytes_of(folder_.path() / "a.png");
    EXPECT_EQ(std::string(png.begin(), png.end()).find("sRGB"), std::string::npos);
}

TEST(NoOcio, SaysHowToGetIt)
{
    if (FATHOM_TESTS_OCIO) GTEST_SKIP() << "this build has OpenColorIO";
    EXPECT_THROW(open_ocio({}), Error);
}

}  // namespace
}  // namespace fathom
