#pragma once
/// The path loop for flat scenes of smooth, untextured, diffuse quads, as boxes and rooms are: the same estimator as
/// PathTracer's, in fewer instructions.
///
///     start ─┬─▶ arrive ─▶ pool ─▶ light, next direction ─┐
///            └───────────────────◀───────────────────────┘
///
/// What a path meets next is found while its state is still in registers, and only paths that go on are stored. All
/// state fits into the first-level cache.
#include "integrate/pool.h"
#include "integrate/stage_clock.h"
#include "integrate/stages/first_hits.h"
#include "integrate/stages/light.h"
#include "integrate/stages/path_end.h"

namespace fathom::inline FATHOM_LANES {

/// Paths that wait on a surface each.
struct QuadPool {
    VectorColumn eye;
    SpectrumColumn throughput, radiance;
    /// The quad in its low 16 bits, the bounces so far in the next 15, and on top whether the path is on the quad's
    /// back.
    Column<std::uint32_t> place;
    Column<std::uint32_t> pixel_hash, reversed_index, pixel;
};

class QuadTracer {
public:
    QuadTracer(const LaneScene& scene, const CameraRecord& camera, const KernelSettings& settings, const KernelJob& job,
               TileSums& sums, KernelCounters& counters)
        : scene_(scene),
          tables_(scene.tables),
          settings_(settings),
          lights_(scene, settings.light_selection),
          camera_paths_(scene, camera, settings, job),
          first_hits_(scene, camera, settings.aovs, sums),
          sums_(sums),
          counters_(counters),
          clock_(counters, settings.measure)
    {
        clock_.enter(RenderStage::quads);
        lights_are_sampled_ = settings.light_sampling && !tables_.lights.empty();
        sees_background_ = scene.sees_environment || settings.background.given;
    }

    void run()
    {
        std::size_t active = 0;
        for (;;) {
            while (active + lanes <= pool_capacity && next_ < camera_paths_.total()) active = start(active);
            if (active == 0) break;
            // Paths that go on take the places before those still to be read.
            std::size_t kept = 0;
            for (std::size_t i = 0; i < active; i += lanes) kept = bounce(i, first_lanes(active - i), kept);
            active = kept;
        }
        sum_ended();
    }

private:
    static constexpr std::uint32_t quad_mask = 0xffff, bounce_mask = 0x7fff, back = 1u << 31;
    static constexpr int bounce_shift = 16;

    /// Camera paths: those that meet a surface which scatters are stored from `to` on. Returns where the next ones go.
    [[gnu::noinline, gnu::flatten]] std::size_t start(std::size_t to)
    {
        const Mask valid = first_lanes(camera_paths_.total() - next_);
        const CameraPaths::Path path = camera_paths_.make(next_);
        next_ += lanes;
        Arrival<true> at{path.ray.o, path.ray.d, Float(0), valid};
        at.meet(*this);
        if (first_hits_.wanted())
            first_hits_.add({at.o, at.d, at.t, Float(0), Float(0), Float(0), at.quad, UInt(no_index)}, path.pixel,
                            path.key.reversed_index, at.hits);
        Spectrum sum(Float(0));
        at.add_radiance(*this, Spectrum(Float(1)), sum);
        const Mask goes_on = at.goes_on() & may_scatter(settings_, UInt(0u));
        finish(valid & !goes_on, path.pixel, path.key.reversed_index, sum);
        at.keep_place(*this, UInt(0u), goes_on, to);
        pool_.throughput.append(to, Spectrum(Float(1)), goes_on), pool_.radiance.append(to, sum, goes_on);
        pool_.pixel_hash.append(to, path.key.pixel_hash, goes_on);
        pool_.reversed_index.append(to, path.key.reversed_index, goes_on);
        pool_.pixel.append(to, path.pixel, goes_on);
        return to + std::size_t(count(goes_on));
    }

