// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>

#include "session/deterministic_reduce.h"
#include "session/guiding_tables.h"

namespace fathom {

namespace {

/// Target for the average number of records per region, from which the cube size follows. Smaller cubes were too noisy,
/// larger ones too coarse.
constexpr double records_per_region = 2500;
/// Regions with fewer records get no distribution.
constexpr std::uint32_t min_records = 64;
/// Every n-th record is used to choose extent and size of the cubes.
constexpr std::uint32_t thinning = 16;
/// Records' values are clamped to this multiple of their mean.
constexpr double max_of_mean = 200;
/// Fraction of a bin's value that is added to each neighboring bin.
constexpr double blur = 0.1;
/// Fraction of a region's distribution that comes from the block of eight cubes around it.
constexpr double shared = 0.5;
/// Probability of uniform directions over the upper hemisphere in every distribution.
constexpr double even_share = 0.05;

/// Box that contains most records; 1/200 of them are left out at either end of each axis.
struct Extent {
    std::array<float, 3> low, high;
};
Extent extent_of(const std::vector<GuidingRecord>& records)
{
    Extent e;
    std::vector<float> along(records.size());
    for (std::size_t k = 0; k < 3; ++k) {
        for (std::size_t i = 0; i < along.size(); ++i) along[i] = records[i].position[k];
        const auto number = [&](std::size_t n) {
            std::nth_element(along.begin(), along.begin() + std::ptrdiff_t(n), along.end());
            return along[n];
        };
        const std::size_t outside = along.size() / 200;
        e.low[k] = number(outside);
        e.high[k] = number(along.size() - 1 - outside);
    }
    return e;
}

/// Divides the extent into cubes, `along` of them along its longest axis.
void set_cubes(const Extent& extent, float along, GuidingTables& t)
{
    float longest = 0;
    for (std::size_t k = 0; k < 3; ++k) longest = std::max(longest, extent.high[k] - extent.low[k]);
    const float size = std::max(longest, 1e-6f) / along;
    t.inverse_cell = 1 / size;
    for (std::size_t k = 0; k < 3; ++k) {
        t.cells[k] = std::uint32_t(std::max(1.f, std::ceil((extent.high[k] - extent.low[k]) / size)));
        t.lowest[k] = 0.5f * (extent.low[k] + extent.high[k] - float(t.cells[k]) * size);
    }
    t.regions.assign(std::size_t(t.cells[0]) * t.cells[1] * t.cells[2] * guiding_sides, no_index);
}

using Parts = std::vector<const GuidingRecords*>;

/// Calls f(record) for the records of a part that have a direction.
template <class F>
void for_directions(const GuidingRecords& part, const F& f)
{
    for (const GuidingRecord& r : part.surfaces)
        if (r.bin != GuidingRecord::no_bin) f(r);
}

/// An even subset of the records that have a direction: one in `thinning`.
std::vector<GuidingRecord> thin_out(const Parts& parts)
{
    std::vector<GuidingRecord> few;
    for (const GuidingRecords* part : parts)
        for (std::size_t i = 0; i < part->surfaces.size(); i += thinning)
            if (part->surfaces[i].bin != GuidingRecord::no_bin) few.push_back(part->surfaces[i]);
    return few;
}

/// Chooses the cube size by the number of records. few: an even subset of all records.
void choose_cubes(const std::vector<GuidingRecord>& few, GuidingTables& t)
{
    const Extent extent = extent_of(few);
    for (float along = 2; along < 64; along *= 1.25f) {
        set_cubes(extent, along, t);
        std::vector<std::uint32_t> count(t.regions.size());
        for (const GuidingRecord& r : few) ++count[region_index(r, t)];
        const auto known =
            std::count_if(count.begin(), count.end(), [](std::uint32_t n) { return n >= min_records / thinning; });
        if (double(few.size()) < records_per_region / thinning * double(known)) break;
    }
}

/// Number of records per region, and sums over all of them.
struct PlaceCounts {
    std::vector<std::uint32_t> count;
    double records = 0, values = 0;

    void add(const PlaceCounts& o)
    {
        for (std::size_t i = 0; i < count.size(); ++i) count[i] += o.count[i];
        records += o.records, values += o.values;
    }
};
PlaceCounts count_by_place(const Parts& parts, const GuidingTables& t)
{
    return deterministic_reduce(parts.size(), PlaceCounts{std::vector<std::uint32_t>(t.regions.size()), 0, 0},
                                [&](std::size_t part, PlaceCounts& sums) {
                                    for_directions(*parts[part], [&](const GuidingRecord& r) {
                                        ++sums.count[region_index(r, t)];
                                        sums.records += 1, sums.values += double(r.value);
                                    });
                                });
}

/// Assigns indices to regions with enough records; returns their numbers of records.
std::vector<std::uint32_t> number_regions(const std::vector<std::uint32_t>& count, GuidingTables& t)
{
    std::vector<std::uint32_t> known;
    for (std::size_t i = 0; i < count.size(); ++i)
        if (count[i] >= min_records) {
            t.regions[i] = std::uint32_t(known.size());
            known.push_back(count[i]);
        }
    return known;
}

/// Records' values by region and bin, and number of records by region.
struct BinSums {
    std::vector<double> bins;
    std::vector<std::uint32_t> counts;

