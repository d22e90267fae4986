#include "session/efficiency_roulette.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "session/deterministic_reduce.h"
#include "session/guiding_tables.h"

namespace fathom {

namespace {

/// What is known of a cube counts beside so many samples of the mean of all.
constexpr double samples_of_mean = 32;
/// Chances of light samples are so many times those of the rule: they are spread evenly, which chance undoes.
constexpr double light_caution = 1.5;
/// The same of going on; measured.
constexpr double path_caution = 0.7;
/// What a ray takes that meets nothing, of all that a vertex takes.
constexpr double miss_cost = 0.5;
/// What a shadow ray takes, of all that a vertex takes.
constexpr double shadow_cost = 0.2;
/// So many light samples are taken to arrive. By what arrived in each cube those were missed that do where few do.
constexpr double arriving = 0.25;
constexpr double max_factor = 1e30;

/// Calls f(record, how many of its path's come after it, square of its pixel's brightness) for all of a part.
template <class F>
void for_records(const PathsMet::Part& part, std::size_t samples, const F& f)
{
    auto at = part.records->surfaces.begin();
    std::size_t path = 0;
    for (const std::uint8_t count : part.records->counts) {
        const double square = part.brightness_squares[path++ / samples];
        for (int after = count - 1; after >= 0; --after, ++at) f(*at, after, square);
    }
}

/// By cube: sums of the squares of what light samples brought, beside the brightness of pixels, of one over the squares
/// of that brightness, and their number.
struct LightSums {
    std::vector<double> squares, weights, counts;

    explicit LightSums(std::size_t cubes) : squares(cubes), weights(cubes), counts(cubes) {}
    void add(const LightSums& o)
    {
        for (std::size_t i = 0; i < squares.size(); ++i)
            squares[i] += o.squares[i], weights[i] += o.weights[i], counts[i] += o.counts[i];
    }
};

LightSums light_sums(const PathsMet& met, const GuidingTables& tables)
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

/// By cube, `factor` times the root of the mean of what was summed; where little is known it is more that of all cubes.
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

/// The vertices of a path over its noise and the share of a vertex that something takes.
double time_over_noise(const PathsMet& met, double cost)
{
    return met.variance > 0 ? met.vertices / (cost * met.variance) : 0;
}

/// By region, of paths that went on: sums of the squares of what they brought, beside the brightness of their pixels,
/// and of what they took, and their number.
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

PathSums path_sums(const PathsMet& met, const GuidingTables& tables)
{
    const std::size_t regions = tables.histograms.size() / guiding_stride;
    return deterministic_reduce(met.parts.size(), PathSums(regions), [&](std::size_t part, PathSums& sums) {
        for_records(met.parts[part], met.samples, [&](const GuidingRecord& r, int after, double square) {
            if (r.bin == GuidingRecord::no_bin) return;
            const std::uint32_t region = tables.regions[place_of(r, tables)];
            if (region == no_index) return;
            const double brought = std::min(double(r.value), tables.max_value) / std::numbers::pi;
            if (square > 0) sums.squares[region] += brought * brought / square;
            sums.costs[region] += after + miss_cost;
            ++sums.counts[region];
        });
    });
}

}  // namespace

void set_nee_factors(const PathsMet& met, GuidingTables& tables)
{
    const LightSums sums = light_sums(met, tables);
    const double factor = light_caution * std::sqrt(time_over_noise(met, light_cost));
    tables.nee_factors = roots_of_means(sums.squares, sums.counts, factor);
}

void set_shadow_ray_factors(const PathsMet& met, GuidingTables& tables)
{
    const LightSums sums = light_sums(met, tables);
    const double factor = std::sqrt(arriving * time_over_noise(met, shadow_cost));
    tables.shadow_ray_factors = roots_of_means(sums.weights, sums.counts, factor);
}

void set_survival_factors(const PathsMet& met, GuidingTables& tables)
{
    PathSums sums = path_sums(met, tables);
    share_with_neighbors(tables, sums.counts, 1, sums.squares);
    share_with_neighbors(tables, sums.counts, 1, sums.costs);
    const double scale = met.variance > 0 ? (met.vertices + miss_cost) / met.variance : 0;
    tables.survival_factors.resize(sums.counts.size());
    for (std::size_t i = 0; i < sums.counts.size(); ++i) {
        // Of a region of which these paths tell nothing: on.
        const double ratio = sums.costs[i] > 0 ? sums.squares[i] / sums.costs[i] : max_factor;
        tables.survival_factors[i] = float(std::min(path_caution * std::sqrt(ratio * scale), max_factor));
    }
}

}  // namespace fathom
