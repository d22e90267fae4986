// SPDX-License-Identifier: Apache-2.0
#include "fathom/denoise.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "fathom/error.h"

namespace fathom {
namespace {

namespace fs = std::filesystem;

Image::Layer made_layer(const std::string& name, const std::vector<std::string>& channels, int pixels, unsigned seed)
{
    Image::Layer layer{name, channels, {}};
    for (std::size_t i = 0; i < std::size_t(pixels) * channels.size(); ++i) {
        seed = seed * 1664525u + 1013904223u;
        layer.pixels.push_back(float(seed >> 8) * 0x1p-24f);
    }
    return layer;
}

Image make_test_image(int width, int height, const std::vector<std::string>& channels = {"R", "G", "B"})
{
    Image image;
    image.width = width, image.height = height;
    image.layers.push_back(made_layer("", channels, width * height, 1));
    return image;
}

/// Result of the fake denoiser, computed from its specification.
float expected(const Image& image, int x, int y, int c, bool aids)
{
    const Image::Layer& shown = image.layers[0];
    const auto at = [&](int column) {
        return shown.pixels[std::size_t(y * image.width + column) * shown.channels.size() + std::size_t(c)];
    };
    float value = (at(x) + at(std::max(x - 1, 0)) + at(std::min(x + 1, image.width - 1))) / 3;
    const auto aid = [&](const char* name) {
        return image.find(name)->pixels[std::size_t(3 * (y * image.width + x) + c)] + 0.5f;
    };
    if (aids) value += 10 * aid("albedo") + 1000 * aid("normal");
    return value;
}

class FakeLibrary : public testing::Test {
protected:
    FakeLibrary() { setenv("FATHOM_OIDN", FAKE_OIDN, 1); }
    ~FakeLibrary() override { unsetenv("FATHOM_OIDN"), unsetenv("FATHOM_FAKE_OIDN_MAJOR"); }
    static std::string message_of(int threads = 1)
    {
        try {
            const Denoiser denoiser(threads);
        } catch (const Error& error) {
            return error.what();
        }
        return "";
    }
};

TEST_F(FakeLibrary, GetsRadianceAndItsAidsDenoisedFirst)
{
    const Denoiser denoiser(1);
    EXPECT_EQ(denoiser.version(), "2.98.76");
    EXPECT_EQ(denoiser.file(), FAKE_OIDN);
    for (const bool aids : {false, true})
        for (const bool alpha : {false, true}) {
            Image image = make_test_image(
                7, 5, alpha ? std::vector<std::string>{"R", "G", "B", "A"} : std::vector<std::string>{"R", "G", "B"});
            if (aids) {
                image.layers.push_back(made_layer("normal", {"X", "Y", "Z"}, 35, 2));
                image.layers.push_back(made_layer("albedo", {"R", "G", "B"}, 35, 3));
            }
            const Image::Layer denoised = denoiser.denoise(image);
            EXPECT_EQ(denoised.name, "denoised");
            EXPECT_EQ(denoised.channels, (std::vector<std::string>{"R", "G", "B"}));
            for (int y = 0; y < 5; ++y)
                for (int x = 0; x < 7; ++x)
                    for (int c = 0; c < 3; ++c)
                        ASSERT_NEAR(denoised.pixels[std::size_t(3 * (y * 7 + x) + c)], expected(image, x, y, c, aids),
                                    aids ? 1e-3 : 1e-6)
                            << x << " " << y << " " << c << " " << aids << alpha;
        }
}

TEST_F(FakeLibrary, QuicklyWithAidsAsTheyAre)
{
    const Denoiser denoiser(1);
    Image image = make_test_image(7, 5);
    for (const char* name : {"albedo", "normal"}) image.layers.push_back(made_layer(name, {"R", "G", "B"}, 35, 2));
    std::atomic<bool> cancel = false;
    const std::optional<Image::Layer> quick = denoiser.denoise_quickly(image, cancel);
    ASSERT_TRUE(quick);
    for (int x = 0; x < 7; ++x) {
        const auto aid = [&](const char* name) { return image.find(name)->pixels[std::size_t(3 * (2 * 7 + x) + 1)]; };
        const float value = expected(image, x, 2, 1, false) + 5 * aid("albedo") + 500 * aid("normal");
        EXPECT_NEAR(quick->pixels[std::size_t(3 * (2 * 7 + x) + 1)], value, 1e-3) << x;
    }
    cancel = true;
    EXPECT_FALSE(denoiser.denoise_quickly(image, cancel));
    cancel = false;
    EXPECT_TRUE(denoiser.denoise_quickly(image, cancel));
}

TEST_F(FakeLibrary, FailuresAreErrors)
{
    const Denoiser denoiser(0);
    try {
        denoiser.denoise(make_test_image(13, 2));
        FAIL();
    } catch (const Error& error) {
        EXPECT_EQ(error.message(), "13 is unlucky");
        EXPECT_EQ(error.file(), FAKE_OIDN);
    }
    EXPECT_NO_THROW(denoiser.denoise(make_test_image(12, 2)));
    EXPECT_THROW(denoiser.denoise(make_test_image(4, 2, {"Z"})), Error);
    EXPECT_THROW(denoiser.denoise({}), Error);
}

TEST_F(FakeLibrary, IsFoundByItsFolder)
{
    const fs::path folder = fs::temp_directory_path() / ("fathom-oidn-" + std::to_string(getpid()));
    fs::remove_all(folder);
    for (const char* inside : {".", "lib"}) {
        fs::create_directories(folder / inside);
        const fs::path file = folder / inside / "libOpenImageDenoise.so.2";
        fs::copy_file(FAKE_OIDN, file);
        setenv("FATHOM_OIDN", folder.c_str(), 1);
        EXPECT_TRUE(fs::equivalent(Denoiser(1).file(), file));
        fs::remove(file);
    }
    // Location of a pip installation: below the prefix whose bin folder is in PATH.
    unsetenv("FATHOM_OIDN");
    const fs::path package = folder / "lib/python3.11/site-packages/pyoidn/oidn/lib";
    fs::create_directories(package);
    fs::copy_file(FAKE_OIDN, package / "libOpenImageDenoise.so.2");
    const char* const paths = std::getenv("PATH");
    const std::string path = paths ? paths : "";
    setenv("PATH", ((folder / "bin").string() + ":" + path).c_str(), 1);
    const fs::path found = Denoiser(1).file();
    setenv("PATH", path.c_str(), 1);
    if (found.string().find("pyoidn") != std::string::npos)  // this library, installed on the system, takes precedence
        EXPECT_TRUE(fs::equivalent(found, package / "libOpenImageDenoise.so.2"));
    fs::remove_all(folder);
}

TEST_F(FakeLibrary, WhatIsNoneIsRefused)
{
    setenv("FATHOM_FAKE_OIDN_MAJOR", "3", 1);
    EXPECT_NE(message_of().find("this is Open Image Denoise 3.98.76; version 2 is required"), std::string::npos);
    unsetenv("FATHOM_FAKE_OIDN_MAJOR");
    setenv("FATHOM_OIDN", "/nowhere/at/all.so", 1);
    EXPECT_EQ(message_of(), "/nowhere/at/all.so: FATHOM_OIDN: there is no such library");
    const fs::path text = fs::temp_directory_path() / "fathom-oidn-text.so";
    std::ofstream(text) << "no library";
    setenv("FATHOM_OIDN", text.c_str(), 1);
    EXPECT_NE(message_of().find("can't be opened"), std::string::npos);
    fs::remove(text);
    // libm is an existing shared library that is not Open Image Denoise.
    setenv("FATHOM_OIDN", "/lib/x86_64-linux-gnu/libm.so.6", 1);
    if (fs::exists(std::getenv("FATHOM_OIDN")))
        EXPECT_NE(message_of().find("oidnNewDevice: no such function"), std::string::npos);
}

/// Tests of the real library, skipped if it is not installed.
class RealLibrary : public testing::Test {
protected:
    void SetUp() override
    {
        try {
            const Denoiser denoiser(1);
        } catch (const Error& error) {
            GTEST_SKIP() << error.what();
        }
    }
};

/// A smooth image with added noise gets closer to the original; the bits don't depend on the number of threads.
TEST_F(RealLibrary, TakesNoiseAwayWithTheSameBitsForAnyThreads)
{
    const int width = 200, height = 150;
    Image image = make_test_image(width, height);
    std::vector<float> truth(image.layers[0].pixels.size());
    for (std::size_t i = 0; i < truth.size(); ++i) {
        const int pixel = int(i / 3);
        truth[i] = 0.2f + 0.5f * float(pixel % width) / float(width) + (pixel / width > 75 ? 0.3f : 0);
        image.layers[0].pixels[i] = truth[i] * 2 * image.layers[0].pixels[i];
    }
    const auto error = [&](const std::vector<float>& pixels) {
        double sum = 0;
        for (std::size_t i = 0; i < truth.size(); ++i) sum += std::pow(double(pixels[i]) - double(truth[i]), 2);
        return sum;
    };
    const Image::Layer one = Denoiser(1).denoise(image), two = Denoiser(2).denoise(image);
    EXPECT_EQ(one.pixels, two.pixels);
    EXPECT_LT(error(one.pixels), error(image.layers[0].pixels) / 20);
}

}  // namespace
}  // namespace fathom
