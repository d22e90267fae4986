#include "session/light_needs.h"

#include <algorithm>
#include <cmath>

#include "session/sum_of_groups.h"

namespace fathom {

namespace {

/// What is known of a cube counts beside so many samples of the mean of all.
constexpr double samples_of_mean = 32;
/// Chances are so many times those of the rule: samples of lights are spread evenly, which chance undoes.
constexpr double caution = 1.5;

/// By cube: sums of the squares of what light samples brought, beside the brightness of pixels, and their number.
struct Sums {
    std::vector<double> squares, counts;

    explicit Sums(std::size_t cubes) : squares(cubes), counts(cubes) {}
    void add(const Sums& o)
    {
        for (std::size_t i = 0; i < squares.size(); ++i) squares[i] += o.squares[i], counts[i] += o.counts[i];
    }
};

/// Adds what paths number `path` and on met.
void add_part(const GuidingRecords& part, std::size_t path, const PathsMet& met, const GuidingTables& tables,
              Sums& sums)
{
    auto at = part.surfaces.begin();
    for (const std::uint8_t count : part.counts) {
        const double square = met.brightness_squares[path++ / met.samples];
        for (int i = 0; i < count; ++i, ++at) {
            const std::size_t cube = guiding_cube(tables, at->position);
            if (square > 0) sums.squares[cube] += double(at->light) * double(at->light) / square;
            sums.counts[cube] += 1;
        }
    }
}

Sums sums_by_cube(const PathsMet& met, const GuidingTables& tables)
{
    const std::size_t cubes = std::size_t(tables.cells[0]) * tables.cells[1] * tables.cells[2];
    std::vector<std::size_t> first(met.parts.size() + 1);
    for (std::size_t i = 0; i < met.parts.size(); ++i) first[i + 1] = first[i] + met.parts[i]->counts.size();
    return sum_of_groups(met.parts.size(), Sums(cubes), [&](std::size_t part, Sums& sums) {
        add_part(*met.parts[part], first[part], met, tables, sums);
    });
}

}  // namespace

void set_light_needs(const PathsMet& met, GuidingTables& tables)
{
    const Sums sums = sums_by_cube(met, tables);
    double all = 0, count = 0;
    for (double x : sums.squares) all += x;
    for (double n : sums.counts) count += n;
    const double mean = all / std::max(count, 1.0);
    const double scale = met.variance > 0 ? met.vertices / (light_cost * met.variance) : 0;
    tables.light_needs.resize(sums.counts.size());
    for (std::size_t i = 0; i < sums.counts.size(); ++i) {
        const double square = (sums.squares[i] + samples_of_mean * mean) / (sums.counts[i] + samples_of_mean);
        tables.light_needs[i] = float(std::min(caution * std::sqrt(square * scale), 1e30));
    }
}

}  // namespace fathom
