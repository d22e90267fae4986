// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "fathom/api.h"
#include "fathom/image.h"
#include "fathom/job.h"

namespace fathom {

/// Range of sample indices: the first, and one past the last.
using SampleRange = std::pair<std::uint64_t, std::uint64_t>;
/// Sample indices are below this number.
inline constexpr std::uint64_t max_samples = std::uint64_t(1) << 32;

/// Exact sums of the samples of each pixel.
///
/// Sums are fixed-point integers, so the bits of the result don't depend on the order of the samples, the number of
/// threads, or the way in which a render was split and merged. Samples are rounded to multiples of 2^-36 and clamped to
/// magnitudes below 2^50. A film can be moved but not copied, and belongs to one thread at a time.
class FATHOM_API Film {
public:
    /// Creates a film without samples for `job`.
    explicit Film(const RenderJob& job);
    /// Creates a film without samples, into which others with the same key can be merged.
    explicit Film(FilmKey key);
    /// Moves the sums; the source may only be assigned to or destroyed afterwards.
    Film(Film&&) noexcept;
    /// Moves the sums; the source may only be assigned to or destroyed afterwards.
    Film& operator=(Film&&) noexcept;
    ~Film();

    /// Returns the memory of a film of these settings in bytes per pixel of the whole image.
    static std::size_t bytes_per_pixel(const RenderSettings& settings);

    /// Removes all samples and prepares the film for `job`. It reuses memory if size and layers are the same.
    void reset(const RenderJob& job);

    /// Returns what the film contains samples of.
    const FilmKey& key() const;
    /// Returns the width of the image in pixels.
    int width() const;
    /// Returns the height of the image in pixels.
    int height() const;
    /// Returns the ranges of sample indices in the film: sorted, disjoint, and joined where they touch.
    const std::vector<SampleRange>& samples() const;
    /// Returns the number of samples per pixel.
    std::uint64_t samples_per_pixel() const;
    /// Returns the number of samples, and of values from light paths, that were NaN or infinite. They count as black,
    /// which is a bias.
    std::uint64_t invalid_samples() const;
    /// Pixel and index of a sample.
    struct SampleLocation {
        int x = 0, y = 0;          ///< Column from the left and row from the top.
        std::uint64_t sample = 0;  ///< Sample index.
    };
    /// Returns one of the invalid samples, which render_sample() can replay. Returns nothing if there was none since
    /// the film was created, or only values from light paths were invalid; films read from files don't contain this
    /// information.
    std::optional<SampleLocation> invalid_sample() const;

    /// Adds the sums of another film.
    ///
    /// Throws Error, without changing this film, if the keys differ or a sample is in both films.
    void merge(const Film& other);

    /// Returns the mean radiance of the samples so far as one layer R, G, B, followed by A if `alpha` is true and the
    /// settings have alpha. Radiance is linear Rec.709 and premultiplied; without samples it is 0.
    Image beauty(bool alpha) const;
    /// Returns beauty(alpha) and a layer for each AOV of the settings:
    ///
    /// layer       channels  where nothing is hit
    /// "albedo"    R G B     0
    /// "normal"    X Y Z     0; shorter than 1 at edges
    /// "depth"     Z         infinity
    /// "position"  X Y Z     0
    /// "instance"  ID        0
    /// "material"  ID        0
    ///
    /// If `variance` is true, a layer "variance" with R, G, B follows: the estimated variance of the mean, which is the
    /// square of its standard error. It is 0 below two samples.
    Image image(bool alpha, bool variance) const;

    /// Estimated effect of fireflies: few samples that are much brighter than those of the pixels around.
    struct Fireflies {
        double samples = 0;  ///< Estimated fraction of all samples that are fireflies, 0 to 1.
        double noise = 0;    ///< Estimated fraction of the image's variance that fireflies cause, 0 to 1.
    };
    /// Estimates fireflies from pixels whose variance is far above that of their neighborhood. For each, it derives the
    /// number of equally bright samples that explains the difference. Returns zeros below 4 samples per pixel.
    Fireflies fireflies() const;

    /// Internal state, defined inside the library.
    struct Data;
    /// Returns the internal state.
    Data& data() { return *data_; }
    /// Returns the internal state.
    const Data& data() const { return *data_; }

private:
    std::unique_ptr<Data> data_;
};

}  // namespace fathom
