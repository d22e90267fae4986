// SPDX-License-Identifier: Apache-2.0
#include <avif/avif.h>
#include <gtest/gtest.h>
#include <array>
#include <memory>

#include "fathom/error.h"
#include "image/pictures.h"

// Tests of AVIF files that libavif writes directly, and of our AVIF writer against our PNG writer.
namespace fathom {
namespace {

using Planes = std::unique_ptr<avifImage, decltype(&avifImageDestroy)>;

/// An image whose planes are green, blue and red, or a gray one, with values code(x, y, channel); alpha is channel 3.
template <class Code>
Planes make_planes(int width, int height, int bits, avifPixelFormat format, bool alpha, Code code)
{
    Planes planes(avifImageCreate(std::uint32_t(width), std::uint32_t(height), std::uint32_t(bits), format),
                  avifImageDestroy);
    const bool gray = format == AVIF_PIXEL_FORMAT_YUV400;
    planes->matrixCoefficients = gray ? AVIF_MATRIX_COEFFICIENTS_BT601 : AVIF_MATRIX_COEFFICIENTS_IDENTITY;
    avifImageAllocatePlanes(planes.get(), alpha ? AVIF_PLANES_ALL : AVIF_PLANES_YUV);
    const auto put = [&](std::uint8_t* plane, std::uint32_t row_bytes, int channel) {
        for (int y = 0; y < height; ++y)
            for (int x = 0; x < width; ++x)
                if (bits == 8)
                    plane[y * int(row_bytes) + x] = std::uint8_t(code(x, y, channel));
                else
                    reinterpret_cast<std::uint16_t*>(plane + y * int(row_bytes))[x] =
                        std::uint16_t(code(x, y, channel));
    };
    constexpr int channel_of_plane[] = {1, 2, 0};
    for (int i = 0; i < (gray ? 1 : 3); ++i)
        put(planes->yuvPlanes[i], planes->yuvRowBytes[i], gray ? 0 : channel_of_plane[i]);
    if (alpha) put(planes->alphaPlane, planes->alphaRowBytes, 3);
    return planes;
}

std::vector<unsigned char> file_of(const Planes& planes)
{
    const std::unique_ptr<avifEncoder, decltype(&avifEncoderDestroy)> encoder(avifEncoderCreate(), avifEncoderDestroy);
    encoder->speed = 10;
    encoder->minQuantizer = encoder->maxQuantizer = AVIF_QUANTIZER_LOSSLESS;
    encoder->minQuantizerAlpha = encoder->maxQuantizerAlpha = AVIF_QUANTIZER_LOSSLESS;
    avifRWData data = AVIF_DATA_EMPTY;
    EXPECT_EQ(avifEncoderWrite(encoder.get(), planes.get(), &data), AVIF_RESULT_OK) << encoder->diag.error;
    std::vector<unsigned char> file(data.data, data.data + data.size);
    avifRWDataFree(&data);
    return file;
}

Image read(const std::vector<unsigned char>& file)
{
    return read_image("a.avif", file.data(), file.size());
}

std::string error_of(const std::vector<unsigned char>& file, std::uint64_t memory_limit = 1 << 28)
{
    try {
        read_image("a.avif", file.data(), file.size(), memory_limit);
    } catch (const Error& error) {
        return error.what();
    }
    return "read";
}

TEST(Avif, CodesOfEveryDepthAreKept)
{
    for (const int bits : {8, 10, 12})
        for (const bool alpha : {false, true})
            for (const auto format : {AVIF_PIXEL_FORMAT_YUV444, AVIF_PIXEL_FORMAT_YUV400}) {
                const int width = 23, height = 9, largest = (1 << bits) - 1;
                const auto code = [&](int x, int y, int c) { return (x * 331 + y * 77 + c * 1201) & largest; };
                const Image image = read(file_of(make_planes(width, height, bits, format, alpha, code)));
                const bool gray = format == AVIF_PIXEL_FORMAT_YUV400;
                std::vector<std::string> channels =
                    gray ? std::vector<std::string>{"Y"} : std::vector<std::string>{"R", "G", "B"};
                if (alpha) channels.push_back("A");
                ASSERT_EQ(image.layers[0].channels, channels) << bits;
                ASSERT_EQ(image.width, width);
                ASSERT_EQ(image.height, height);
                EXPECT_FALSE(image.is_linear);
                const float* value = image.layers[0].pixels.data();
                for (int y = 0; y < height; ++y)
                    for (int x = 0; x < width; ++x)
                        for (std::size_t c = 0; c < channels.size(); ++c)
                            ASSERT_EQ(*value++, float(code(x, y, channels[c] == "A" ? 3 : int(c))) / float(largest))
                                << bits << " " << alpha << " " << x << "," << y << " " << c;
            }
}

/// Gray values of a 3 x 2 image with the given crop, rotation and mirroring of the file.
std::vector<int> grays(avifTransformFlags flags, int angle, std::uint8_t mirror, int bits)
{
    const auto code = [](int x, int y, int) { return 1 + x + 3 * y; };
    const Planes planes = make_planes(3, 2, bits, AVIF_PIXEL_FORMAT_YUV444, false, code);
    planes->transformFlags = flags;
    planes->irot.angle = std::uint8_t(angle);
    planes->imir = {mirror};
    // The crop is 2 of 3 columns, centered half a pixel right of the image's center.
    planes->clap = {2, 1, 2, 1, 1, 2, 0, 1};
    const Image image = read(file_of(planes));
    std::vector<int> codes = {image.width};
    for (std::size_t i = 0; i < image.layers[0].pixels.size(); i += 3)
        codes.push_back(int(image.layers[0].pixels[i] * float((1 << bits) - 1) + 0.5f));
    return codes;
}

TEST(Avif, AppliesCropRotationAndMirror)
{
    using Codes = std::vector<int>;
    for (const int bits : {8, 10}) {
        EXPECT_EQ(grays(AVIF_TRANSFORM_NONE, 1, 1, bits), (Codes{3, 1, 2, 3, 4, 5, 6}));
        EXPECT_EQ(grays(AVIF_TRANSFORM_IROT, 0, 0, bits), (Codes{3, 1, 2, 3, 4, 5, 6}));
        EXPECT_EQ(grays(AVIF_TRANSFORM_IROT, 1, 0, bits), (Codes{2, 3, 6, 2, 5, 1, 4}));
        EXPECT_EQ(grays(AVIF_TRANSFORM_IROT, 2, 0, bits), (Codes{3, 6, 5, 4, 3, 2, 1}));
        EXPECT_EQ(grays(AVIF_TRANSFORM_IROT, 3, 0, bits), (Codes{2, 4, 1, 5, 2, 6, 3}));
        EXPECT_EQ(grays(AVIF_TRANSFORM_IMIR, 0, 0, bits), (Codes{3, 4, 5, 6, 1, 2, 3}));
        EXPECT_EQ(grays(AVIF_TRANSFORM_IMIR, 0, 1, bits), (Codes{3, 3, 2, 1, 6, 5, 4}));
        EXPECT_EQ(grays(AVIF_TRANSFORM_IROT | AVIF_TRANSFORM_IMIR, 1, 1, bits), (Codes{2, 6, 3, 5, 2, 4, 1}));
        EXPECT_EQ(grays(AVIF_TRANSFORM_CLAP, 0, 0, bits), (Codes{2, 2, 3, 5, 6}));
        EXPECT_EQ(grays(AVIF_TRANSFORM_CLAP | AVIF_TRANSFORM_IROT, 1, 0, bits), (Codes{2, 3, 6, 2, 5}));
    }
}

TEST(Avif, WhatCanNotBeReadIsOneLineWithItsName)
{
    const auto code = [](int x, int y, int) { return x + y; };
    const Planes planes = make_planes(64, 64, 10, AVIF_PIXEL_FORMAT_YUV444, false, code);
    std::vector<unsigned char> file = file_of(planes);
    EXPECT_EQ(error_of(file, 100'000), "a.avif: an image of 64x64 pixels needs 0.0 GB of memory, 0.0 GB are available");
    EXPECT_EQ(error_of(file), "read");
    file.resize(file.size() - 20);
    EXPECT_EQ(error_of(file).rfind("a.avif: damaged AVIF: ", 0), 0u) << error_of(file);
    for (const auto transfer : {AVIF_TRANSFER_CHARACTERISTICS_SMPTE2084, AVIF_TRANSFER_CHARACTERISTICS_HLG}) {
        planes->transferCharacteristics = avifTransferCharacteristics(transfer);
        EXPECT_EQ(error_of(file_of(planes)),
                  "a.avif: AVIF with high dynamic range (PQ or HLG) is not supported: convert it to OpenEXR");
    }
}

Image written_and_read(const Image& image, const std::string& file, int quality)
{
    const test::TemporaryFolder folder;
    WriteOptions options;
    options.avif_quality = quality;
    write_image(folder.path() / file, image, options);
    return read_image(folder.path() / file);
}

TEST(Avif, IsWrittenLikePngAtTheBestQuality)
{
    for (const bool alpha : {false, true}) {
        std::vector<std::string> channels = {"R", "G", "B"};
        if (alpha) channels.push_back("A");
        const Image image = test::make_test_image(61, 40, channels);
        const Image png = written_and_read(image, "a.png", 100), avif = written_and_read(image, "a.avif", 100);
        EXPECT_EQ(avif.layers[0].channels, png.layers[0].channels);
        EXPECT_EQ(avif.layers[0].pixels, png.layers[0].pixels);
    }
}

/// Largest errors of color and of alpha codes, from 0 to 1.
std::array<double, 2> errors_at(int quality)
{
    Image image = test::make_test_image(64, 48, {"R", "G", "B", "A"});
    std::vector<float>& pixels = image.layers[0].pixels;
    for (int i = 0; i < 64 * 48; ++i) {
        const float alpha = 0.5f + float(i % 7) / 14;
        const float straight[] = {float(i % 64) / 64, float(i / 64) / 48, 0.3f};
        for (int c = 0; c < 4; ++c) pixels[std::size_t(4 * i + c)] = c == 3 ? alpha : straight[c] * alpha;
    }
    const Image png = written_and_read(image, "a.png", 100), avif = written_and_read(image, "a.avif", quality);
    std::array<double, 2> largest{};
    for (std::size_t i = 0; i < pixels.size(); ++i) {
        double& most = largest[i % 4 == 3];
        most = std::max(most, std::abs(double(avif.layers[0].pixels[i]) - png.layers[0].pixels[i]));
    }
    return largest;
}

TEST(Avif, LosesByItsQualityAndNoAlpha)
{
    const auto good = errors_at(95), bad = errors_at(5);
    EXPECT_LT(good[0], 0.05);
    EXPECT_GT(good[0], 0.5 / 255);
    EXPECT_GT(bad[0], 2 * good[0]);
    EXPECT_EQ(good[1], 0);
    EXPECT_EQ(bad[1], 0);
}

}  // namespace
}  // namespace fathom
