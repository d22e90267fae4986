// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <ctime>
#include <vector>

#include "kernel/path_profile.h"
#include "kernel/pool.h"
#include "kernel/tables.h"
#include "materials/closures/records.h"

namespace fathom {
inline namespace FATHOM_LANES {

/// Records what the paths of a job contribute and cost, for profiles. Contributions are differences of
/// PathPool::radiance between stages, so they add up to the radiance of each path.
class PathProfiler {
public:
    /// to: receives the records; nullptr disables them. paths: number of paths, numbered from 0.
    PathProfiler(PathProfile* to, const SceneTables& tables, std::size_t paths) : to_(to), tables_(tables)
    {
        if (!to_) return;
        states_.resize(paths);
        last_ = nanoseconds();
    }
    bool is_on() const { return to_ != nullptr; }

    /// Charges the time since the last charge to the paths [begin, end) of the pool.
    void charge(const PathPool& p, std::size_t begin, std::size_t end)
    {
        const std::uint64_t now = nanoseconds();
        const float each = end > begin ? float(now - last_) / float(end - begin) : 0;
        for (std::size_t i = begin; i < end; ++i) state(p, i).cost.nanoseconds += each;
        last_ = nanoseconds();
    }
    /// charge() for rays that were traced.
    void charge_rays(const PathPool& p, std::size_t begin, std::size_t end)
    {
        for (std::size_t i = begin; i < end; ++i) ++state(p, i).cost.rays;
        charge(p, begin, end);
    }
    /// Charges the time since the last charge to the paths of the pool that have a shadow ray.
    void charge_shadow_rays(const PathPool& p, std::size_t active)
    {
        const std::uint64_t now = nanoseconds();
        std::size_t rays = 0;
        for (std::size_t i = 0; i < active; ++i) rays += state(p, i).has_shadow_ray;
        const float each = rays > 0 ? float(now - last_) / float(rays) : 0;
        for (std::size_t i = 0; i < active; ++i) {
            State& s = state(p, i);
            if (!s.has_shadow_ray) continue;
            s.cost.nanoseconds += each, s.cost.shadow_nanoseconds += each;
        }
        last_ = nanoseconds();
    }

    /// Kind of scattering into directions of this density, in lanes without a delta lobe. Densities of diffuse lobes
    /// are at most 1/pi; closures that have no diffuse lobe are always glossy.
    template <class Closure>
    static UInt lobe_event(Float pdf, Mask transmits)
    {
        constexpr bool has_no_diffuse_lobe = Closure::kind == ClosureKind::metal ||
                                             Closure::kind == ClosureKind::fuzz_metal ||
                                             Closure::kind == ClosureKind::glass;
        const UInt narrow = select(transmits, word_of(PathEvent::translucent), word_of(PathEvent::glossy));
        return has_no_diffuse_lobe ? narrow : select(pdf > Float(1), narrow, word_of(PathEvent::diffuse));
    }
    static UInt delta_event(Mask transmits)
    {
        return select(transmits, word_of(PathEvent::refraction), word_of(PathEvent::mirror));
    }

    /// Notes the shadow rays of the paths from number i of the pool on, and the event that their light would take.
    [[gnu::noinline]] void note_light(const PathPool& p, std::size_t i, UInt light, UInt event, Mask m)
    {
        std::uint32_t lights[lanes], events[lanes];
        store(lights, light), store(events, event);
        for_each_active(m, [&](int lane) {
            State& s = state(p, i + std::size_t(lane));
            s.light = lights[lane], s.light_event = PathEvent(events[lane]), s.has_shadow_ray = true;
        });
    }
    /// Notes how the paths leave their vertices. PathEvent::none: they continue undeflected.
    [[gnu::noinline]] void note_scattering(const PathPool& p, std::size_t i, UInt event, Mask m)
    {
        std::uint32_t events[lanes];
        store(events, event);
        for_each_active(m, [&](int lane) { state(p, i + std::size_t(lane)).next_event = PathEvent(events[lane]); });
    }

    /// Records the light samples of scattering events within media, and moves the paths there.
    void record_media(const PathPool& p, const HitColumns& hits, std::size_t active)
    {
        for (std::size_t i = 0; i < active; ++i) {
            if (!(hits.t[i] < 0)) continue;
            State& s = state(p, i);
            flush(p.number[i], s);
            s.place = {material_of_medium(p.media.low[i] & 0xffffu), no_index, s.place.depth + 1,
                       append_event(s.place.word, PathEvent::volume)};
            record_difference(p, i, {.is_sampled = true, .light = s.light, .place = s.place});
            count_shadow_ray(s);
        }
    }
    /// Records emission that the rays of the pool have met.
    void record_emission(const PathPool& p, const HitColumns& hits, bool is_flat, std::size_t active)
    {
        for (std::size_t i = 0; i < active; ++i)
            if (differs(p, i)) {
                const bool hit = hits.primitive[i] != no_index;
                record_difference(
                    p, i, {.emitter = hit ? surface(hits, is_flat, i).object : no_index, .place = state(p, i).place});
            }
    }
    /// Moves the paths of the pool to the surfaces that they are about to be scattered by.
    void arrive(const PathPool& p, const HitColumns& hits, bool is_flat, bool has_mixtures, std::size_t active)
    {
        for (std::size_t i = 0; i < active; ++i) {
            State& s = state(p, i);
            flush(p.number[i], s);
            s.before = s.place;
            const Surface at = surface(hits, is_flat, i);
            s.place.material = has_mixtures && hits.material[i] != no_index ? hits.material[i] : at.material;
            s.place.object = at.object;
            s.light_event = s.next_event = PathEvent::none;
        }
    }
    /// Records the light samples of the surfaces that have scattered the paths.
    void record_light_samples(const PathPool& p, std::size_t active)
    {
        for (std::size_t i = 0; i < active; ++i) {
            State& s = state(p, i);
            if (differs(p, i)) {
                PathPlace place = s.place;
                place.word = append_event(place.word, s.light_event), ++place.depth;
                record_difference(p, i, {.is_sampled = true, .light = s.light, .place = place});
            }
            count_shadow_ray(s);
            if (s.next_event != PathEvent::none) {
                s.place.word = append_event(s.place.word, s.next_event), ++s.place.depth;
            } else {
                flush(p.number[i], s);
                s.place = s.before;
            }
        }
    }
    /// Records the work of a path that has ended.
    void end_path(std::uint32_t number) { flush(number, states_[number]); }

private:
    struct State {
        PathPlace place, before;  ///< where the path is, and where it was before its last surface
        PathCost cost;            ///< since it is there
        float radiance[3] = {};   ///< PathPool::radiance that is recorded so far
        PathEvent light_event = PathEvent::none, next_event = PathEvent::none;
        bool has_shadow_ray = false;     ///< for a light sample that is not recorded yet
        std::uint32_t light = no_index;  ///< of the last light sample
    };
    struct Surface {
        std::uint32_t material, object;
    };

    /// Processor time of this thread. In contrast to time stamps it excludes interruptions by other programs.
    static std::uint64_t nanoseconds()
    {
        timespec now{};
        clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
        return std::uint64_t(now.tv_sec) * 1'000'000'000 + std::uint64_t(now.tv_nsec);
    }

    static UInt word_of(PathEvent event) { return UInt(std::uint32_t(event)); }
    State& state(const PathPool& p, std::size_t i) { return states_[p.number[i]]; }

    bool differs(const PathPool& p, std::size_t i)
    {
        const float* const before = state(p, i).radiance;
        return p.radiance.c[0][i] != before[0] || p.radiance.c[1][i] != before[1] || p.radiance.c[2][i] != before[2];
    }
    void record_difference(const PathPool& p, std::size_t i, PathContribution contribution)
    {
        if (!differs(p, i)) return;
        contribution.path = p.number[i];
        float* const before = state(p, i).radiance;
        for (int c = 0; c < channels; ++c) {
            contribution.value[c] = p.radiance.c[c][i] - before[c];
            before[c] = p.radiance.c[c][i];
        }
        to_->contributions.push_back(contribution);
    }
    static void count_shadow_ray(State& s)
    {
        if (!s.has_shadow_ray) return;
        s.cost.light = s.light, ++s.cost.shadow_rays;
        s.has_shadow_ray = false;
    }
    void flush(std::uint32_t number, State& s)
    {
        s.cost.path = number, s.cost.place = s.place;
        to_->costs.push_back(s.cost);
        s.cost = {};
    }

    Surface surface(const HitColumns& hits, bool is_flat, std::size_t i) const
    {
        if (!is_flat && hits.instance[i] != no_index) {
            const InstanceRecord& instance = tables_.instances[hits.instance[i]];
            return {tables_.shapes[instance.shape].material, instance.object_id};
        }
        const ShapeRecord& shape = tables_.shapes[tables_.shape_of_primitive[hits.primitive[i]]];
        return {shape.material, shape.object_id};
    }
    std::uint32_t material_of_medium(std::uint32_t medium) const
    {
        for (std::size_t k = 0; k < tables_.materials.size(); ++k)
            if (tables_.materials[k].medium == medium || tables_.materials[k].subsurface_medium == medium)
                return std::uint32_t(k);
        return no_index;
    }

    PathProfile* to_;
    const SceneTables& tables_;
    std::vector<State> states_;
    std::uint64_t last_ = 0;
};

}  // namespace FATHOM_LANES
}  // namespace fathom
