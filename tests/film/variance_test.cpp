// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "made_film.h"

namespace fathom {
namespace {

/// If samples alternate between v and 3 v, the variance of their mean is v^2 / (n - 1) for any v.
TEST(Film, VarianceIsRightForDarkAndBrightPictures)
{
    for (double v : {1e-6, 1e-5, 1e-3, 1.0, 30.0, 60.0, 1e3, 1e6, 3e7, 1e8, 1e9}) {
        RenderSettings settings;
        settings.width = settings.height = 1;
        Film film = test::make_test_film(settings);
        constexpr int n = 200;
        film.data().add_range({0, n});
        TileSums sums;
        sums.reset(1, other_words);
        for (int i = 0; i < n; ++i) sums.add(0, std::uint32_t(i), float(i % 2 ? 3 * v : v), float(v), 0);
        std::uint32_t* pixel = film.data().pixel(0);
        sums.add_to(0, pixel, 0, -1);
        for (const TileSums::Slow& slow : sums.slow())
            for (int c = 0; c < 3; ++c) {
                ExactSum::add_number(radiance_sum(pixel, c), slow.value[c]);
                ExactSquareSum::add_number(square_sum(pixel, c), double(slow.value[c]) * slow.value[c]);
            }
        const Image image = film.image(false, true);
        const auto& variance = image.find("variance")->pixels;
        EXPECT_NEAR(image.layers[0].pixels[0] / (2 * v), 1, 2e-5) << v;
        EXPECT_NEAR(variance[0] * (n - 1) / (v * v), 1, 1e-3) << v;
        EXPECT_LT(variance[1] * (n - 1) / (v * v), 1e-4)
            << v;  // samples of equal value have no variance, except by rounding
        EXPECT_EQ(variance[2], 0) << v;
    }
}

}  // namespace
}  // namespace fathom
