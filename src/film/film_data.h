// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "base/large_memory.h"
#include "fathom/render.h"
#include "film/tile_sums.h"

namespace fathom {

/// Throws Error if no image can be rendered with these settings, because its size, crop or filter radius is invalid.
void check_settings(const RenderSettings& settings);

/// Layout of a film's pixel: sums of radiance, sums of its squares, then the sums that the settings ask for in the
/// order of the members of AovPlaces, which hold the index of the first sum of each. `ids` is the word of (sample
/// index, instance id, material id) of the first sample. With light tracing, the sums of splats and of their squares
/// are apart from those of camera paths: the variance of each is known from its own. With error probes, one more sum
/// per pixel has room for those of a Probe nearby.
struct FilmLayout : AovPlaces {
    int splats = -1;          ///< index of the first of three sums of splats; -1: no light tracing
    int probe = -1;           ///< index of the sum of a probe; -1: no probes
    int splat_squares = -1;   ///< word of the first of three sums of squared splats
    int sums = 0;             ///< number of sums besides radiance and its squares
    int words = other_words;  ///< 32-bit words per pixel

    FilmLayout(const std::vector<Aov>& aovs, bool alpha_wanted, bool light_tracing = false, bool error_probes = false);
    explicit FilmLayout(const RenderSettings& settings)
        : FilmLayout(settings.aovs, settings.alpha, settings.light_paths > 0, settings.error_probes)
    {
    }
    /// The sum of squared splats of a channel, within a pixel.
    template <class Word>
    Word* splat_square(Word* pixel, int channel) const
    {
        return pixel + splat_squares + channel * ExactSquareSum::words;
    }
};

/// Contents of a film: key, sample ranges and sums.
struct Film::Data {
    explicit Data(FilmKey key);
    /// Resets to an empty film with another key; the memory is kept.
    void reset(FilmKey new_key);

    FilmKey key;
    int width = 0, height = 0;
    FilmLayout layout{{}, false};
    std::vector<SampleRange> samples;
    std::uint64_t dropped = 0;
    std::optional<SampleLocation> invalid_sample;
    using Words = std::vector<std::uint32_t, LargeAllocator<std::uint32_t>>;
    Words words;       ///< layout.words words per pixel
    Words pass_words;  ///< sums that a cancellable pass writes to and that are swapped with `words` at its end: see
                       ///< render and render_pass
    std::optional<double> sample_s;  ///< seconds for one sample of all pixels in the last pass

    std::uint32_t* pixel(std::size_t index) { return &words[index * std::size_t(layout.words)]; }
    const std::uint32_t* pixel(std::size_t index) const { return &words[index * std::size_t(layout.words)]; }
    /// Adds the words of the same pixel of another film.
    void add_pixel(std::size_t index, const std::uint32_t* other) { add_pixel(pixel(index), other); }
    /// Adds the words of one pixel to those of another.
    void add_pixel(std::uint32_t* own, const std::uint32_t* other) const
    {
        for (int c = 0; c < 3; ++c) {
            ExactSum::add(radiance_sum(own, c), radiance_sum(other, c));
            ExactSquareSum::add(square_sum(own, c), square_sum(other, c));
        }
        for (int s = 0; s < layout.sums; ++s) ExactSum::add(other_sum(own, s), other_sum(other, s));
        for (int c = 0; layout.splats >= 0 && c < 3; ++c)
            ExactSquareSum::add(layout.splat_square(own, c), layout.splat_square(other, c));
        // Ids can't be averaged: those of the lowest sample index are kept.
        if (const int ids = layout.ids; ids >= 0 && other[ids] < own[ids])
            for (int i = 0; i < 3; ++i) own[ids + i] = other[ids + i];
    }
    /// Adds [range) to `samples`. Throws Error if it overlaps samples that are already there.
    void add_range(SampleRange range);
    /// Registers the samples of another film whose sums are added next. Throws Error, without any change, if the films
    /// do not belong together or samples overlap.
    void register_samples(const FilmKey& of, const std::vector<SampleRange>& ranges, std::uint64_t dropped_there);
};

}  // namespace fathom
