// SPDX-License-Identifier: Apache-2.0
#include "session/efficiency_roulette.h"

#include <algorithm>
#include <cmath>

#include "session/deterministic_reduce.h"
#include "session/guiding_tables.h"

namespace fathom {

namespace {

/// Weight of the global mean in a cube's estimate, as a number of samples.
constexpr double samples_of_mean = 32;
/// Light sample probabilities are multiplied by this factor, because roulette destroys stratification.
constexpr double nee_safety_factor = 1.5;
/// Cost of a ray that hits nothing, as a fraction of the cost of a vertex.
constexpr double miss_cost = 0.5;
/// Cost of a shadow ray, as a fraction of the cost of a vertex.
constexpr double shadow_cost = 0.2;
/// Assumed fraction of unoccluded light samples. Measured fractions per cube would miss light where few samples arrive.
constexpr double visible_fraction = 0.25;
constexpr double max_factor = 1e30;

/// Sums for each cube: squared light contributions relative to pixel brightness, inverse squared brightness, number of
/// records.
struct LightSums {
    std::vector<double> squares, weights, counts;

    explicit LightSums(std::size_t cubes) : squares(cubes), weights(cubes), counts(cubes) {}
    void add(const LightSums& o)
    {
        for (std::size_t i = 0; i < squares.size(); ++i)
            squares[i] += o.squares[i], weights[i] += o.weights[i], counts[i] += o.counts[i];
    }
};

LightSums light_sums(const PathStatistics& met, const GuidingTables& tables)
{
    const std::size_t cubes = std::size_t(tables.cells[0]) * tables.cells[1] * tables.cells[2];
    return deterministic_reduce(met.parts.size(), LightSums(cubes), [&](std::size_t part, LightSums& sums) {
        for_records(met.parts[part], met.samples, [&](const GuidingRecord& r, int, double square) {
            const std::size_t cube = guiding_cube(tables, r.position);
            if (square > 0) {
                sums.squares[cube] += double(r.light) * double(r.light) / square;
                sums.weights[cube] += 1 / square;
            }
            sums.counts[cube] += 1;
        });
    });
}

/// Returns for each cube `factor` times the root mean of the sums. Cubes with few records are blended with the mean
/// over all cubes.
LargeVector<float> roots_of_means(const std::vector<double>& sums, const std::vector<double>& counts, double factor)
{
    double all = 0, count = 0;
    for (double x : sums) all += x;
    for (double n : counts) count += n;
    const double mean = all / std::max(count, 1.0);
    LargeVector<float> roots(sums.size());
    for (std::size_t i = 0; i < sums.size(); ++i) {
        const double own = (sums[i] + samples_of_mean * mean) / (counts[i] + samples_of_mean);
        roots[i] = float(std::min(factor * std::sqrt(own), max_factor));
    }
    return roots;
}

/// Returns vertices per path over the variance and the cost of an operation, which scales squared probabilities.
double time_over_noise(const PathStatistics& met, double cost)
{
    return met.variance > 0 ? met.vertices / (cost * met.variance) : 0;
}

/// Sums for each region over paths that continued: squared contributions relative to pixel brightness, costs, number of
/// records.
struct PathSums {
    std::vector<double> squares, costs;
    std::vector<std::uint32_t> counts;

    explicit PathSums(std::size_t regions) : squares(regions), costs(regions), counts(regions) {}
    void add(const PathSums& o)
    {
        for (std::size_t i = 0; i < squares.size(); ++i)
            squares[i] += o.squares[i], costs[i] += o.costs[i], counts[i] += o.counts[i];
    }
};

PathSums path_sums(const PathStatistics& met, const GuidingTables& tables)
{
    const std::size_t regions = tables.histograms.size() / guiding_stride;
    return deterministic_reduce(met.parts.size(), PathSums(regions), [&](std::size_t part, PathSums& sums) {
        for_records(met.parts[part], met.samples, [&](const GuidingRecord& r, int after, double square) {
            if (r.bin == GuidingRecord::no_bin) return;
            const std::uint32_t region = tables.regions[region_index(r, tables)];
            if (region == no_index) return;
            const double relative = r.throughput > 0 ? double(r.contribution) / double(r.throughput) : 0;
            if (square > 0) sums.squares[region] += relative * relative / square;
            sums.costs[region] += after + miss_cost;
            ++sums.counts[region];
        });
    });
}

}  // namespace

void set_nee_factors(const PathStatistics& met, GuidingTables& tables)
{
    const LightSums sums = light_sums(met, tables);
    const double factor = nee_safety_factor * std::sqrt(time_over_noise(met, nee_cost));
    tables.nee_factors = roots_of_means(sums.squares, sums.counts, factor);
}

void set_shadow_ray_factors(const PathStatistics& met, GuidingTables& tables)
{
    const LightSums sums = light_sums(met, tables);
    const double factor = std::sqrt(visible_fraction * time_over_noise(met, shadow_cost));
    tables.shadow_ray_factors = roots_of_means(sums.weights, sums.counts, factor);
}

void set_survival_factors(const PathStatistics& met, GuidingTables& tables)
{
    PathSums sums = path_sums(met, tables);
    share_with_neighbors(tables, sums.counts, 1, sums.squares);
    share_with_neighbors(tables, sums.counts, 1, sums.costs);
    const double scale = met.variance > 0 ? (met.vertices + miss_cost) / met.variance : 0;
    tables.survival_factors.resize(sums.counts.size());
    for (std::size_t i = 0; i < sums.counts.size(); ++i) {
        // In regions without data, paths continue.
        const double ratio = sums.costs[i] > 0 ? sums.squares[i] / sums.costs[i] : max_factor;
        tables.survival_factors[i] = float(std::min(std::sqrt(ratio * scale), max_factor));
    }
}

}  // namespace fathom
