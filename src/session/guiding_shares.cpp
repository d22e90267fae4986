// SPDX-License-Identifier: Apache-2.0
#include "session/guiding_shares.h"

#include <algorithm>
#include <array>
#include <numbers>

#include "session/deterministic_reduce.h"
#include "session/guiding_tables.h"

namespace fathom {

namespace {

/// Shares that are compared. The closure keeps at least a third of the directions: it covers what the histogram misses
/// and bounds the noise where the histogram is wrong.
constexpr std::array<double, 5> tried = {0, 0.1, 0.25, 0.45, 0.65};

/// Sums for each region: second moments of contributions, relative to pixel brightness, for each of the tried shares;
/// number of records.
struct ShareMoments {
    std::vector<double> moments;
    std::vector<std::uint32_t> counts;

    explicit ShareMoments(std::size_t regions) : moments(regions * tried.size()), counts(regions) {}
    void add(const ShareMoments& o)
    {
        for (std::size_t i = 0; i < moments.size(); ++i) moments[i] += o.moments[i];
        for (std::size_t i = 0; i < counts.size(); ++i) counts[i] += o.counts[i];
    }
};

/// Density of a record's direction by the histogram of its region, with respect to solid angle.
double histogram_pdf(const GuidingRecord& r, std::uint32_t region, const GuidingTables& tables)
{
    const float* const at = &tables.histograms[std::size_t(region) * guiding_stride + r.bin];
    return double(at[1] - at[0]) * guiding_bins / (4 * std::numbers::pi);
}

/// Adds what a record's contribution would be if its direction had been sampled with each of the tried shares: if the
/// density of a direction becomes k times as large, its contribution becomes 1 / k times as large and occurs k times as
/// often, so that the second moment becomes 1 / k times as large.
void add_moments(const GuidingRecord& r, double square, std::uint32_t region, const GuidingTables& tables, double* sums)
{
    const double moment = double(r.contribution) * double(r.contribution) / square;
    const double ratio = histogram_pdf(r, region, tables) / double(r.bsdf_pdf);
    for (std::size_t i = 0; i < tried.size(); ++i) {
        const double share = tried[i] * double(r.guidable) / GuidingRecord::fully_guidable;
        sums[i] += moment / (1 - share + share * ratio);
    }
}

}  // namespace

void set_shares(const PathStatistics& met, GuidingTables& tables)
{
    const std::size_t regions = tables.histograms.size() / guiding_stride;
    ShareMoments sums =
        deterministic_reduce(met.parts.size(), ShareMoments(regions), [&](std::size_t part, ShareMoments& all) {
            for_records(met.parts[part], met.samples, [&](const GuidingRecord& r, int, double square) {
                if (r.bin == GuidingRecord::no_bin || !(square > 0) || !(r.bsdf_pdf > 0)) return;
                const std::uint32_t region = tables.regions[region_index(r, tables)];
                if (region == no_index) return;
                add_moments(r, square, region, tables, &all.moments[region * tried.size()]);
                ++all.counts[region];
            });
        });
    share_with_neighbors(tables, sums.counts, tried.size(), sums.moments);
    tables.shares.resize(regions);
    for (std::size_t i = 0; i < regions; ++i) {
        const double* const of_region = &sums.moments[i * tried.size()];
        // Without contributions all are 0, and the first, no guidance, is taken.
        const std::ptrdiff_t best = std::min_element(of_region, of_region + tried.size()) - of_region;
        tables.shares[i] = float(tried[std::size_t(best)]);
    }
}

}  // namespace fathom
