// SPDX-License-Identifier: Apache-2.0
#include "session/profile_sums.h"

#include <algorithm>
#include <cmath>

#include "session/objects_of_shapes.h"

namespace fathom {

namespace {

constexpr std::size_t sets = std::size_t(profile_sets), channel_count = 3;
/// Addend of the squared radiance in relative errors, as in the error that renders report.
constexpr double relative_floor = 0.01;

/// Mean radiance of a pixel in each set, and the variances that follow from it.
struct SetMeans {
    std::array<std::array<double, channel_count>, sets> value{};

    double mean(std::size_t channel) const
    {
        double sum = 0;
        for (const auto& set : value) sum += set[channel];
        return sum / double(sets);
    }
};

/// Covariance of the mean of all sets, by all of them and without each one.
struct Covariance {
    double all = 0;
    std::array<double, sets> without{};
};

Covariance covariance(const SetMeans& a, const SetMeans& b, std::size_t channel)
{
    constexpr double n = double(sets);
    const double mean_a = a.mean(channel), mean_b = b.mean(channel);
    std::array<double, sets> products{};
    double sum = 0;
    for (std::size_t s = 0; s < sets; ++s)
        sum += products[s] = (a.value[s][channel] - mean_a) * (b.value[s][channel] - mean_b);
    Covariance result;
    result.all = sum / (n - 1) / n;
    // Leaving out set s moves both means, which lowers the sum of products by n / (n - 1) times its own product.
    for (std::size_t s = 0; s < sets; ++s) result.without[s] = (sum - products[s] * n / (n - 1)) / (n - 2) / n;
    return result;
}

/// Numbers the keys of a tile's rows from 0.
class KeyNumbers {
public:
    std::size_t number(const ProfileKey& key)
    {
        const auto [at, is_new] = numbers_.try_emplace(key, keys_.size());
        if (is_new) keys_.push_back(key);
        return at->second;
    }
    const std::vector<ProfileKey>& keys() const { return keys_; }

private:
    std::map<ProfileKey, std::size_t> numbers_;
    std::vector<ProfileKey> keys_;
};

/// A contribution in terms of rows.
struct RowContribution {
    std::size_t pixel, set;
    std::array<std::size_t, profile_table_count> rows;
    std::array<float, channel_count> value;
};

bool is_finite(const float* value)
{
    return std::isfinite(value[0]) && std::isfinite(value[1]) && std::isfinite(value[2]);
}

/// Adds the noise of one pixel to the rows of a table that have light there.
class PixelRows {
public:
    void add(std::size_t row, std::size_t set, const std::array<float, channel_count>& value, double scale)
    {
        if (row >= slots_.size()) slots_.resize(row + 1, none);
        if (slots_[row] == none) {
            slots_[row] = used_.size();
            used_.push_back({row, {}});
        }
        for (std::size_t c = 0; c < channel_count; ++c)
            used_[slots_[row]].means.value[set][c] += double(value[c]) * scale;
    }
    template <class F>
    void finish(const F& f)
    {
        for (const Used& u : used_) {
            f(u.row, u.means);
            slots_[u.row] = none;
        }
        used_.clear();
    }

private:
    static constexpr std::size_t none = ~std::size_t(0);
    struct Used {
        std::size_t row;
        SetMeans means;
    };
    std::vector<std::size_t> slots_;
    std::vector<Used> used_;
};

/// Noise and light of a row in one pixel. all: light of the whole samples; weights: of squared errors, by channel.
ProfileSums sums_of(const SetMeans& means, const SetMeans& all, const std::array<double, channel_count>& weights)
{
    ProfileSums sums;
    for (std::size_t c = 0; c < channel_count; ++c) {
        const Covariance v = covariance(means, all, c);
        sums.noise += weights[c] * v.all;
        for (std::size_t s = 0; s < sets; ++s) sums.without[s] += weights[c] * v.without[s];
        sums.light += means.mean(c);
    }
    return sums;
}

/// The tile's contributions, pixel by pixel, with rows as numbers.
std::vector<RowContribution> number_contributions(const ProfileNames& names,
                                                  const std::array<PathProfile, sets>& profiles, int set_samples,
                                                  std::array<KeyNumbers, profile_table_count>& numbers)
{
    std::vector<RowContribution> all;
    for (std::size_t set = 0; set < sets; ++set)
        for (const PathContribution& c : profiles[set].contributions) {
            if (!is_finite(c.value)) continue;
            const ProfileNames::Keys keys = names.keys_of(c);
            RowContribution r{c.path / std::uint32_t(set_samples), set, {}, {c.value[0], c.value[1], c.value[2]}};
            for (std::size_t t = 0; t < keys.size(); ++t) r.rows[t] = numbers[t].number(keys[t]);
            all.push_back(r);
        }
    std::stable_sort(all.begin(), all.end(),
                     [](const RowContribution& a, const RowContribution& b) { return a.pixel < b.pixel; });
    return all;
}

void add_noise(const ProfileNames& names, const std::array<PathProfile, sets>& profiles, int set_samples,
               ProfileTileSums& tile)
{
    std::array<KeyNumbers, profile_table_count> numbers;
    const std::vector<RowContribution> all = number_contributions(names, profiles, set_samples, numbers);
    std::array<std::vector<ProfileSums>, profile_table_count> rows;
    for (std::size_t t = 0; t < rows.size(); ++t) rows[t].resize(numbers[t].keys().size());
    std::array<PixelRows, profile_table_count> tables;
    const double scale = 1 / double(set_samples);
    for (auto at = all.begin(); at != all.end();) {
        const std::size_t pixel = at->pixel;
        SetMeans whole;
        for (; at != all.end() && at->pixel == pixel; ++at) {
            for (std::size_t c = 0; c < channel_count; ++c) whole.value[at->set][c] += double(at->value[c]) * scale;
            for (std::size_t t = 0; t < tables.size(); ++t) tables[t].add(at->rows[t], at->set, at->value, scale);
        }
        ProfilePixel& result = tile.pixels[pixel];
        std::array<double, channel_count> weights{};
        for (std::size_t c = 0; c < channel_count; ++c) {
            result.mean[c] = whole.mean(c);
            weights[c] = 1 / ((result.mean[c] * result.mean[c] + relative_floor) * double(channel_count));
        }
        const ProfileSums sums = sums_of(whole, whole, weights);
        result.noise = sums.noise;
        tile.total.add(sums);
        for (std::size_t t = 0; t < tables.size(); ++t)
            tables[t].finish(
                [&](std::size_t row, const SetMeans& means) { rows[t][row].add(sums_of(means, whole, weights)); });
    }
    for (std::size_t t = 0; t < rows.size(); ++t)
        for (std::size_t row = 0; row < rows[t].size(); ++row) tile.tables[t][numbers[t].keys()[row]].add(rows[t][row]);
}

void add_work(const ProfileNames& names, const PathProfile& profile, int set_samples, ProfileTileSums& tile)
{
    for (const PathCost& cost : profile.costs) {
        ProfileSums work;
        work.nanoseconds = double(cost.nanoseconds);
        work.shadow_rays = cost.shadow_rays, work.rays = std::uint64_t(cost.rays) + cost.shadow_rays;
        tile.total.add(work);
        tile.pixels[cost.path / std::uint32_t(set_samples)].nanoseconds += work.nanoseconds;
        const ProfileNames::Keys keys = names.keys_of(cost);
        for (std::size_t t = 0; t < keys.size(); ++t)
            if (ProfileTable(t) != ProfileTable::lights && ProfileTable(t) != ProfileTable::combinations)
                tile.tables[t][keys[t]].add(work);
        auto& lights = tile.tables[std::size_t(ProfileTable::lights)];
        ProfileSums shadow;
        if (cost.shadow_rays > 0) {
            shadow.nanoseconds = double(cost.shadow_nanoseconds), shadow.rays = shadow.shadow_rays = cost.shadow_rays;
            lights[names.light_key(cost.light)].add(shadow);
        }
        ProfileSums rest = work;
        rest.nanoseconds -= shadow.nanoseconds, rest.rays -= shadow.rays, rest.shadow_rays = 0;
        lights[{ProfileCause::no_light, 0}].add(rest);
    }
}

}  // namespace

void ProfileSums::add(const ProfileSums& o)
{
    noise += o.noise, light += o.light, nanoseconds += o.nanoseconds;
    rays += o.rays, shadow_rays += o.shadow_rays;
    for (std::size_t s = 0; s < sets; ++s) without[s] += o.without[s];
}

ProfileNames::ProfileNames(const SceneTables& tables, const std::vector<SceneObject>& objects)
    : tables_(tables), object_of_shape_(objects_of_shapes(objects)), objects_(objects.size())
{
}

ProfileKey ProfileNames::emitter_key(std::uint32_t object) const
{
    return {ProfileCause::emitter, instance_of(object_of_shape_, object, objects_) - 1};
}

ProfileKey ProfileNames::light_key(std::uint32_t light) const
{
    const LightRecord& record = tables_.lights[light];
    if (record.primitive != no_index)
        return emitter_key(record.instance != no_index
                               ? tables_.instances[record.instance].object_id
                               : tables_.shapes[tables_.shape_of_primitive[record.primitive]].object_id);
    const std::size_t first = tables_.lights.size() - tables_.described_lights.size();
    const std::uint32_t described = tables_.described_lights[light - first];
    if (described == no_index) return {ProfileCause::environment, 0};
    return {ProfileCause::light, described};
}

ProfileNames::Keys ProfileNames::keys_of(const PathPlace& place, ProfileKey light, bool is_sampled) const
{
    const ProfileKey material = place.material == no_index ? ProfileKey{ProfileCause::camera, 0}
                                                           : ProfileKey{ProfileCause::material, place.material};
    const ProfileKey object =
        place.object != no_index
            ? ProfileKey{ProfileCause::object, instance_of(object_of_shape_, place.object, objects_) - 1}
            : ProfileKey{place.material == no_index ? ProfileCause::camera : ProfileCause::medium, 0};
    return {light,
            material,
            object,
            {ProfileCause::path, place.word, is_sampled},
            {ProfileCause::depth, place.depth},
            {ProfileCause::combination,
             place.word,
             is_sampled,
             {light.cause, light.value},
             {material.cause, material.value}}};
}

ProfileNames::Keys ProfileNames::keys_of(const PathContribution& c) const
{
    const ProfileKey light = c.is_sampled            ? light_key(c.light)
                             : c.emitter != no_index ? emitter_key(c.emitter)
                                                     : ProfileKey{ProfileCause::environment, 0};
    return keys_of(c.place, light, c.is_sampled);
}

ProfileNames::Keys ProfileNames::keys_of(const PathCost& cost) const
{
    // Delta lobes, and the camera, have no light samples.
    const auto last = PathEvent(cost.place.word & 15);
    const bool is_sampled = cost.place.depth > 0 && last != PathEvent::mirror && last != PathEvent::refraction;
    return keys_of(cost.place, {}, is_sampled);
}

ProfileTileSums sum_profile(const ProfileNames& names, const std::array<PathProfile, profile_sets>& profiles,
                            std::size_t pixels, int set_samples)
{
    ProfileTileSums tile;
    tile.pixels.resize(pixels);
    add_noise(names, profiles, set_samples, tile);
    for (const PathProfile& profile : profiles) add_work(names, profile, set_samples, tile);
    return tile;
}

}  // namespace fathom
