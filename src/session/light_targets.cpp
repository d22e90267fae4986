// SPDX-License-Identifier: Apache-2.0
#include "session/light_targets.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <numbers>
#include <span>
#include <vector>

#include "lights/kinds/records.h"
#include "session/guiding.h"
#include "session/seen_photons.h"
#include "session/trial_image.h"

namespace fathom {

namespace {

/// Samples of light paths by the lights' own emission, samples aimed at what these found, and sets of camera paths for
/// the brightness of the image.
constexpr std::size_t own_samples = 32, aimed_samples = 16, camera_sets = 2;
/// Light paths have random numbers other than those of the trial.
constexpr std::size_t own_set = 1000, aimed_set = 1001;
/// Factor on the radii of what the first paths found, since they are few, and share of the second paths that is aimed.
constexpr float widening = 1.5f;
constexpr float aimed_share = 0.5f;
/// The value of a path is limited to this multiple of the mean, since the sums of few samples are uncertain.
constexpr double most_of_mean = 50;
/// Factor by which another target must reduce the estimate of the standard error of light paths, and by which all of
/// them must reduce the variance.
constexpr double most_noise = 0.9, most_variance = 0.6;
/// Shares of paths by the lights' own emission that are considered.
constexpr float own_shares[] = {0.2f, 0.4f, 0.6f};
/// Number of candidates for a target, and fractions of the arrivals that their radii contain.
constexpr std::size_t candidates = 24;
constexpr double fractions[] = {1, 0.98, 0.95, 0.9, 0.8, 0.65, 0.5, 0.35, 0.2, 0.1};
/// Numbers of rays that measure how many pass through a sphere, and of arrivals that stand for the others.
constexpr std::size_t most_rays = 4000, selected_arrivals = 2000;
/// With more lights than this, lights are selected for targets as they are otherwise.
constexpr std::size_t most_lights = 4096;

struct Point {
    double x = 0, y = 0, z = 0;

    explicit Point(const Vec3f& v) : x(double(v.x)), y(double(v.y)), z(double(v.z)) {}
    Point(double px, double py, double pz) : x(px), y(py), z(pz) {}
};
Point operator-(const Point& a, const Point& b)
{
    return {a.x - b.x, a.y - b.y, a.z - b.z};
}
double dot(const Point& a, const Point& b)
{
    return a.x * b.x + a.y * b.y + a.z * b.z;
}
double distance(const Point& a, const Point& b)
{
    return std::sqrt(dot(a - b, a - b));
}

/// A light path at its first surface.
struct Arrival {
    Point p, d;
    double distance;  ///< from the light
    double own_pdf;   ///< LightArrival::own_pdf
    std::uint32_t light;
    /// Squares of what the path would bring by its light's own emission, relative to the brightness of the pixels, per
    /// path that was traced.
    double value;
    double weight;  ///< density by the light's own emission divided by that with which the path was traced

    bool passes(const Point& center, double radius2) const
    {
        // Before the surface, or behind it: an aimed path passes both.
        const Point to = center - p;
        const double along = dot(to, d);
        return dot(to, to) - along * along <= radius2 && along >= -distance;
    }
};

struct Ball {
    Point center{0, 0, 0};
    double radius = 0;

    bool contains(const Point& p) const
    {
        const Point to = p - center;
        return dot(to, to) <= radius * radius;
    }
};

/// Light paths that were traced for learning, and the values of the places where they arrived.
class LearnedPaths {
public:
    /// paths: number of light paths that were traced
    LearnedPaths(std::vector<Arrival> arrivals, double paths) : arrivals_(std::move(arrivals)), paths_(paths)
    {
        double sum = 0, count = 0;
        for (const Arrival& a : arrivals_) sum += a.value, count += a.value > 0 ? 1 : 0;
        double rest = 0;
        for (Arrival& a : arrivals_) rest += a.value = std::min(a.value, most_of_mean * sum / std::max(count, 1.0));
        // Each of the selected arrivals stands for the same part of the value.
        part_ = rest / double(selected_arrivals);
        double running = 0;
        for (const Arrival& a : arrivals_) {
            running += a.value;
            for (; running >= (double(selected_) + 0.5) * part_ && selected_ < selected_arrivals; ++selected_)
                if (a.value > 0) places_.push_back(a.p);
        }
        ray_step_ = arrivals_.size() / most_rays + 1;
    }
    const std::vector<Arrival>& arrivals() const { return arrivals_; }
    /// Places of arrivals, distributed by their value, that no target contains yet.
    const std::vector<Point>& places() const { return places_; }

