// SPDX-License-Identifier: Apache-2.0
#include "fathom/image_error.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "film/error_terms.h"
#include "film/moments.h"
#include "film/pareto_tail.h"

namespace fathom {

namespace {

bool is_used(const ProbeTerm& probe, ErrorProbes set)
{
    return set == ErrorProbes::all || probe.decides == (set == ErrorProbes::deciding);
}

/// Pixels of one kind, by the fraction of their samples that bring their light. Even sampling helps where many samples
/// do, and not at all where light comes by chance.
struct Stratum {
    double factor = 1;          ///< from the squared error that variances suggest to the one that probes show
    double standard_error = 0;  ///< of the factor
};

/// The strata of a film, with factors that its probes show.
class Correction {
public:
    Correction(const ErrorTerms& terms, double samples_per_pixel, ErrorProbes set)
        : samples_per_pixel_(samples_per_pixel)
    {
        std::array<Sums, strata> sums;
        add_prior(terms, sums);
        for (const ProbeTerm& p : terms.probes)
            if (is_used(p, set)) sums[index_of(p.samples)].add(p.seen, p.suggested);
        for (std::size_t s = 0; s < strata; ++s)
            if (sums[s].suggested > 0) strata_[s].factor = sums[s].seen / sums[s].suggested;
        add_standard_errors(terms, set, sums);
    }

    const Stratum& stratum(double effective_samples) const { return strata_[index_of(effective_samples)]; }
    std::size_t index_of(double effective_samples) const
    {
        constexpr std::array ends{1 / 16.0, 1 / 4.0, 1 / 2.0};
        const double fraction = effective_samples / samples_per_pixel_;
        return std::size_t(std::upper_bound(ends.begin(), ends.end(), fraction) - ends.begin());
    }
    /// Estimated squared error of a pixel.
    double corrected(const ErrorTerms& terms, std::size_t pixel) const
    {
        return stratum(double(terms.samples[pixel])).factor * double(terms.paths[pixel]) + double(terms.splats[pixel]);
    }
    double corrected(const ProbeTerm& probe) const { return stratum(probe.samples).factor * probe.suggested; }
    double standard_error(std::size_t stratum) const { return strata_[stratum].standard_error; }
    /// Effective number of probes.
    double freedom() const { return freedom_; }
    /// Mean squared ProbeTerm::seen.
    double seen_square() const { return seen_square_; }

    static constexpr std::size_t strata = 4;

private:
    struct Sums {
        double seen = 0, suggested = 0, residuals = 0;
        void add(double seen_here, double suggested_here) { seen += seen_here, suggested += suggested_here; }
    };

    /// Each stratum starts as if three probes had shown independent samples, so that one without probes has a factor.
    void add_prior(const ErrorTerms& terms, std::array<Sums, strata>& sums) const
    {
        constexpr double probes = 3;
        std::array<double, strata> total{}, count{};
        for (std::size_t i = 0; i < terms.paths.size(); ++i) {
            const std::size_t s = index_of(double(terms.samples[i]));
            total[s] += double(terms.paths[i]), ++count[s];
        }
        for (std::size_t s = 0; s < strata; ++s) {
            const double mean = count[s] > 0 ? total[s] / count[s] : 0;
            sums[s].add(probes * mean, probes * mean);
            sums[s].residuals = probes * mean * mean;
        }
    }
    void add_standard_errors(const ErrorTerms& terms, ErrorProbes set, std::array<Sums, strata>& sums)
    {
        double total = 0, squares = 0;
        int count = 0;
        for (const ProbeTerm& p : terms.probes) {
            if (!is_used(p, set)) continue;
            const double estimate = corrected(p), residual = p.seen - estimate;
            sums[index_of(p.samples)].residuals += residual * residual;
            seen_square_ += p.seen * p.seen;
            total += estimate, squares += estimate * estimate;
            ++count;
        }
        for (std::size_t s = 0; s < strata; ++s)
            if (sums[s].suggested > 0) strata_[s].standard_error = std::sqrt(sums[s].residuals) / sums[s].suggested;
        if (count > 0) seen_square_ /= count;
        if (squares > 0) freedom_ = total * total / squares;
    }

