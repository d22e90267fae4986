#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "base/large_memory.h"
#include "fathom/render.h"
#include "film/tile_sums.h"

namespace fathom {

/// Throws Error if there is no picture of these settings: its size or its crop is impossible.
void check_settings(const RenderSettings& settings);

/// What a film sums per pixel: radiance, its squares, and then, in this order, what the settings ask for.
/// AovPlaces has the first of each one's sums; `ids` the word of (sample index, instance id, material id) of the first
/// sample.
struct FilmLayout : AovPlaces {
    int sums = 0;             ///< besides radiance and its squares
    int words = other_words;  ///< 32-bit words a pixel

    FilmLayout(const std::vector<Aov>& aovs, bool alpha_wanted);
};

struct Film::Data {
    explicit Data(FilmKey key);
    /// As a new one of another key; memory is kept.
    void reset(FilmKey new_key);

    FilmKey key;
    int width = 0, height = 0;
    FilmLayout layout{{}, false};
    std::vector<SampleRange> samples;
    std::uint64_t dropped = 0;
    std::optional<SamplePlace> dropped_sample;
    using Words = std::vector<std::uint32_t, LargeAllocator<std::uint32_t>>;
    Words words;                     ///< layout.words a pixel
    Words pass_words;                ///< of the pass at work, where it can be cancelled: see render and render_pass
    std::optional<double> sample_s;  ///< what a sample of all pixels took in the last pass

    std::uint32_t* pixel(std::size_t index) { return &words[index * std::size_t(layout.words)]; }
    const std::uint32_t* pixel(std::size_t index) const { return &words[index * std::size_t(layout.words)]; }
    /// Adds the words of the same pixel of another film.
    void add_pixel(std::size_t index, const std::uint32_t* other) { add_pixel(pixel(index), other); }
    /// Adds the words of a pixel to those of another.
    void add_pixel(std::uint32_t* own, const std::uint32_t* other) const
    {
        for (int c = 0; c < 3; ++c) {
            ExactSum::add(radiance_sum(own, c), radiance_sum(other, c));
            ExactSquareSum::add(square_sum(own, c), square_sum(other, c));
        }
        for (int s = 0; s < layout.sums; ++s) ExactSum::add(other_sum(own, s), other_sum(other, s));
        // Of ids, which can't be averaged, those of the lowest sample count.
        if (const int ids = layout.ids; ids >= 0 && other[ids] < own[ids])
            for (int i = 0; i < 3; ++i) own[ids + i] = other[ids + i];
    }
    /// Adds [range) to `samples`. Throws Error if some of it is there already.
    void add_range(SampleRange range);
    /// Counts the samples of another film as here, whose sums are to be added next. Throws Error if they don't belong
    /// here, or some are here already; then nothing is changed.
    void take_samples(const FilmKey& of, const std::vector<SampleRange>& ranges, std::uint64_t dropped_there);
};

}  // namespace fathom