    explicit BinSums(std::size_t regions) : bins(regions * guiding_bins), counts(regions) {}
    void add(const BinSums& o)
    {
        for (std::size_t i = 0; i < bins.size(); ++i) bins[i] += o.bins[i];
        for (std::size_t i = 0; i < counts.size(); ++i) counts[i] += o.counts[i];
    }
};
BinSums sum_by_bin(const Parts& parts, const GuidingTables& t, std::size_t regions)
{
    return deterministic_reduce(parts.size(), BinSums(regions), [&](std::size_t part, BinSums& sums) {
        for_directions(*parts[part], [&](const GuidingRecord& r) {
            const std::uint32_t region = t.regions[region_index(r, t)];
            if (region == no_index) return;
            sums.bins[std::size_t(region) * guiding_bins + r.bin] += std::min(double(r.value), t.max_value);
            ++sums.counts[region];
        });
    });
}

/// Writes the cumulative histogram of a region's bins.
void write_histogram(const double* sums, float* to)
{
    std::array<double, guiding_bins> smooth;
    double total = 0;
    for (std::uint32_t i = 0; i < guiding_bins; ++i) {
        const std::uint32_t band = i / guiding_sectors, first = band * guiding_sectors, sector = i - first;
        double sum = sums[first + (sector + 1) % guiding_sectors] +
                     sums[first + (sector + guiding_sectors - 1) % guiding_sectors];
        if (band > 0) sum += sums[i - guiding_sectors];
        if (band + 1 < guiding_bands) sum += sums[i + guiding_sectors];
        smooth[i] = sums[i] + blur * sum;
        total += smooth[i];
    }
    double cumulative = 0;
    for (std::uint32_t i = 0; i < guiding_bins; ++i) {
        to[i] = float(cumulative);
        const double even = i < guiding_bins / 2 ? 0 : 2.0 / guiding_bins;
        cumulative += total > 0 ? (1 - even_share) * smooth[i] / total + even_share * even : even;
    }
    to[guiding_bins] = 1;
}

}  // namespace

void share_with_neighbors(const GuidingTables& t, const std::vector<std::uint32_t>& counts, std::size_t stride,
                          std::vector<double>& sums)
{
    const auto half = [&](std::size_t axis) { return std::size_t(t.cells[axis] + 1) / 2; };
    const std::size_t blocks = half(0) * half(1) * half(2) * guiding_sides;
    std::vector<double> together(blocks * stride), records(blocks);
    const auto for_regions = [&](const auto& f) {
        for (std::size_t place = 0; place < t.regions.size(); ++place) {
            if (t.regions[place] == no_index) continue;
            const std::size_t cube = place / guiding_sides, side = place % guiding_sides;
            const std::size_t x = cube % t.cells[0], y = cube / t.cells[0] % t.cells[1],
                              z = cube / t.cells[0] / t.cells[1];
            const std::size_t block = ((z / 2 * half(1) + y / 2) * half(0) + x / 2) * guiding_sides + side;
            f(t.regions[place], &sums[std::size_t(t.regions[place]) * stride], block);
        }
    };
    for_regions([&](std::uint32_t region, const double* own, std::size_t block) {
        for (std::size_t i = 0; i < stride; ++i) together[block * stride + i] += own[i];
        records[block] += counts[region];
    });
    for_regions([&](std::uint32_t region, double* own, std::size_t block) {
        const double share = shared * counts[region] / std::max(records[block], 1.0);
        for (std::size_t i = 0; i < stride; ++i) own[i] = (1 - shared) * own[i] + share * together[block * stride + i];
    });
}

void learn_histograms(const Parts& parts, GuidingTables& t)
{
    const std::size_t regions = t.histograms.size() / guiding_stride;
    BinSums sums = sum_by_bin(parts, t, regions);
    share_with_neighbors(t, sums.counts, guiding_bins, sums.bins);
    for (std::size_t i = 0; i < regions; ++i)
        write_histogram(&sums.bins[i * guiding_bins], &t.histograms[i * guiding_stride]);
}

std::shared_ptr<GuidingTables> make_guiding(const std::vector<const GuidingRecords*>& parts)
{
    const std::vector<GuidingRecord> few = thin_out(parts);
    if (few.size() < min_records / thinning) return nullptr;
    auto tables = std::make_shared<GuidingTables>();
    GuidingTables& t = *tables;
    choose_cubes(few, t);
    const PlaceCounts by_place = count_by_place(parts, t);
    const std::vector<std::uint32_t> counts = number_regions(by_place.count, t);
    if (counts.empty()) return nullptr;
    t.max_value = max_of_mean * by_place.values / by_place.records;
    t.histograms.resize(counts.size() * guiding_stride);
    t.shares.resize(counts.size());
    learn_histograms(parts, t);
    return tables;
}

}  // namespace fathom