    const double samples_per_pixel_;
    std::array<Stratum, strata> strata_;
    double freedom_ = 0, seen_square_ = 0;
};

/// The 97.5 % quantile of Student's distribution, within 1 % from 3 degrees of freedom on.
double student_quantile(double freedom)
{
    const double n = std::max(freedom - 1, 2.0);
    return 1.96 + 2.37 / n + 2.8 / (n * n) + 2.3 / (n * n * n);
}

/// Estimated squared errors of some pixels, summed.
struct SquaredError {
    std::size_t pixels = 0;
    double sum = 0;
    std::array<double, Correction::strata> paths{};  ///< part of each stratum before correction
    double variance = 0;                             ///< of the sum, since variances of pixels are estimates themselves

    void add(const ErrorTerms& terms, const Correction& correction, std::size_t pixel)
    {
        const double square = correction.corrected(terms, pixel), samples = double(terms.samples[pixel]);
        ++pixels;
        sum += square;
        paths[correction.index_of(samples)] += double(terms.paths[pixel]);
        variance += square * square / samples;
    }
};

/// The error of the pixels that were summed.
///
/// local  a further factor that probes nearby show
ImageError error_of(const SquaredError& squares, const Correction& correction, const Stratum& local)
{
    ImageError result;
    const double sum = local.factor * squares.sum;
    result.error = result.low = result.high = std::sqrt(sum / double(squares.pixels));
    if (!(sum > 0)) return result;
    double variance = squares.variance;
    for (std::size_t s = 0; s < Correction::strata; ++s) {
        const double of_stratum = squares.paths[s] * correction.standard_error(s);
        variance += of_stratum * of_stratum;
    }
    // The squared error of this very image differs from its expected value, too. Squares of normal deviations have a
    // mean square of three, of which two are variance.
    variance += correction.seen_square() * 2 / 3 * double(squares.pixels);
    const double relative = std::hypot(std::sqrt(variance) / squares.sum, local.standard_error / local.factor);
    const double spread = std::exp(student_quantile(correction.freedom()) * relative / 2);
    result.low /= spread, result.high *= spread;
    return result;
}

/// Square blocks of pixels, each with a factor of its own that its probes show.
class ErrorBlocks {
public:
    static constexpr int side = 32;

