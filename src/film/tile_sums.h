// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <bit>
#include <cmath>
#include <cstdint>
#include <vector>

#include "film/exact_sum.h"

namespace fathom {

/// Word offsets within a film's pixel: sums of radiance, sums of squares, then all other sums in the order of
/// FilmLayout.
inline constexpr int square_words = 3 * ExactSum::words, other_words = square_words + 3 * ExactSquareSum::words;
/// The words of one sum within a pixel: of radiance, of squared radiance, or of another quantity by its index.
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

/// Index of the first sum of each layer among the other sums; -1 if the layer is not wanted. See FilmLayout.
struct AovPlaces {
    int alpha = -1, albedo = -1, normal = -1, depth = -1, position = -1, hits = -1, ids = -1;
    bool any() const { return alpha >= 0 || need_surfaces(); }
    /// Whether any layer depends on more than whether there is a hit.
    bool need_surfaces() const { return albedo >= 0 || normal >= 0 || depth >= 0 || position >= 0 || ids >= 0; }
};

/// Sums over the samples of one job, pixel by pixel: radiance, its square, and the layers of first hits.
///
/// Adding is fast for radiance below 128, the common case; larger values are kept in a list and summed one by one.
class TileSums {
public:
    /// Vectors of four numbers by the GCC and Clang extension, which is available for every instruction set.
    using Doubles = double __attribute__((vector_size(32)));
    using Integers = std::int64_t __attribute__((vector_size(32)));
    // The alignment of Fast is explicit because GCC's default alignment of vectors depends on the instruction set, and
    // library and kernels must agree.
    // Squares are split in two sums: multiples of 2^-20, and the remainders, which may be negative, in units of 2^-54.
    struct alignas(32) Fast {
        Integers sum{}, square{}, square_rest{};
    };

    /// Adding 1.5 * 2^52 units leaves a value, rounded to units, in the low bits of the double.
    static constexpr double magic(int fraction_bits) { return 0x1.8p52 / double(std::uint64_t(1) << fraction_bits); }
    static constexpr int square_bits = 20;

    /// Resets all sums to 0. words: 32-bit words of a pixel in the film.
    void reset(std::size_t pixels, std::size_t words)
    {
        fast_.assign(pixels, {});
        slow_.clear();
        words_per_pixel_ = words;
        first_hits_.clear();
        dropped = 0;
    }

    /// Prefetches the sums of a pixel.
    void fetch(std::uint32_t pixel) const
    {
        const char* const sums = reinterpret_cast<const char*>(&fast_[pixel]);
        __builtin_prefetch(sums), __builtin_prefetch(sums + sizeof(Fast) - 1);
    }

    /// Adds the radiance of one sample and its square. Samples with NaN or infinity are dropped and counted.
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

    /// Channels of usual samples are below this magnitude.
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

    /// Adds a number to one of the other sums of a pixel, by its index.
    void add_first_hit(std::uint32_t pixel, int place, float number)
    {
        if (std::isfinite(number)) ExactSum::add_number(other_sum(first_hit(pixel), place), number);
    }
    /// Stores the ids of a sample unless a sample with a lower index has set them.
    void set_ids(std::uint32_t pixel, int word, std::uint32_t sample, std::uint32_t instance, std::uint32_t material)
    {
        std::uint32_t* ids = first_hit(pixel) + word;
        if (sample < ids[0] || ids[3] == 0) ids[0] = sample, ids[1] = instance, ids[2] = material, ids[3] = 1;
    }

    /// Adds everything except slow() to a film pixel. sums: number of other sums; ids: the film's word of ids, or -1.
    void add_to(std::uint32_t pixel, std::uint32_t* film, int sums, int ids) const
    {
        const Fast& fast = fast_[pixel];
        for (int c = 0; c < 3; ++c) {
            ExactSum::add(radiance_sum(film, c), fast.sum[c]);
            // The remainders can lower a sum of squares only by rounding, so no sum is negative.
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

    /// A sample with a channel of at least `small` in magnitude.
    struct Slow {
        std::uint32_t pixel;
        float value[3];
    };
    const std::vector<Fast>& fast() const { return fast_; }
    const std::vector<Slow>& slow() const { return slow_; }
    std::uint64_t dropped = 0;
    std::uint32_t first_dropped_pixel = 0,
                  first_dropped_sample = 0;  ///< pixel and index of the first dropped sample, if any
    /// If true, keeps the last sample in `value`, NaN included, to replay a single sample.
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
    std::vector<std::uint32_t>
        first_hits_;  ///< words_per_pixel_ words per pixel, and one more that tells whether ids are set
};

}  // namespace fathom
