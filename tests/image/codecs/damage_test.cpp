// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>
#include <cstring>

#include "fathom/error.h"
#include "image/pictures.h"

// Tests that truncated or corrupted files give an Error or an image of the right size, never anything else.
namespace fathom {
namespace {

struct Sample {
    std::string file;
    WriteOptions options;
    bool layers = false;
};

std::vector<char> encoded(const Sample& sample)
{
    const test::TemporaryFolder folder;
    Image image = test::make_test_image(33, 21, {"R", "G", "B", "A"});
    if (sample.layers) {
        image.layers.push_back(test::make_test_layer("albedo", {"R", "G", "B"}, 33, 21));
        image.uint_channels.push_back({"sums.000", std::vector<std::uint32_t>(33 * 21, 5)});
    }
    write_image(folder.path() / sample.file, image, sample.options);
    return test::bytes_of(folder.path() / sample.file);
}

std::vector<Sample> samples()
{
    WriteOptions wide, half;
    wide.png_bits = 16;
    half.exr_half = true;
    return {{"plain.exr", {}}, {"layers.exr", {}, true}, {"half.exr", half}, {"a.png", {}}, {"wide.png", wide},
            {"a.jpg", {}},     {"a.avif", {}},           {"a.hdr", {}}};
}

TEST(Damage, AFileCutAnywhereIsAnError)
{
    for (const Sample& sample : samples()) {
        const std::vector<char> whole = encoded(sample);
        ASSERT_NO_THROW(read_image(sample.file, whole.data(), whole.size()));
        // Copies of exact size let a sanitizer detect reads beyond the end.
        const std::size_t step = whole.size() < 4000 ? 1 : 7;
        for (std::size_t size = 0; size + 2 < whole.size();
             size += size < 600 || size + 100 > whole.size() ? 1 : step) {
            const std::vector<char> cut(whole.begin(), whole.begin() + std::ptrdiff_t(size));
            EXPECT_THROW(read_image(sample.file, cut.data(), cut.size()), Error) << sample.file << " cut at " << size;
        }
    }
}

TEST(Damage, WrongBytesDoNotCrash)
{
    std::uint32_t state = 1;
    const auto random = [&] { return (state = state * 1664525u + 1013904223u) >> 8; };
    for (const Sample& sample : samples()) {
        const std::vector<char> whole = encoded(sample);
        for (int round = 0; round < 600; ++round) {
            std::vector<char> wrong = whole;
            const std::uint32_t region = round % 2 ? 400 : std::uint32_t(whole.size());
            for (std::uint32_t n = 1 + random() % 4; n > 0; --n)
                wrong[random() % std::min<std::size_t>(region, whole.size())] = char(random());
            try {
                const Image image = read_image(sample.file, wrong.data(), wrong.size());
                for (const Image::Layer& layer : image.layers)
                    EXPECT_EQ(layer.pixels.size(), std::size_t(image.width) * image.height * layer.channels.size());
            } catch (const Error&) {
            }
        }
    }
}

TEST(Damage, SizesBeyondMemoryAreRefused)
{
    // Width and height of a valid file are replaced by 1,000,000; only in HDR, EXR and PNM, because PNG has a checksum
    // over them.
    const std::string pnm = "P6\n16000000 16000000\n255\n";
    EXPECT_THROW(read_image("a.ppm", pnm.data(), pnm.size()), Error);
    const std::string hdr = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 16000000 +X 16000000\n\x02\x02";
    EXPECT_THROW(read_image("a.hdr", hdr.data(), hdr.size()), Error);

    std::vector<char> exr = encoded({"plain.exr", {}});
    const std::string bytes(exr.begin(), exr.end());
    for (const char* window : {"dataWindow", "displayWindow"}) {
        const std::size_t box = bytes.find(window) + std::string(window).size() + 1 + 6 + 4;
        const std::int32_t far = 2000000000;
        std::memcpy(exr.data() + box + 8, &far, 4);
        std::memcpy(exr.data() + box + 12, &far, 4);
    }
    try {
        read_image("a.exr", exr.data(), exr.size());
        FAIL();
    } catch (const Error& error) {
        EXPECT_NE(error.message().find("2000000001x2000000001"), std::string::npos) << error.message();
    }
}

}  // namespace
}  // namespace fathom