    /// A light, and the next direction, for the paths stored from i on; `to` is at most i.
    ///
    /// Fields are read where they are needed, and again where they are needed again: registers are scarce.
    [[gnu::noinline, gnu::flatten]] std::size_t bounce(std::size_t i, Mask valid, std::size_t to)
    {
        count_vertices(counters_, valid);
        const UInt seed = group_seed(key(i), bounces(i) + UInt(1u));
        // The light's point and the next direction are never multiplied with each other.
        const UInt index = shuffled_index(key(i), seed);
        Spectrum light(Float(0));
        if (lights_are_sampled_) light = direct_light(i, valid, seed, index);

        const Vec3 local = sample_cosine_hemisphere(sample_2d(index, pair_seed(seed, pair_bsdf)));
        const Vec3 n = normal(i), tangent = scene_.quads.tangent(quad(i));
        Arrival<false> at{pool_.eye.load(i), Frame(tangent, cross(n, tangent), n).to_world(local),
                          local.z * Float(inv_pi), valid};

        Spectrum left = pool_.throughput.load(i) * scene_.quads.color(quad(i));
        Spectrum sum;
        for (int c = 0; c < channels; ++c) sum.c[c] = fma(left.c[c], light.c[c], pool_.radiance.c[c].load(i));
        const UInt before = bounces(i);
        at.alive = valid & !play(roulette_by_throughput(settings_, before, Float(1), left), key(i), seed, left);
        at.meet(*this);
        at.add_radiance(*this, left, sum);
        const Mask goes_on = at.goes_on() & may_scatter(settings_, before + UInt(1u));
        finish(valid & !goes_on, pool_.pixel.load(i), pool_.reversed_index.load(i), sum);
        at.keep_place(*this, before + UInt(1u), goes_on, to);
        pool_.throughput.append(to, left, goes_on), pool_.radiance.append(to, sum, goes_on);
        for (Column<std::uint32_t>* column : {&pool_.pixel_hash, &pool_.reversed_index, &pool_.pixel})
            column->append(to, column->load(i), goes_on);
        return to + std::size_t(count(goes_on));
    }

    SampleKey key(std::size_t i) const { return {pool_.pixel_hash.load(i), pool_.reversed_index.load(i)}; }
    UInt quad(std::size_t i) const { return pool_.place.load(i) & UInt(quad_mask); }
    UInt bounces(std::size_t i) const { return (pool_.place.load(i) >> bounce_shift) & UInt(bounce_mask); }
    /// On the side of the path.
    Vec3 normal(std::size_t i) const
    {
        return flip_sign(scene_.quads.normal(quad(i)), bits_float(pool_.place.load(i)));
    }

    /// What a sampled light sends to the paths if nothing is in the way, times cosine / pi, over the density; to be
    /// multiplied by throughput and the surface's colour.
    [[gnu::always_inline]] Spectrum direct_light(std::size_t i, Mask valid, UInt seed, UInt index)
    {
        const LightSample s = lights_.sample(valid, pool_.eye.load(i), key(i), seed,
                                             sample_2d(index, pair_seed(seed, pair_light)), Float(0));
        const Float cosine = dot(s.wi, normal(i));
        const Mask lit = valid & (s.inverse_pdf > Float(0)) & (cosine > Float(0));
        counters_.count_rays(RayKind::shadow, std::uint64_t(count(lit)));
        const Mask clear =
            lit & !scene_.flat.occluded(tables_,
                                        Ray{pool_.eye.load(i), s.wi, s.distance * Float(1 - 0x1p-16f), Float(0)}, lit);
        counters_.costs.clear_shadow_rays += std::uint64_t(count(clear));
        // f_cos / pdf, times the power heuristic in terms of r = bsdf_pdf / pdf: 1 / (1 + r^2).
        const Float r = cosine * Float(inv_pi) * s.inverse_pdf;
        Float weight = r * reciprocal(fma(r, r, Float(1)));
        if (any(s.is_delta)) weight = select(s.is_delta, r, weight);
        return s.radiance * select(clear, weight, Float(0));
    }

    /// Rays on their way to what they meet.
    template <bool from_camera>
    struct Arrival {
        Vec3 o, d;
        Float pdf;   ///< of the direction
        Mask alive;  ///< lanes with a ray

        Float t{};
        UInt quad{}, flags{};
        Mask hits{};
        Vec3 n{};
        Float facing{};  ///< positive on the side of the quad's normal

        [[gnu::always_inline]] void meet(QuadTracer& tracer)
        {
            const LaneScene& scene = tracer.scene_;
            tracer.counters_.count_rays(from_camera ? RayKind::camera : RayKind::bounce, std::uint64_t(count(alive)));
            const Hit hit = scene.flat.closest(scene.tables, Ray{o, d, Float(infinity), Float(0)});
            t = hit.t;
            quad = hit.primitive;  // there are no triangles before them
            hits = alive & (quad != UInt(no_index));
            flags = scene.quads.flags(quad);
            n = scene.quads.normal(quad);
            facing = -dot(d, n);
        }
        Mask goes_on() const { return hits & ((flags & UInt(QuadColumns::scatters)) != UInt(0u)); }

