#pragma once
#include <bit>
#include <cmath>
#include <cstdint>
#include <vector>

#include "film/exact_sum.h"

namespace fathom {

/// The words of a film's pixel: sums of radiance, of its squares, then of all else, in the order of FilmLayout.
inline constexpr int square_words = 3 * ExactSum::words, other_words = square_words + 3 * ExactSquareSum::words;
template <class Word>
Word* radiance_sum(Word* pixel, int channel)
{
    return pixel + channel * ExactSum::words;
}
template <class Word>
Word* square_sum(Word* pixel, int channel)
{
    return pixel + square_words + channel * ExactSquareSum::words;
}
template <class Word>
Word* other_sum(Word* pixel, int place)
{
    return pixel + other_words + place * ExactSum::words;
}

/// Which of the other sums of a pixel are whose; -1: not wanted. See FilmLayout.
struct AovPlaces {
    int alpha = -1, albedo = -1, normal = -1, depth = -1, position = -1, hits = -1, ids = -1;
    bool any() const { return alpha >= 0 || albedo >= 0 || normal >= 0 || depth >= 0 || position >= 0 || ids >= 0; }
};

/// Sums over the samples of one job, pixel by pixel: radiance, its square, and what the first hits show.
///
/// Fast while radiance stays below 128, which it mostly does; larger values are kept apart and summed one by one.
class TileSums {
public:
    /// Four at a time, by the vector types of GCC and Clang, which every instruction set has.
    using Doubles = double __attribute__((vector_size(32)));
    using Integers = std::int64_t __attribute__((vector_size(32)));
    // GCC aligns such vectors by the instruction set that it compiles for: the library and its kernels must agree.
    /// Squares in two parts: multiples of 2^-20, and what is left of each, which may be negative, in its own units.
    struct alignas(32) Fast {
        Integers sum{}, square{}, square_rest{};
    };

    /// Adding 1.5 * 2^52 units leaves a value, rounded to units, in the low bits of the double.
    static constexpr double magic(int fraction_bits) { return 0x1.8p52 / double(std::uint64_t(1) << fraction_bits); }
    static constexpr int square_bits = 20;

    /// words  of a pixel in the film
    void reset(std::size_t pixels, std::size_t words)
    {
        fast_.assign(pixels, {});
        slow_.clear();
        words_per_pixel_ = words;
        first_hits_.clear();
        dropped = 0;
    }

    /// Brings a pixel's sums into the cache.
    void fetch(std::uint32_t pixel) const
    {
        const char* const sums = reinterpret_cast<const char*>(&fast_[pixel]);
        __builtin_prefetch(sums), __builtin_prefetch(sums + sizeof(Fast) - 1);
    }

    /// Adds one sample's radiance and its square. NaN and infinity are dropped and counted.
    void add(std::uint32_t pixel, std::uint32_t sample, float r, float g, float b)
    {
        if (std::fabs(r) < small && std::fabs(g) < small && std::fabs(b) < small) [[likely]]
            return add_small(pixel, r, g, b);
        if (keep_values) value[0] = r, value[1] = g, value[2] = b;
        if (std::isfinite(r) && std::isfinite(g) && std::isfinite(b)) {
            slow_.push_back({pixel, {r, g, b}});
        } else if (dropped++ == 0) {
            first_dropped_pixel = pixel;
            first_dropped_sample = sample;
        }
    }

    /// The same for magnitudes below `small`.
    static constexpr float small = 128;
    void add_small(std::uint32_t pixel, float r, float g, float b)
    {
        if (keep_values) [[unlikely]]
            value[0] = r, value[1] = g, value[2] = b;
        const Doubles v{r, g, b, 0};
        constexpr double unit = magic(ExactSum::fraction_bits), coarse = magic(square_bits),
                         fine = magic(ExactSquareSum::fraction_bits);
        const Doubles sum = v + unit, square = v * v, upper = square + coarse,
                      rest = (square - (upper - coarse)) + fine;
        Fast& sums = fast_[pixel];
        sums.sum += (Integers)sum - std::bit_cast<std::int64_t>(unit);
        sums.square += (Integers)upper - std::bit_cast<std::int64_t>(coarse);
        sums.square_rest += (Integers)rest - std::bit_cast<std::int64_t>(fine);
    }

    /// Adds to another sum of the film, by its place there.
    void add_first_hit(std::uint32_t pixel, int place, float number)
    {
        if (std::isfinite(number)) ExactSum::add_number(other_sum(first_hit(pixel), place), number);
    }
    /// Keeps the ids of the lowest sample.
    void set_ids(std::uint32_t pixel, int word, std::uint32_t sample, std::uint32_t instance, std::uint32_t material)
    {
        std::uint32_t* ids = first_hit(pixel) + word;
        if (sample < ids[0] || ids[3] == 0) ids[0] = sample, ids[1] = instance, ids[2] = material, ids[3] = 1;
    }

    /// Adds everything but slow() to the film's words of a pixel. ids: the film's word of ids, or -1.
    void add_to(std::uint32_t pixel, std::uint32_t* film, int sums, int ids) const
    {
        const Fast& fast = fast_[pixel];
        for (int c = 0; c < 3; ++c) {
            ExactSum::add(radiance_sum(film, c), fast.sum[c]);
            // A square is not below its upper part by more than rounding, so no sum is negative.
            constexpr int shift = ExactSquareSum::fraction_bits - square_bits;
            ExactSquareSum::add(square_sum(film, c), (ExactSquareSum::Wide(fast.square[c]) << shift) +
                                                         ExactSquareSum::Wide(fast.square_rest[c]));
        }
        if (first_hits_.empty()) return;
        const std::uint32_t* from = &first_hits_[pixel * (words_per_pixel_ + 1)];
        for (int s = 0; s < sums; ++s) ExactSum::add(other_sum(film, s), other_sum(from, s));
        if (ids >= 0 && from[ids + 3] && from[ids] < film[ids])
            for (int i = 0; i < 3; ++i) film[ids + i] = from[ids + i];
    }

    struct Slow {
        std::uint32_t pixel;
        float value[3];
    };
    const std::vector<Fast>& fast() const { return fast_; }
    const std::vector<Slow>& slow() const { return slow_; }
    std::uint64_t dropped = 0;
    std::uint32_t first_dropped_pixel = 0, first_dropped_sample = 0;  ///< where any was
    /// Keeps the last sample as it came, NaN included: to replay one.
    bool keep_values = false;
    float value[3] = {};

private:
    std::uint32_t* first_hit(std::uint32_t pixel)
    {
        if (first_hits_.empty()) first_hits_.resize(fast_.size() * (words_per_pixel_ + 1));
        return &first_hits_[pixel * (words_per_pixel_ + 1)];
    }

    std::vector<Fast> fast_;
    std::vector<Slow> slow_;
    std::size_t words_per_pixel_ = 0;
    std::vector<std::uint32_t> first_hits_;  ///< words a pixel, and one that says whether there are ids
};

}  // namespace fathom
