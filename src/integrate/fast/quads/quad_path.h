// SPDX-License-Identifier: Apache-2.0
#pragma once
/// The path loop for flat scenes of quads, such as boxes and rooms: the same estimator as PathTracer's, in fewer
/// instructions.
///
///     start ─┬─▶ arrive ─▶ pool ─▶ light, next direction ─┐
///            └───────────────────◀───────────────────────┘
///
/// The next hit is found while the state of a path is still in registers, and only paths that continue are stored. All
/// state fits into the first-level cache. Most quads of such scenes are plain: smooth, diffuse, of one color. Paths on
/// other quads are kept in separate pools, so that closures run on full gangs (quad_closures.h).
#include <utility>

#include "integrate/fast/quads/ended_paths.h"
#include "integrate/fast/quads/quad_closures.h"
#include "integrate/fast/quads/quad_pool.h"
#include "integrate/stages/first_hits.h"

namespace fathom {
inline namespace FATHOM_LANES {

/// all_plain: whether all quads are plain.
template <bool all_plain>
class QuadTracer {
public:
    QuadTracer(const LaneScene& scene, const CameraRecord& camera, const KernelSettings& settings, const KernelJob& job,
               TileSums& sums, KernelCounters& counters)
        : scene_(scene),
          tables_(scene.tables),
          settings_(settings),
          lights_(scene, settings.light_selection, false),
          camera_paths_(scene, camera, settings, job),
          first_hits_(scene, camera, settings.aovs, sums),
          ended_(sums),
          counters_(counters),
          clock_(counters, settings.measure),
          closures_(scene, clock_)
    {
        lights_are_sampled_ = settings.light_sampling && !tables_.lights.empty();
        sees_background_ = scene.has(Feature::environment) || settings.background.given;
        for (std::uint32_t kind = 0; kind < closure_kind_count && !all_plain; ++kind)
            if (scene.closures.has(ClosureKind(kind)))
                others_[other_kinds_].kind = kind, others_[other_kinds_++].end = 0;
    }

    /// Traces all paths of the job.
    void run()
    {
        const std::uint64_t vertices_before = counters_.costs.vertices;
        for (;;) {
            while (size() + lanes <= pool_capacity && next_ < camera_paths_.total()) start();
            if (size() == 0) break;
            // Continuing paths are stored in slots that were already read, or are appended to another pool.
            const std::size_t active = std::exchange(plain_end_, 0);
            for (std::size_t i = 0; i < active; i += lanes) bounce(i, first_lanes(active - i));
            if constexpr (!all_plain)
                for (std::size_t k = 0; k < other_kinds_; ++k) run_others(others_[k]);
        }
        clock_.enter(RenderStage::film);
        ended_.sum();
        if (lights_are_sampled_) counters_.costs.light_samples += counters_.costs.vertices - vertices_before;
    }

private:
    /// Where rays start: at the camera, a plain quad, or another quad.
    enum class From { camera, plain, other };
    template <From from>
    struct NextHit;

    /// Number of paths in flight.
    std::size_t size() const
    {
        std::size_t size = plain_end_;
        for (std::size_t k = 0; k < other_kinds_; ++k) size += others_[k].end;
        return size;
    }

    /// Scatters gangs of paths on quads that are not plain; an incomplete gang waits as long as there are new paths.
    void run_others(ClosureQuadPool& p)
    {
        const bool waits = next_ < camera_paths_.total();
        const std::size_t active = std::exchange(p.end, 0), done = waits ? active / lanes * lanes : active;
        for (std::size_t i = 0; i < done; i += lanes) bounce_by_closure(p, i, first_lanes(done - i));
        for (std::size_t i = done; i < active; ++i, ++p.end) {
            const auto move = [&](auto& column) { column[p.end] = column[i]; };
            p.for_all(scene_.has(Feature::transmission), move);
            move(p.direction.x), move(p.direction.y), move(p.direction.z), move(p.offset);
        }
    }

    /// Generates camera paths and stores those that hit a scattering surface.
    [[gnu::noinline, gnu::flatten]] void start()
    {
        clock_.enter(RenderStage::camera);
        const Mask valid = first_lanes(camera_paths_.total() - next_);
        const CameraPaths::Path path = camera_paths_.make(next_);
        next_ += lanes;
        NextHit<From::camera> at{path.ray.o, path.ray.d, Float(0), valid};
        at.intersect(*this);
        if (first_hits_.wanted())
            first_hits_.add({at.o, at.d, at.t, Float(0), Float(0), Float(0), at.quad, UInt(no_index)}, MediumStack(),
                            path.pixel, path.key.reversed_index, at.hits);
        Spectrum sum(Float(0));
        at.add_radiance(*this, Spectrum(Float(1)), sum);
        const Mask continues = at.continues() & may_scatter(settings_, UInt(0u));
        ended_.add(valid & !continues, path.pixel, path.key.reversed_index, sum);
        store_path(at, continues, {UInt(0u), Spectrum(Float(1)), sum, Float(1), path.key, path.pixel});
    }

    /// Does next event estimation and samples the next direction for paths on plain quads, stored from index i on.
    /// Fields are reloaded at each use because registers are scarce.
    [[gnu::noinline, gnu::flatten]] void bounce(std::size_t i, Mask valid)
    {
        clock_.enter(RenderStage::light);
        count_vertices(counters_, valid);
        const QuadPool& p = plain_;
        const UInt seed = group_seed(p.key(i), p.bounces(i) + UInt(1u));
        // One index is enough for the light's point and the next direction, since they never enter one product.
        const UInt index = shuffled_index(p.key(i), seed);
        Spectrum light(Float(0));
        if (lights_are_sampled_) light = direct_light(i, valid, seed, index);

        clock_.enter(RenderStage::scatter);
        const Vec3 local = sample_cosine_hemisphere(sample_2d(index, pair_seed(seed, pair_bsdf)));
        const Vec3 n = normal(p, i), tangent = scene_.quads.tangent(p.quad(i));
        NextHit<From::plain> at{p.eye.load(i), Frame(tangent, cross(n, tangent), n).to_world(local),
                                local.z * Float(inv_pi), valid};

        Spectrum left = p.throughput.load(i) * scene_.quads.color(p.quad(i));
        Spectrum sum;
        for (int c = 0; c < channels; ++c) sum.c[c] = fma(left.c[c], light.c[c], p.radiance.c[c].load(i));
        continue_path(at, p, i, seed, !all_plain && scene_.has(Feature::transmission) ? p.eta_scale.load(i) : Float(1),
                      left, sum);
    }

    /// Does next event estimation and samples the next direction for paths on other quads, stored from index i on.
    [[gnu::noinline, gnu::flatten]] void bounce_by_closure(const ClosureQuadPool& p, std::size_t i, Mask valid)
    {
        count_vertices(counters_, valid);
        const VertexRandom random(p.key(i), p.bounces(i) + UInt(1u));
        const UInt quad = p.quad(i);
        const Vec3 eye = p.eye.load(i);
        const Float offset = p.offset.load(i);
        const QuadVertex place{
            fma(normal(p, i), -offset, eye), offset, p.direction.load(i), eye, quad, random, p.throughput.load(i)};
        const auto light = [&](Mask m) {
            return lights_.sample(m, eye, random.key, random.seed, random.light(), Float(0));
        };
        QuadScatter next;
        closures_.scatter(ClosureKind(p.kind), place, valid, lights_are_sampled_, light, next);
        Spectrum sum = p.radiance.load(i);
        if (any(next.lit)) sum = sum + select(clear(next.shadow, next.lit), next.direct, Spectrum(Float(0)));
        Float eta_scale(1);
        if (scene_.has(Feature::transmission)) eta_scale = p.eta_scale.load(i) * next.by.eta * next.by.eta;
        NextHit<From::other> at{next.start, next.by.wi, next.by.pdf, valid};
        at.specular = next.by.is_delta;
        at.scattered = !next.by.is_delta | ((p.place.load(i) & UInt(QuadPool::scattered)) != UInt(0u));
        continue_path(at, p, i, random.seed, eta_scale, next.by.throughput, sum);
    }

    /// State of a gang of paths that continue.
    struct Continued {
        UInt bounces;
        Spectrum throughput, radiance;
        Float eta_scale;
        SampleKey key;
        UInt pixel;
    };

    /// Plays Russian roulette and finds the next hit of the paths that continue along `at`. left: throughput; sum:
    /// radiance.
    template <From from>
    [[gnu::always_inline]] void continue_path(NextHit<from>& at, const QuadPool& p, std::size_t i, UInt seed,
                                              Float eta_scale, Spectrum left, Spectrum sum)
    {
        const Mask valid = at.alive;
        const UInt before = p.bounces(i);
        at.alive =
            valid & !apply_roulette(roulette_by_throughput(settings_, before, eta_scale, left), p.key(i), seed, left);
        at.intersect(*this);
        at.add_radiance(*this, left, sum);
        const Mask continues = at.continues() & may_scatter(settings_, before + UInt(1u));
        ended_.add(valid & !continues, p.pixel.load(i), p.reversed_index.load(i), sum);
        store_path(at, continues, {before + UInt(1u), left, sum, eta_scale, p.key(i), p.pixel.load(i)});
    }

    /// Stores the paths that continue in the pool of plain quads or in that of their closure.
    template <From from>
    [[gnu::always_inline]] void store_path(const NextHit<from>& at, Mask continues, const Continued& path)
    {
        if constexpr (all_plain) {
            store_in(plain_, plain_end_, at, path, continues);
        } else {
            const Mask plain = continues & ((at.flags & UInt(QuadColumns::plain)) != UInt(0u));
            store_in(plain_, plain_end_, at, path, plain);
            for (std::size_t k = 0; k < other_kinds_; ++k) {
                ClosureQuadPool& p = others_[k];
                const Mask m = continues & !plain & ((at.flags >> QuadColumns::kind_shift) == UInt(p.kind));
                if (none(m)) continue;
                p.direction.append(p.end, at.d, m), p.offset.append(p.end, at.offset(*this), m);
                store_in(p, p.end, at, path, m);
            }
        }
    }
    template <From from>
    [[gnu::always_inline]] void store_in(QuadPool& p, std::size_t& end, const NextHit<from>& at, const Continued& path,
                                         Mask m)
    {
        at.store_vertex(*this, p, path.bounces, m, end);
        p.throughput.append(end, path.throughput, m), p.radiance.append(end, path.radiance, m);
        if (!all_plain && scene_.has(Feature::transmission)) p.eta_scale.append(end, path.eta_scale, m);
        p.pixel_hash.append(end, path.key.pixel_hash, m), p.reversed_index.append(end, path.key.reversed_index, m);
        p.pixel.append(end, path.pixel, m);
        end += std::size_t(count(m));
    }

    /// Quad normal on the side of the path.
    Vec3 normal(const QuadPool& p, std::size_t i) const
    {
        return flip_sign(scene_.quads.normal(p.quad(i)), bits_float(p.place.load(i)));
    }
    /// Lanes of m whose shadow ray is not blocked.
    [[gnu::always_inline]] Mask clear(const Ray& ray, Mask m)
    {
        clock_.enter(RenderStage::shadow);
        counters_.count_rays(RayKind::shadow, std::uint64_t(count(m)));
        const Mask clear = m & !scene_.flat.occluded(tables_, ray, m);
        counters_.costs.clear_shadow_rays += std::uint64_t(count(clear));
        return clear;
    }

    /// Radiance of a light sample if unoccluded, times cosine / pi and MIS weight, over the density. The caller
    /// multiplies it by throughput and surface color.
    [[gnu::always_inline]] Spectrum direct_light(std::size_t i, Mask valid, UInt seed, UInt index)
    {
        const QuadPool& p = plain_;
        const LightSample s = lights_.sample(valid, p.eye.load(i), p.key(i), seed,
                                             sample_2d(index, pair_seed(seed, pair_light)), Float(0));
        const Float cosine = dot(s.wi, normal(p, i));
        const Mask lit = valid & (s.inverse_pdf > Float(0)) & (cosine > Float(0));
        const Mask arrives = clear(Ray{p.eye.load(i), s.wi, s.distance * Float(1 - 0x1p-16f), Float(0)}, lit);
        // The weight is f_cos / pdf times the power heuristic, which is 1 / (1 + r^2) with r = bsdf_pdf / pdf.
        const Float r = cosine * Float(inv_pi) * s.inverse_pdf;
        Float weight = r * reciprocal(fma(r, r, Float(1)));
        if (any(s.is_delta)) weight = select(s.is_delta, r, weight);
        return s.radiance * select(arrives, weight, Float(0));
    }

    /// Rays of a gang and their hits.
    template <From from>
    struct NextHit {
        static constexpr bool from_camera = from == From::camera;

        Vec3 o, d;
        Float pdf;                     ///< density of the direction, with respect to solid angle
        Mask alive;                    ///< lanes that have a ray
        Mask specular{from_camera};    ///< lanes whose emission is not MIS-weighted against light sampling
        Mask scattered{!from_camera};  ///< lanes whose path had a scattering event that was not a delta lobe

        Float t{};
        UInt quad{}, flags{};
        Mask hits{};
        Vec3 n{};
        Float facing{};  ///< positive on the side of the quad's normal

        [[gnu::always_inline]] void intersect(QuadTracer& tracer)
        {
            tracer.clock_.enter(RenderStage::trace);
            const LaneScene& scene = tracer.scene_;
            tracer.counters_.count_rays(from_camera ? RayKind::camera : RayKind::bounce, std::uint64_t(count(alive)));
            const Hit hit = scene.flat.closest(scene.tables, Ray{o, d, Float(infinity), Float(0)});
            t = hit.t;
            quad = hit.primitive;  // a primitive's number is its quad's, since flat scenes of quads have no triangles,
                                   // which would come first
            hits = alive & (quad != UInt(no_index));
            flags = scene.quads.flags(quad);
            n = scene.quads.normal(quad);
            facing = -dot(d, n);
        }
        Mask continues() const { return hits & ((flags & UInt(QuadColumns::scatters)) != UInt(0u)); }

        /// Adds the radiance that quads and the background emit toward the ray's origin, MIS-weighted against light
        /// sampling.
        [[gnu::always_inline]] void add_radiance(QuadTracer& tracer, const Spectrum& left, Spectrum& sum)
        {
            const UInt shining_side =
                select(facing > Float(0), UInt(QuadColumns::emits_front), UInt(QuadColumns::emits_back));
            Mask emits = hits & ((flags & shining_side) != UInt(0u));
            if (!from_camera) {
                // Unlit materials are visible to camera and mirror rays but do not illuminate other surfaces.
                const Mask is_unlit = (flags & UInt(QuadColumns::unlit)) != UInt(0u);
                emits &= !(from == From::other ? is_unlit & scattered : is_unlit);
            }
            if (any(emits)) {
                const Float weight = select(emits, emission_weight(tracer, emits), Float(0));
                const Spectrum emitted = tracer.scene_.quads.emission(quad);
                for (int c = 0; c < channels; ++c) sum.c[c] = fma(left.c[c] * emitted.c[c], weight, sum.c[c]);
            }
            if (const Mask misses = alive & !hits; tracer.sees_background_ && any(misses))
                sum = sum + left * background(tracer, d, pdf, misses, specular);
        }

        [[gnu::always_inline]] Float emission_weight(const QuadTracer& tracer, Mask emits) const
        {
            if (from_camera || !tracer.lights_are_sampled_) return Float(1);
            const auto& lights = tracer.tables_.lights;
            const UInt light = tracer.scene_.quads.light(quad);
            Mask shared = emits & (light != UInt(no_index));
            if (from == From::other) shared &= !specular;
            if (lights.size() == 1) {
                const LightReader<true> record(lights.data(), UInt(0u));
                return select(shared, mis_weight(pdf, pdf_light(record, o, Float(0), d, t, shared)), Float(1));
            }
            const LightReader<false> record(lights.data(), select(shared, light, UInt(0u)));
            return select(shared, tracer.lights_.emission_weight(record, o, Float(0), d, t, pdf, shared), Float(1));
        }

        /// Radiance of the background; 0 outside the mask. Arguments are passed by value, so that the caller's
        /// variables can stay in registers.
        [[gnu::noinline]] static Spectrum background(const QuadTracer& tracer, Vec3 d, Float pdf, Mask misses,
                                                     Mask specular)
        {
            const Spectrum seen = tracer.lights_.environment(tracer.settings_.background, tracer.lights_are_sampled_, d,
                                                             Mask(from_camera), specular, pdf, misses);
            return select(misses, seen, Spectrum(Float(0)));
        }

        /// Distance from the quad at which rays leave it.
        [[gnu::always_inline]] Float offset(const QuadTracer& tracer) const
        {
            return rounding_along(n, fma(d, t, o), d * t) + tracer.scene_.quads.rounding(quad);
        }
        [[gnu::always_inline]] void store_vertex(const QuadTracer& tracer, QuadPool& p, UInt bounces, Mask m,
                                                 std::size_t to) const
        {
            p.eye.append(to, fma(n, flip_sign(offset(tracer), facing), fma(d, t, o)), m);
            UInt place = quad | bounces << QuadPool::bounce_shift | (float_bits(facing) & UInt(QuadPool::back));
            if (!all_plain) place = place | select(scattered, UInt(QuadPool::scattered), UInt(0u));
            p.place.append(to, place, m);
        }
    };

    const LaneScene& scene_;
    const SceneTables& tables_;
    const KernelSettings& settings_;
    const LightSampler lights_;
    const CameraPaths camera_paths_;
    FirstHits first_hits_;
    FinishedPaths ended_;
    KernelCounters& counters_;
    StageClock clock_;
    const QuadClosures closures_;
    bool lights_are_sampled_ = false, sees_background_ = false;
    std::uint32_t next_ = 0;  ///< number of the job's next path

    QuadPool plain_;
    std::size_t plain_end_ = 0;  ///< slot of the next path
    std::size_t other_kinds_ = 0;
    ClosureQuadPool others_[all_plain ? 1 : closure_kind_count];
};

}  // namespace FATHOM_LANES
}  // namespace fathom
