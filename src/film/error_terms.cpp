// SPDX-License-Identifier: Apache-2.0
#include "film/error_terms.h"

#include <algorithm>
#include <cmath>

#include <tbb/parallel_for.h>

#include "film/moments.h"

namespace fathom {

namespace {

using Row = std::vector<ChannelMoments>;

/// Rows around a pixel, of which the middle one contains it; those outside of the image are empty.
constexpr std::size_t reach = 2;
using Rows = std::array<Row, 2 * reach + 1>;

/// Sums over pixels, by channel: means, their squares, and variances due to noise.
struct NeighborSums {
    int count = 0;
    Channels mean{}, square{}, variance{};

    void add(const ChannelMoments& m, double sign = 1)
    {
        for (std::size_t c = 0; c < 3; ++c) {
            mean[c] += sign * m.mean[c];
            square[c] += sign * m.mean[c] * m.mean[c];
            variance[c] += sign * m.all_variance(c);
        }
        count += int(sign);
    }
    void add(const NeighborSums& o)
    {
        for (std::size_t c = 0; c < 3; ++c)
            mean[c] += o.mean[c], square[c] += o.square[c], variance[c] += o.variance[c];
        count += o.count;
    }
};

/// The sums of each column of the rows.
std::vector<NeighborSums> column_sums(const Rows& rows)
{
    std::vector<NeighborSums> sums(rows[reach].size());
    for (const Row& row : rows)
        for (std::size_t x = 0; x < row.size(); ++x) sums[x].add(row[x]);
    return sums;
}

/// The sums of the up to 24 pixels around a pixel.
NeighborSums sums_around(const std::vector<NeighborSums>& columns, std::size_t x, const ChannelMoments& own)
{
    NeighborSums sums;
    for (std::size_t u = x - std::min(x, reach); u < std::min(columns.size(), x + reach + 1); ++u) sums.add(columns[u]);
    sums.add(own, -1);
    return sums;
}

/// Weight of the squared error of a pixel's channel: 1 / (r^2 + 0.01), where r is the value without noise.
///
/// The pixel itself is no good estimate of r, since it contains the error: a bright outlier would hide itself. As in
/// empirical Bayes estimation, r^2 is therefore taken from the pixel (its squared mean minus the variance) and from the
/// mean of its neighbors, in proportion to how much of their variation is due to the image and to noise.
double relative_weight(const ChannelMoments& own, const NeighborSums& around, std::size_t channel)
{
    constexpr double floor = 0.01;
    const double value = own.mean[channel], own_variance = own.all_variance(channel);
    const double own_square = std::max(0.0, value * value - own_variance);
    if (around.count == 0) return 1 / (own_square + floor);
    const double scale = 1.0 / around.count;
    const double mean = around.mean[channel] * scale, variance = std::max(0.0, around.variance[channel] * scale);
    const double noise = std::max(own_variance, variance);
    const double of_image = std::max(0.0, around.square[channel] * scale - mean * mean - variance);
    const double share = noise + of_image > 0 ? noise / (noise + of_image) : 1;
    const double square = share * mean * mean + (1 - share) * own_square;
    // Noise in the estimate would on average increase the weight.
    return 1 / (square + floor + variance * scale);
}

/// Evaluates the terms of a film row by row.
class Evaluation {
public:
    Evaluation(const Film& film, bool is_relative, ErrorTerms& terms)
        : moments_(film), inside_(film.key().settings.rendered_pixels()), is_relative_(is_relative), terms_(terms)
    {
        terms.width = inside_.x1 - inside_.x0;
        const std::size_t pixels = std::size_t(terms.width) * std::size_t(inside_.y1 - inside_.y0);
        terms.paths.resize(pixels);
        terms.splats.resize(pixels);
        terms.samples.resize(pixels);
        if (!film.key().settings.error_probes) return;
        probes_ = probes_of(film.width(), inside_);
        for (const Probe& probe : probes_)
            terms.probes.push_back({probe.x - inside_.x0, probe.y - inside_.y0, probe.decides});
    }

    void evaluate()
    {
        tbb::parallel_for(tbb::blocked_range<int>(inside_.y0, inside_.y1, 16), [&](const auto& range) {
            Rows rows;
            for (std::size_t v = 0; v + 1 < rows.size(); ++v) rows[v + 1] = row(range.begin() + int(v) - int(reach));
            auto probe = std::lower_bound(probes_.begin(), probes_.end(), range.begin(),
                                          [](const Probe& p, int y) { return p.y < y; });
            for (int y = range.begin(); y < range.end(); ++y) {
                std::rotate(rows.begin(), rows.begin() + 1, rows.end());
                rows.back() = row(y + int(reach));
                const Row& row = rows[reach];
                const std::vector<NeighborSums> columns = column_sums(rows);
                for (std::size_t x = 0; x < row.size(); ++x) {
                    const bool is_probe = probe != probes_.end() && probe->y == y && probe->x - inside_.x0 == int(x);
                    evaluate_pixel(row[x], sums_around(columns, x, row[x]), x, y, is_probe ? &*probe++ : nullptr);
                }
            }
        });
    }

private:
    Row row(int y) const
    {
        Row row;
        for (int x = inside_.x0; x < inside_.x1 && y >= inside_.y0 && y < inside_.y1; ++x)
            row.push_back(moments_.of(x, y));
        return row;
    }
    void evaluate_pixel(const ChannelMoments& m, const NeighborSums& around, std::size_t x, int y, const Probe* probe)
    {
        Channels weight{1.0 / 3, 1.0 / 3, 1.0 / 3};
        double paths = 0, splats = 0;
        for (std::size_t c = 0; c < 3; ++c) {
            if (is_relative_) weight[c] *= relative_weight(m, around, c);
            paths += weight[c] * m.variance[c];
            splats += weight[c] * m.splat_variance[c];
        }
        const std::size_t index = std::size_t(y - inside_.y0) * std::size_t(terms_.width) + x;
        terms_.paths[index] = float(paths);
        terms_.splats[index] = float(splats);
        terms_.samples[index] = float(moments_.effective_samples(inside_.x0 + int(x), y));
        if (!probe) return;
        ProbeTerm& term = terms_.probes[std::size_t(probe - probes_.data())];
        term.suggested = paths;
        term.samples = double(terms_.samples[index]);
        const Channels first = moments_.path_mean(probe->x, probe->y), second = moments_.second_mean(*probe);
        for (std::size_t c = 0; c < 3; ++c)
            term.seen += weight[c] * (first[c] - second[c]) * (first[c] - second[c]) / 2;
    }

    const FilmMoments moments_;
    const Crop inside_;
    const bool is_relative_;
    ErrorTerms& terms_;
    std::vector<Probe> probes_;
};

}  // namespace

ErrorTerms error_terms(const Film& film, bool is_relative)
{
    ErrorTerms terms;
    Evaluation(film, is_relative, terms).evaluate();
    return terms;
}

}  // namespace fathom
