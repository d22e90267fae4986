// SPDX-License-Identifier: Apache-2.0
/// How closures choose among their lobes: the noise that it leaves in each channel.
#include "materials/closure_checks.h"
#include "materials/closures/disney.h"
#include "materials/closures/layered.h"
#include "materials/closures/plastic.h"
#include "materials/closures/principled.h"
#include "materials/lobes/channel_weights.h"
#include "materials/lobes/lobe_choice.h"

namespace fathom::test {
namespace {

Spectrum spectrum(float r, float g, float b)
{
    Spectrum s;
    s.c[0] = Float(r), s.c[1] = Float(g), s.c[2] = Float(b);
    return s;
}

float at(const Float& value)
{
    return first(value);
}

/// Three lobes of probabilities 1/4, 1/2 and 1/4: each gets its interval, stretched to [0, 1).
TEST(LobeChoice, StretchesTheIntervalOfEachLobe)
{
    for (const auto& [u, lobe, stretched] : {std::tuple{0.0f, 0, 0.0f},
                                             {0.125f, 0, 0.5f},
                                             {0.25f, 1, 0.0f},
                                             {0.5f, 1, 0.5f},
                                             {0.75f, 2, 0.0f},
                                             {0.875f, 2, 0.5f}}) {
        LobeChoice choice{Float(u)};
        const Mask first_lobe = choice.take(Float(0.25f)), second_lobe = choice.take(Float(0.5f));
        choice.take_rest(Float(0.25f));
        EXPECT_EQ(any(first_lobe), lobe == 0) << u;
        EXPECT_EQ(any(second_lobe), lobe == 1) << u;
        EXPECT_FLOAT_EQ(at(choice.stretched()), stretched) << u;
    }
}

/// Rounding leaves the last lobe an interval that is a little too short.
TEST(LobeChoice, StaysBelowOne)
{
    LobeChoice choice{Float(1 - 0x1p-24f)};
    choice.take(Float(0.5f));
    choice.take_rest(Float(0.4999999f));
    EXPECT_LT(at(choice.stretched()), 1.0f);
    EXPECT_GT(at(choice.stretched()), 0.999f);
}

TEST(ChannelWeights, LeaveGrayLobesAsTheyAre)
{
    for (const float gray : {0.0f, 0.1f, 1.0f})
        for (const ChannelWeights& weights : {ChannelWeights(spectrum(0.7f, 0.1f, 0)), ChannelWeights()})
            EXPECT_NEAR(first(weights.norm(spectrum(gray, gray, gray))), gray, 1e-5);
}

/// The mean albedo is 0.9/3 + 0.04, so the weights are in the ratio of 1 / (0.94^2 + 0.34^2) and
/// 1 / (0.04^2 + 0.34^2).
TEST(ChannelWeights, AreRelativeToTheBrightnessOfChannels)
{
    const ChannelWeights weights(spectrum(0.9f, 0, 0));
    const double floor = 0.34 * 0.34, red = 1 / (0.94 * 0.94 + floor), green = 1 / (0.04 * 0.04 + floor);
    EXPECT_NEAR(first(weights.norm(spectrum(0.9f, 0, 0))), 0.9 * std::sqrt(red / (red + 2 * green)), 1e-5);
    EXPECT_NEAR(first(weights.norm(spectrum(0, 0.5f, 0))), 0.5 * std::sqrt(green / (red + 2 * green)), 1e-5);
}

/// Second moment of a sample's weight in a channel, relative to the squared mean.
template <class Bsdf>
double relative_second_moment(const Bsdf& bsdf, int channel)
{
    Random random(3);
    double sum = 0, squares = 0;
    int count = 0;
    for (; count < 40000; count += lanes) {
        float weight[lanes];
        store(weight, bsdf.sample(outgoing(20), random.next2(), random.next()).weight.c[channel]);
        for (const float w : weight) sum += double(w), squares += double(w) * double(w);
    }
    return squares * count / (sum * sum);
}

/// Red paint reflects green and blue at its boundary alone. If lobes were chosen by their largest channel, one in ten
/// samples would bring all green and blue light, and the moment would be 10.
template <class Bsdf, class Point>
void expect_little_noise(Point point, const char* what)
{
    point.base_color = spectrum(0.7f, 0.0f, 0.0f);
    const Bsdf bsdf(point);
    EXPECT_LT(relative_second_moment(bsdf, 0), 1.8) << what;
    EXPECT_LT(relative_second_moment(bsdf, 1), 6.5) << what;
}

TEST(LobeSelection, DarkChannelsOfColoredSurfacesHaveLittleNoise)
{
    expect_little_noise<PrincipledBsdf, PrincipledPoint>(material(0, 0.3f), "principled");
    expect_little_noise<PlasticBsdf, PlasticPoint>(material(0, 0.3f), "plastic");
    expect_little_noise<LayeredBsdf<false>, LayeredMaterialPoint>(material(0, 0.3f), "layered");
    expect_little_noise<LayeredBsdf<true>, LayeredMaterialPoint>(material(0, 0.3f), "layered, transmitting");
    expect_little_noise<DisneyBsdf<false>, DisneyMaterialPoint>(material(0, 0.3f), "disney");
}

}  // namespace
}  // namespace fathom::test