    ErrorBlocks(const ErrorTerms& terms, ErrorProbes set, const Correction& correction)
        : columns_((terms.width + side - 1) / side),
          rows_((int(terms.paths.size()) / terms.width + side - 1) / side),
          sums_(std::size_t(columns_) * std::size_t(rows_))
    {
        double total = 0;
        int count = 0;
        for (const ProbeTerm& p : terms.probes) {
            if (!is_used(p, set)) continue;
            const double estimate = correction.corrected(p);
            sums_[index_of(p.x, p.y)] += {p.seen, estimate, p.seen * p.seen};
            total += estimate;
            ++count;
        }
        constexpr double probes_of_whole = 8;
        prior_ = count > 0 ? probes_of_whole * total / count : 0;
    }
    std::size_t count() const { return sums_.size(); }
    /// The block of a pixel.
    std::size_t index_of(int x, int y) const
    {
        return std::size_t(y / side) * std::size_t(columns_) + std::size_t(x / side);
    }
    /// The factor of a block follows from the probes in the nine blocks around, and as if eight more had shown 1.
    Stratum factor(std::size_t block) const
    {
        const int column = int(block % std::size_t(columns_)), row = int(block / std::size_t(columns_));
        Sums around;
        for (int v = std::max(row - 1, 0); v <= std::min(row + 1, rows_ - 1); ++v)
            for (int u = std::max(column - 1, 0); u <= std::min(column + 1, columns_ - 1); ++u)
                around += sums_[std::size_t(v) * std::size_t(columns_) + std::size_t(u)];
        const double estimate = around.estimate + prior_;
        if (!(estimate > 0)) return {};
        return {(around.seen + prior_) / estimate, std::sqrt(around.square * 2 / 3) / estimate};
    }

private:
    struct Sums {
        double seen = 0, estimate = 0, square = 0;
        Sums& operator+=(const Sums& o)
        {
            seen += o.seen, estimate += o.estimate, square += o.square;
            return *this;
        }
    };
    int columns_, rows_;
    std::vector<Sums> sums_;
    double prior_ = 0;
};

ImageError whole_error(const ErrorTerms& terms, const Correction& correction)
{
    SquaredError squares;
    for (std::size_t i = 0; i < terms.paths.size(); ++i) squares.add(terms, correction, i);
    return error_of(squares, correction, {});
}

/// The error of the block where it is largest.
ImageError worst_block(const ErrorTerms& terms, const Correction& correction, ErrorProbes set)
{
    const ErrorBlocks blocks(terms, set, correction);
    std::vector<SquaredError> squares(blocks.count());
    for (std::size_t i = 0; i < terms.paths.size(); ++i)
        squares[blocks.index_of(int(i % std::size_t(terms.width)), int(i / std::size_t(terms.width)))].add(
            terms, correction, i);
    ImageError worst;
    for (std::size_t b = 0; b < squares.size(); ++b) {
        const ImageError error = error_of(squares[b], correction, blocks.factor(b));
        if (error.error > worst.error) worst = error;
    }
    return worst;
}

/// Fills in what the noisiest pixels, and those that few samples decide, tell about the error of the whole image.
void describe_tail(const ErrorTerms& terms, const Correction& correction, ImageError& result)
{
    constexpr float few_samples = 4;
    constexpr double negligible = 0.1;
    std::vector<float> all(terms.paths.size()), few;
    for (std::size_t i = 0; i < all.size(); ++i) {
        all[i] = float(correction.corrected(terms, i));
        if (terms.samples[i] < few_samples) few.push_back(all[i]);
    }
    const auto sum = [](auto begin, auto end) { return std::accumulate(begin, end, 0.0); };
    const double in_all = sum(all.begin(), all.end());
    if (!(in_all > 0)) return;
    result.few_share = sum(few.begin(), few.end()) / in_all;
    if (result.few_share > negligible) result.tail_shape = pareto_tail_shape(std::move(few));
    const std::size_t top = std::max<std::size_t>(1, all.size() / 1000);
    const auto first_of_top = all.end() - std::ptrdiff_t(top);
    std::nth_element(all.begin(), first_of_top, all.end());
    const double in_top = sum(first_of_top, all.end());
    result.top_share = in_top / in_all;
    if (all.size() > top) result.rest = std::sqrt(std::max(0.0, in_all - in_top) / double(all.size() - top));
}

}  // namespace

std::optional<ImageError> estimate_error(const Film& film, ErrorMetric metric, ErrorProbes set)
{
    constexpr int fewest_probes = 8;
    if (!film.key().settings.error_probes || film.samples_per_pixel() < 2) return {};
    const ErrorTerms terms = error_terms(film, metric != ErrorMetric::absolute);
    const auto used = [&](const ProbeTerm& p) { return is_used(p, set); };
    if (std::count_if(terms.probes.begin(), terms.probes.end(), used) < fewest_probes) return {};
    const Correction correction(terms, double(film.samples_per_pixel()), set);
    ImageError result =
        metric == ErrorMetric::worst_block ? worst_block(terms, correction, set) : whole_error(terms, correction);
    describe_tail(terms, correction, result);
    return result;
}

Image::Layer standard_error(const Film& film)
{
    const Crop inside = film.key().settings.rendered_pixels();
    const std::size_t pixels = std::size_t(film.width()) * std::size_t(film.height());
    Image::Layer layer{"error", {"R", "G", "B"}, std::vector<float>(3 * pixels)};
    if (film.samples_per_pixel() < 2) return layer;
    const ErrorTerms terms = error_terms(film, true);
    const Correction correction(terms, double(film.samples_per_pixel()), ErrorProbes::all);
    const ErrorBlocks blocks(terms, ErrorProbes::all, correction);
    std::vector<double> factors;
    for (std::size_t block = 0; block < blocks.count(); ++block) factors.push_back(blocks.factor(block).factor);
    const FilmMoments moments(film);
    for (int y = inside.y0; y < inside.y1; ++y)
        for (int x = inside.x0; x < inside.x1; ++x) {
            const ChannelMoments m = moments.of(x, y);
            const std::size_t block = blocks.index_of(x - inside.x0, y - inside.y0);
            const double factor = correction.stratum(moments.effective_samples(x, y)).factor * factors[block];
            float* const to = &layer.pixels[3 * (std::size_t(y) * std::size_t(film.width()) + std::size_t(x))];
            for (std::size_t c = 0; c < 3; ++c) to[c] = float(std::sqrt(factor * m.variance[c] + m.splat_variance[c]));
        }
    return layer;
}

}  // namespace fathom