    /// Sum of the values that remain, or of those within a ball.
    double value() const { return double(places_.size()) * part_; }
    double value_within(const Ball& ball) const
    {
        return double(std::count_if(places_.begin(), places_.end(), [&](const Point& p) { return ball.contains(p); })) *
               part_;
    }
    /// Fraction of the paths by the lights' own emission that pass through a ball.
    double share_through(const Ball& ball) const
    {
        double sum = 1e-3;
        for (std::size_t i = 0; i < arrivals_.size(); i += ray_step_)
            if (arrivals_[i].passes(ball.center, ball.radius * ball.radius)) sum += arrivals_[i].weight;
        return std::min(sum * double(ray_step_) / paths_, 1.0);
    }
    void remove(const Ball& ball)
    {
        std::erase_if(places_, [&](const Point& p) { return ball.contains(p); });
    }

private:
    std::vector<Arrival> arrivals_;
    double paths_, part_ = 0;
    std::size_t ray_step_ = 1, selected_ = 0;
    std::vector<Point> places_;
};

/// A ball of paths, with the sum of their values and their share of all paths. If paths are spread over several balls,
/// the noise is least with a number of paths for each that is proportional to the root of value times share.
struct LearnedTarget {
    Ball ball;
    double value = 0, share = 0;

    double weight() const { return std::sqrt(value * share); }
};

/// A ball that just contains the arrivals within a ball.
Ball tightened(const LearnedPaths& paths, const Ball& ball)
{
    constexpr double infinity = std::numeric_limits<double>::infinity();
    Point low(infinity, infinity, infinity), high(-infinity, -infinity, -infinity);
    for (const Point& p : paths.places()) {
        if (!ball.contains(p)) continue;
        low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
        high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
    }
    Ball tight{{(low.x + high.x) / 2, (low.y + high.y) / 2, (low.z + high.z) / 2}, 0};
    for (const Point& p : paths.places())
        if (ball.contains(p)) tight.radius = std::max(tight.radius, distance(p, tight.center));
    // A margin for what these few paths have not met.
    tight.radius = std::min(tight.radius * 1.1 + 1e-3 * ball.radius, ball.radius);
    return tight;
}

/// The ball that reduces noise most; value 0 if none does. A ball's center is an arrival, its radius such that it
/// contains a certain number of arrivals.
LearnedTarget best_target(const LearnedPaths& paths)
{
    const std::vector<Point>& places = paths.places();
    LearnedTarget best;
    const double all = paths.value();
    double least = std::sqrt(all);
    std::vector<double> distances(places.size());
    for (std::size_t i = 0; i < candidates && !places.empty(); ++i) {
        const Point& center = places[(2 * i + 1) * places.size() / (2 * candidates)];
        std::transform(places.begin(), places.end(), distances.begin(),
                       [&](const Point& p) { return distance(p, center); });
        std::sort(distances.begin(), distances.end());
        for (const double fraction : fractions) {
            const double radius = distances[std::size_t(fraction * double(distances.size() - 1))] * 1.0001;
            LearnedTarget t;
            t.ball = tightened(paths, {center, radius});
            t.value = paths.value_within(t.ball);
            const double rest = std::sqrt(std::max(all - t.value, 0.0));
            if (!(t.ball.radius > 0) || rest >= least) continue;
            t.share = paths.share_through(t.ball);
            if (t.weight() + rest < least) least = t.weight() + rest, best = t;
        }
    }
    return best;
}

/// The rays of a beam start at any of its points, in one direction.
bool can_be_aimed(const LightRecord& light)
{
    return light.kind != std::uint32_t(LightRecordKind::beam) && light.pmf > 0;
}

/// Fills LightTargets::light_cdf and light_ratios: half of the paths of a target select lights by their power, half by
/// what they brought when they came there.
void set_lights(LightTargets& to, const LearnedPaths& paths, const std::vector<LearnedTarget>& targets,
                const LightTables& tables)
{
    const std::size_t count = tables.lights.size();
    to.light_cdf = tables.light_cdf;
    for (const LearnedTarget& target : targets) {
        std::vector<double> value(count), arrived(count), weight(count);
        for (const Arrival& a : paths.arrivals()) {
            if (!target.ball.contains(a.p)) continue;
            value[a.light] += a.value, arrived[a.light] += a.weight;
        }
        double learned = 0, power = 0;
        for (std::size_t l = 0; l < count; ++l) {
            if (!can_be_aimed(tables.lights[l])) continue;
            weight[l] = count > most_lights ? 0 : std::sqrt(value[l] * arrived[l]);
            learned += weight[l], power += double(tables.lights[l].pmf);
        }
        double running = 0;
        std::vector<double> ends(count);
        for (std::size_t l = 0; l < count; ++l) {
            const double by_power = can_be_aimed(tables.lights[l]) ? double(tables.lights[l].pmf) / power : 0;
            running += learned > 0 ? 0.5 * (by_power + weight[l] / learned) : by_power;
            ends[l] = running;
        }
        const std::size_t row = to.light_cdf.size();
        to.light_cdf.push_back(0);
        for (std::size_t l = 0; l < count; ++l) {
            to.light_cdf.push_back(l + 1 == count ? 1.f : float(ends[l] / running));
            const float probability = to.light_cdf[row + l + 1] - to.light_cdf[row + l], pmf = tables.lights[l].pmf;
            to.light_ratios.push_back(pmf > 0 ? probability / pmf : 0.f);
        }
    }
}

std::vector<LearnedTarget> find_targets(LearnedPaths& paths)
{
    std::vector<LearnedTarget> targets;
    double sum = 0;
    while (targets.size() < LightTargets::max_targets) {
        const double rest = paths.value(), before = sum + std::sqrt(rest);
        const LearnedTarget target = best_target(paths);
        if (!(target.value > 0)) break;
        const double after = sum + target.weight() + std::sqrt(std::max(rest - target.value, 0.0));
        if (after > most_noise * before) break;
        targets.push_back(target);
        sum += target.weight();
        paths.remove(target.ball);
    }
    return targets;
}

/// Sets the shares of light paths: `own` of them follow the lights' own emission.
void set_shares(LightTargets& to, const std::vector<LearnedTarget>& targets, float own)
{
    double sum = 0;
    for (const LearnedTarget& t : targets) sum += t.weight();
    to.own_share = own;
    for (std::size_t k = 0; k < targets.size(); ++k) to.targets[k].share = float(targets[k].weight() / sum) * (1 - own);
}

/// Density with which aimed light paths come to an arrival, divided by that of paths by the lights' own emission: as
/// LightAiming has it.
double density_ratio(const LightTargets& targets, const Arrival& a, const LightTables& lights)
{
    const auto kind = LightRecordKind(lights.lights[a.light].kind);
    const bool is_infinite = kind == LightRecordKind::environment || kind == LightRecordKind::directional;
    double ratio = double(targets.own_share);
    for (std::size_t k = 0; k < targets.targets.size(); ++k) {
        const LightTargets::Target& t = targets.targets[k];
        const Point center(double(t.center[0]), double(t.center[1]), double(t.center[2]));
        const double radius2 = double(t.radius) * double(t.radius);
        if (!a.passes(center, radius2)) continue;
        const double share = double(t.share) * double(targets.light_ratios[k * lights.lights.size() + a.light]);
        const double away =
            distance(center, {a.p.x - a.d.x * a.distance, a.p.y - a.d.y * a.distance, a.p.z - a.d.z * a.distance});
        const double sin2 = radius2 / (away * away);
        const double spread = sin2 < 1 ? sin2 / (1 + std::sqrt(1 - sin2)) : 2;
        ratio += is_infinite ? share * double(lights.ball_radius) * double(lights.ball_radius) / radius2
                             : share / (2 * std::numbers::pi * spread * std::max(a.own_pdf, 1e-30));
    }
    return ratio;
}

/// Estimate of the second moment of aimed light paths relative to that of paths by the lights' own emission.
double relative_variance(const LightTargets& targets, const LearnedPaths& paths, const LightTables& lights)
{
    double own = 0, aimed = 0;
    for (const Arrival& a : paths.arrivals()) {
        if (!(a.value > 0)) continue;
        own += a.value;
        aimed += a.value / density_ratio(targets, a, lights);
    }
    return aimed / own;
}

/// Squared brightness of the image's pixels, with what light paths brought.
std::vector<double> pixel_squares(const KernelScene& scene, const CameraRecord& camera, const TrialImage& image,
                                  const LightSamples& light, const std::atomic<bool>* cancel)
{
    std::vector<PixelVariance> bright = trace_camera_paths(scene, camera, image, camera_sets, cancel).pixels;
    for (const LightPathResults& job : light.jobs)
        for (const LightSplat& splat : job.splats)
            if (std::isfinite(brightness(splat.value)))
                bright[image.index(splat.pixel)].mean += brightness(splat.value) / double(own_samples);
    return squared_brightness(bright);
}

/// targets: those of the light paths
LearnedPaths learned_paths(const LightSamples& light, std::size_t samples, const TrialImage& image,
                           const std::vector<double>& squares, const LightTargets* targets, const LightTables& lights)
{
    std::vector<Arrival> arrivals;
    std::vector<double> values;
    for (std::size_t first = 0; first < light.jobs.size(); first += light.jobs_per_sample) {
        values.assign(image.settings.light_paths, 0);
        const auto end = first + light.jobs_per_sample;
        for (std::size_t j = first; j < end; ++j)
            for (const LightSplat& splat : light.jobs[j].splats) {
                const double value = brightness(splat.value), square = squares[image.index(splat.pixel)];
                if (std::isfinite(value) && square > 0) values[splat.path] += value * value / square;
            }
        for (std::size_t j = first; j < end; ++j)
            for (const LightArrival& a : light.jobs[j].arrivals) {
                Arrival& arrival = arrivals.emplace_back(Arrival{Point(a.position), Point(a.direction),
                                                                 double(a.distance), double(a.own_pdf), a.light, 0, 1});
                const double ratio = targets ? density_ratio(*targets, arrival, lights) : 1;
                arrival.value = values[a.path] * ratio, arrival.weight = 1 / ratio;
            }
    }
    return {std::move(arrivals), double(image.settings.light_paths) * double(samples)};
}

/// The targets that the paths show, with the best share of own emission of those given; nullptr if they do not reduce
/// the variance to `most` of that without targets.
std::unique_ptr<LightTargets> choose_targets(LearnedPaths paths, const LightTables& lights,
                                             std::span<const float> own_shares, double most)
{
    const std::vector<LearnedTarget> targets = find_targets(paths);
    if (targets.empty()) return nullptr;
    auto result = std::make_unique<LightTargets>();
    for (const LearnedTarget& t : targets)
        result->targets.push_back(
            {{float(t.ball.center.x), float(t.ball.center.y), float(t.ball.center.z)}, float(t.ball.radius), 0});
    set_lights(*result, paths, targets, lights);
    float best = 0;
    for (const float own : own_shares) {
        set_shares(*result, targets, own);
        if (const double variance = relative_variance(*result, paths, lights); variance < most)
            most = variance, best = own;
    }
    if (best == 0) return nullptr;
    set_shares(*result, targets, best);
    return result;
}

}  // namespace

std::unique_ptr<const LightTargets> learn_light_targets(const KernelScene& scene, const LightTables& lights,
                                                        const CameraRecord& camera, const KernelSettings& settings,
                                                        bool gathers, const std::atomic<bool>* cancel)
{
    if (std::none_of(lights.lights.begin(), lights.lights.end(), can_be_aimed)) return nullptr;
    TrialImage image(settings);
    const auto trace = [&](std::size_t set, std::size_t samples) {
        LightPathResults wanted;
        wanted.records_arrivals = true, wanted.records_photons = gathers;
        LightSamples light = trace_light_samples(scene, camera, image, set, samples, wanted, cancel);
        if (cancel && *cancel) throw Cancelled();
        add_seen_photons(light, camera, image);
        return light;
    };
    const LightSamples own = trace(own_set, own_samples);
    const std::vector<double> squares = pixel_squares(scene, camera, image, own, cancel);
    const float half[] = {1 - aimed_share};
    const std::unique_ptr<LightTargets> found =
        choose_targets(learned_paths(own, own_samples, image, squares, nullptr, lights), lights, half, 1);
    if (!found) return nullptr;
    // Few of these paths came to small objects. Paths that are aimed at what was found show all of it.
    for (LightTargets::Target& t : found->targets) t.radius *= widening;
    image.settings.light_targets = found.get();
    const LightSamples aimed = trace(aimed_set, aimed_samples);
    return choose_targets(learned_paths(aimed, aimed_samples, image, squares, found.get(), lights), lights, own_shares,
                          most_variance);
}

}  // namespace fathom
