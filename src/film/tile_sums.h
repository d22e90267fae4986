#pragma once
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <vector>

namespace fathom {

/// Exact sums of floats: 128-bit fixed point, so that neither order nor grouping changes them.
///
/// A value is first rounded to a multiple of 2^-36 (half to even): 1.5e-11, far below the noise of any picture whose values
/// matter. Values up to 2^60 are summed exactly; larger ones are cut there.
struct ExactSum {
    static constexpr int fraction_bits = 36;
    std::uint64_t low = 0;
    std::int64_t high = 0;

    void add(std::int64_t value)
    {
        const std::uint64_t before = low;
        low += std::uint64_t(value);
        high += (value >> 63) + (low < before ? 1 : 0);
    }
    void add(const ExactSum& other)
    {
        const std::uint64_t before = low;
        low += other.low;
        high += other.high + (low < before ? 1 : 0);
    }
    /// Any finite double, slowly.
    void add_any(double value)
    {
        const double cut = std::fmin(std::fmax(value, -0x1p60), 0x1p60);
        const double scaled = std::nearbyint(std::ldexp(cut, fraction_bits));
        const double upper = std::floor(std::ldexp(scaled, -52));
        const double lower = scaled - std::ldexp(upper, 52);  // exact: in [0, 2^52)
        ExactSum sum;
        const auto u = std::int64_t(upper);
        sum.low = (std::uint64_t(u) << 52) + std::uint64_t(lower);
        sum.high = (u >> 12) + (sum.low < (std::uint64_t(u) << 52) ? 1 : 0);
        add(sum);
    }
    double value() const
    {
        return std::ldexp(double(high), 64 - fraction_bits) + std::ldexp(double(low), -fraction_bits);
    }
    friend bool operator==(const ExactSum&, const ExactSum&) = default;
};

/// Sums over the samples of one job, per pixel: `width` values and their squares.
///
/// Fast while values stay below 128, which pictures mostly do; the others take the slow way into the same sums.
class TileSums {
public:
    static constexpr double magic = 0x1.8p52 / (std::uint64_t(1) << ExactSum::fraction_bits);

    void reset(std::size_t pixels)
    {
        fast_.assign(pixels, {});
        slow_.clear();
        dropped = 0;
    }

    /// Adds one sample's radiance and its square. NaN and infinity are dropped and counted.
    void add(std::uint32_t pixel, float r, float g, float b)
    {
        const double v[4] = {r, g, b, 0};
        if (std::fabs(v[0]) < 128 && std::fabs(v[1]) < 128 && std::fabs(v[2]) < 128) [[likely]] {
            // Adding 1.5 * 2^52 units leaves the value, rounded to units, in the low bits of the double.
            Fast& sums = fast_[pixel];
            for (int i = 0; i < 4; ++i) {
                sums.sum[i] += std::bit_cast<std::int64_t>(v[i] + magic) - std::bit_cast<std::int64_t>(magic);
                sums.square[i] += std::bit_cast<std::int64_t>(v[i] * v[i] + magic) - std::bit_cast<std::int64_t>(magic);
            }
            return;
        }
        add_slow(pixel, r, g, b);
    }

    struct Fast {
        std::int64_t sum[4] = {}, square[4] = {};
    };
    struct Slow {
        std::uint32_t pixel;
        float value[3];
    };
    const std::vector<Fast>& fast() const { return fast_; }
    const std::vector<Slow>& slow() const { return slow_; }
    std::uint64_t dropped = 0;

private:
    void add_slow(std::uint32_t pixel, float r, float g, float b)
    {
        if (std::isfinite(r) && std::isfinite(g) && std::isfinite(b))
            slow_.push_back({pixel, {r, g, b}});
        else
            ++dropped;
    }

    std::vector<Fast> fast_;
    std::vector<Slow> slow_;
};

}  // namespace fathom