        /// What quads and background send to the ray's origin, weighted against light sampling.
        [[gnu::always_inline]] void add_radiance(QuadTracer& tracer, const Spectrum& left, Spectrum& sum)
        {
            const UInt shining_side =
                select(facing > Float(0), UInt(QuadColumns::emits_front), UInt(QuadColumns::emits_back));
            Mask shines = hits & ((flags & shining_side) != UInt(0u));
            if (!from_camera) shines &= (flags & UInt(QuadColumns::unlit)) == UInt(0u);
            if (any(shines)) {
                const Float weight = select(shines, emission_weight(tracer, shines), Float(0));
                const Spectrum emitted = tracer.scene_.quads.emission(quad);
                for (int c = 0; c < channels; ++c) sum.c[c] = fma(left.c[c] * emitted.c[c], weight, sum.c[c]);
            }
            if (const Mask misses = alive & !hits; tracer.sees_background_ && any(misses))
                sum = sum + left * background(tracer, d, pdf, misses);
        }

        [[gnu::always_inline]] Float emission_weight(const QuadTracer& tracer, Mask shines) const
        {
            if (from_camera || !tracer.lights_are_sampled_) return Float(1);
            const auto& lights = tracer.tables_.lights;
            const UInt light = tracer.scene_.quads.light(quad);
            const Mask shared = shines & (light != UInt(no_index));
            if (lights.size() == 1) {
                const LightReader<true> record(lights.data(), UInt(0u));
                return select(shared, mis_weight(pdf, pdf_light(record, o, Float(0), d, t, shared)), Float(1));
            }
            const LightReader<false> record(lights.data(), select(shared, light, UInt(0u)));
            return select(shared, tracer.lights_.emission_weight(record, o, Float(0), d, t, pdf, shared), Float(1));
        }

        /// By value: nothing of the caller's has to live in memory for its sake. 0 outside the mask.
        [[gnu::noinline]] static Spectrum background(const QuadTracer& tracer, Vec3 d, Float pdf, Mask misses)
        {
            const Spectrum seen = tracer.lights_.environment(tracer.settings_.background, tracer.lights_are_sampled_, d,
                                                             Mask(from_camera), Mask(from_camera), pdf, misses);
            return select(misses, seen, Spectrum(Float(0)));
        }

        [[gnu::always_inline]] void keep_place(QuadTracer& tracer, UInt bounces, Mask goes_on, std::size_t to) const
        {
            const Vec3 p = fma(d, t, o);
            const Float offset = rounding_along(n, p, d * t) + tracer.scene_.quads.rounding(quad);
            tracer.pool_.eye.append(to, fma(n, flip_sign(offset, facing), p), goes_on);
            tracer.pool_.place.append(to, quad | bounces << bounce_shift | (float_bits(facing) & UInt(back)), goes_on);
        }
    };

    /// Notes the sums of paths that have ended.
    [[gnu::always_inline]] void finish(Mask ended, UInt pixels, UInt reversed, const Spectrum& sum)
    {
        Float largest = abs(sum.c[0]);
        for (int c = 1; c < channels; ++c) largest = max(abs(sum.c[c]), largest);
        // NaN is not small; where max() loses one, the comparison of the sum finds it.
        Float total = sum.c[0];
        for (int c = 1; c < channels; ++c) total = total + sum.c[c];
        const Mask small = ended & (largest < Float(TileSums::small)) & (total == total);
        if (const Mask large = ended & !small; any(large)) sum_large(large, pixels, reversed, sum);
        ended_pixel_.append(ended_, pixels, small);
        ended_radiance_.append(ended_, sum, small);
        ended_ += std::size_t(count(small));
        if (ended_ > pool_capacity - lanes) sum_ended();
    }
    [[gnu::noinline]] void sum_large(Mask m, UInt pixels, UInt reversed, Spectrum sum)
    {
        std::uint32_t pixel_of[lanes], sample[lanes];
        float value[channels][lanes];
        store(pixel_of, pixels), store(sample, reverse_bits(reversed));
        for (int c = 0; c < channels; ++c) store(value[c], sum.c[c]);
        for_each_active(m, [&](int k) { sums_.add(pixel_of[k], sample[k], value[0][k], value[1][k], value[2][k]); });
    }
    [[gnu::noinline]] void sum_ended()
    {
        for (std::size_t k = 0; k < ended_; ++k)
            sums_.add_small(ended_pixel_[k], ended_radiance_.c[0][k], ended_radiance_.c[1][k], ended_radiance_.c[2][k]);
        ended_ = 0;
    }

    const LaneScene& scene_;
    const SceneTables& tables_;
    const KernelSettings& settings_;
    const LightSampler lights_;
    const CameraPaths camera_paths_;
    FirstHits first_hits_;
    TileSums& sums_;
    KernelCounters& counters_;
    StageClock clock_;
    bool lights_are_sampled_ = false, sees_background_ = false;
    std::uint32_t next_ = 0;  ///< number of the job's next path

    QuadPool pool_;
    /// Paths that have ended: summed many at a time.
    std::size_t ended_ = 0;
    Column<std::uint32_t> ended_pixel_;
    SpectrumColumn ended_radiance_;
};

}  // namespace fathom::inline FATHOM_LANES
