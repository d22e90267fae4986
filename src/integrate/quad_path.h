#pragma once
/// The path loop for flat scenes of smooth, untextured, diffuse quads, as boxes and rooms are: the same estimator as
/// PathTracer's, in fewer instructions.
///
///     start ─┬─▶ arrive ─▶ pool ─▶ light, next direction ─┐
///            └───────────────────◀───────────────────────┘
///
/// What a path meets next is found while its state is still in registers, and only paths that go on are stored. All
/// state fits into the first-level cache.
#include "integrate/first_hits.h"
#include "integrate/light_choice.h"
#include "integrate/path_end.h"

namespace fathom::inline FATHOM_LANES {

class QuadTracer {
public:
    QuadTracer(const LaneScene& scene, const CameraTable& camera, const KernelSettings& settings, const KernelJob& job, TileSums& sums,
               KernelCounters& counters)
        : scene_(scene), tables_(scene.tables), settings_(settings), surfaces_(scene), lights_(scene, surfaces_),
          camera_paths_(scene, camera, settings, job), first_hits_(scene, surfaces_, camera, settings.aovs, sums), sums_(sums),
          counters_(counters)
    {
        lights_are_sampled_ = settings.light_sampling && !tables_.lights.empty();
        sees_background_ = scene.sees_environment || settings.background.given;
    }

    void run()
    {
        std::size_t active = 0;
        for (;;) {
            while (active + lanes <= capacity && next_ < camera_paths_.total()) active = start(active);
            if (active == 0) return;
            // Paths that go on take the places before those still to be read.
            std::size_t kept = 0;
            for (std::size_t i = 0; i < active; i += lanes) kept = bounce(i, first_lanes(active - i), kept);
            active = kept;
        }
    }

private:
    static constexpr std::size_t capacity = 512;

    /// Fields of a path that waits on a surface. `place` holds the quad in its low 16 bits, the bounces so far in the next
    /// 15, and on top whether the path is on the quad's back.
    enum Field { eye = 0, throughput = 3, radiance = throughput + channels, place = radiance + channels, pixel_hash, reversed_index, pixel, field_count };
    static constexpr std::uint32_t quad_mask = 0xffff, bounce_mask = 0x7fff, back = 1u << 31;
    static constexpr int bounce_shift = 16;

    /// What travels with a path besides its ray.
    struct Path {
        Spectrum throughput, radiance;
        SampleKey key;
        UInt pixel, bounces;
    };

    Float number(int field, std::size_t i) const { return load(&pool_[field][i]); }
    UInt integer(int field, std::size_t i) const { return float_bits(number(field, i)); }
    Vec3 vector(int field, std::size_t i) const { return {number(field, i), number(field + 1, i), number(field + 2, i)}; }
    Spectrum spectrum(int field, std::size_t i) const
    {
        Spectrum s;
        for (int c = 0; c < channels; ++c) s.c[c] = number(field + c, i);
        return s;
    }

    /// Camera paths: those that meet a surface which scatters are stored from `to` on. Returns where the next ones go.
    [[gnu::noinline]] std::size_t start(std::size_t to)
    {
        const Mask valid = first_lanes(camera_paths_.total() - next_);
        const CameraPaths::Path begin = camera_paths_.make(next_);
        next_ += lanes;
        const Path path{Spectrum(Float(1)), Spectrum(Float(0)), begin.key, begin.pixel, UInt(0u)};
        return arrive<true>(begin.ray.o, begin.ray.d, Float(0), path, valid, valid, to);
    }

    /// A light, and the next direction, for the paths stored from i on.
    [[gnu::noinline]] std::size_t bounce(std::size_t i, Mask valid, std::size_t to)
    {
        Path path;
        path.key = {integer(pixel_hash, i), integer(reversed_index, i)};
        const UInt at = integer(place, i);
        const UInt quad = at & UInt(quad_mask);
        const UInt bounces = (at >> bounce_shift) & UInt(bounce_mask);
        path.bounces = bounces + UInt(1u);
        const UInt seed = group_seed(path.key, path.bounces);
        // The light's point and the next direction are never multiplied with each other.
        const UInt index = shuffled_index(path.key, seed);
        const Vec3 o = vector(eye, i);
        const Vec3 n = flip_sign(scene_.quads.normal(quad), bits_float(at));
        path.throughput = spectrum(throughput, i) * scene_.quads.color(quad);
        path.radiance = spectrum(radiance, i);
        if (lights_are_sampled_) add_light(valid, o, n, seed, index, path);

        const Vec3 local = sample_cosine_hemisphere(sample_2d(index, pair_seed(seed, pair_bsdf)));
        const Vec3 tangent = scene_.quads.tangent(quad);
        const Vec3 wi = Frame(tangent, cross(n, tangent), n).to_world(local);
        const Mask ends = end_some(settings_, path.key, seed, bounces, Float(1), path.throughput);
        path.pixel = integer(pixel, i);
        return arrive<false>(o, wi, local.z * Float(inv_pi), path, valid & !ends, valid, to);
    }

    /// Adds what a sampled light sends to the eye, if nothing is in the way. path.throughput: with the surface's colour.
    [[gnu::always_inline]] void add_light(Mask valid, Vec3 o, Vec3 n, UInt seed, UInt index, Path& path)
    {
        const LightSample s = lights_.sample(valid, o, path.key, seed, sample_2d(index, pair_seed(seed, pair_light)), Float(0));
        const Float cosine = dot(s.wi, n);
        const Mask lit = valid & (s.inverse_pdf > Float(0)) & (cosine > Float(0));
        if (none(lit)) return;
        counters_.rays += std::uint64_t(count(lit));
        const Mask clear = lit & !scene_.flat.occluded(tables_, Ray{o, s.wi, s.distance * Float(1 - 0x1p-16f), Float(0)}, lit);
        // f_cos / pdf, times the power heuristic in terms of r = bsdf_pdf / pdf: 1 / (1 + r^2).
        const Float r = cosine * Float(inv_pi) * s.inverse_pdf;
        Float weight = r * reciprocal(fma(r, r, Float(1)));
        if (any(s.is_delta)) weight = select(s.is_delta, r, weight);
        weight = select(clear, weight, Float(0));
        for (int c = 0; c < channels; ++c) path.radiance.c[c] = fma(path.throughput.c[c] * s.radiance.c[c], weight, path.radiance.c[c]);
    }

    /// Follows a ray to what it meets, sums the paths that end, and stores the others from `to` on.
    ///
    /// alive: lanes with a ray. valid: lanes with a path. pdf: of the ray's direction.
    template <bool from_camera>
    [[gnu::always_inline]] std::size_t arrive(Vec3 o, Vec3 d, Float pdf, Path path, Mask alive, Mask valid, std::size_t to)
    {
        counters_.rays += std::uint64_t(count(alive));
        const Hit hit = scene_.flat.closest(tables_, Ray{o, d, Float(infinity), Float(0)});
        const UInt quad = hit.primitive;  // there are no triangles before them
        const Mask hits = alive & (quad != UInt(no_index));
        if (from_camera && first_hits_.wanted())
            first_hits_.add({o, d, hit.t, Float(0), Float(0), Float(0), quad, UInt(no_index)}, path.pixel, path.key.reversed_index, hits);
        const UInt flags = scene_.quads.flags(quad);
        const Vec3 n = scene_.quads.normal(quad);
        const Float facing = -dot(d, n);
        const UInt shining_side = select(facing > Float(0), UInt(QuadColumns::emits_front), UInt(QuadColumns::emits_back));
        const Mask shines = hits & ((flags & shining_side) != UInt(0u));
        if (any(shines)) add_emission<from_camera>(quad, shines, o, d, hit.t, pdf, path);
        if (sees_background_ && any(alive & !hits)) add_environment<from_camera>(alive & !hits, d, pdf, path);

        const Mask goes_on = hits & ((flags & UInt(QuadColumns::scatters)) != UInt(0u));
        finish(valid & !goes_on, path);
        const Vec3 p = fma(d, hit.t, o);
        const Vec3 off = offset_origin(p, flip_sign(n, facing), max(hit.t, scene_.quads.extent(quad)));
        const auto keep = [&](int field, Float value) { compress_store(&pool_[field][to], value, goes_on); };
        keep(eye, off.x), keep(eye + 1, off.y), keep(eye + 2, off.z);
        for (int c = 0; c < channels; ++c) keep(throughput + c, path.throughput.c[c]), keep(radiance + c, path.radiance.c[c]);
        keep(place, bits_float(quad | path.bounces << bounce_shift | (float_bits(facing) & UInt(back))));
        keep(pixel_hash, bits_float(path.key.pixel_hash)), keep(reversed_index, bits_float(path.key.reversed_index));
        keep(pixel, bits_float(path.pixel));
        return to + std::size_t(count(goes_on));
    }

    /// What the quads emit towards the ray's origin, weighted against light sampling.
    template <bool from_camera>
    [[gnu::always_inline]] void add_emission(UInt quad, Mask shines, Vec3 o, Vec3 d, Float t, Float pdf, Path& path)
    {
        Float weight(1.f);
        if (!from_camera && lights_are_sampled_) {
            const UInt light = scene_.quads.light(quad);
            const Mask shared = shines & (light != UInt(no_index));
            Float other;
            if (tables_.lights.size() == 1) {
                other = pdf_light(LightRecord<true>(tables_.lights.data(), UInt(0u)), o, Float(0), d, t, shared);
            } else {
                const LightRecord<false> record(tables_.lights.data(), select(shared, light, UInt(0u)));
                other = record.pmf() * pdf_light(record, o, Float(0), d, t, shared);
            }
            weight = select(shared, mis_weight(pdf, other), weight);
        }
        weight = select(shines, weight, Float(0));
        const Spectrum emitted = scene_.quads.emission(quad);
        for (int c = 0; c < channels; ++c) path.radiance.c[c] = fma(path.throughput.c[c] * emitted.c[c], weight, path.radiance.c[c]);
    }

    template <bool from_camera>
    [[gnu::noinline]] void add_environment(Mask m, Vec3 d, Float pdf, Path& path)
    {
        const Spectrum seen = lights_.environment(settings_.background, lights_are_sampled_, d, Mask(from_camera), Mask(from_camera), pdf, m);
        path.radiance = select(m, path.radiance + path.throughput * seen, path.radiance);
    }

    void finish(Mask ended, const Path& path)
    {
        if (none(ended)) return;
        float value[channels][lanes];
        std::uint32_t pixels[lanes];
        for (int c = 0; c < channels; ++c) store(value[c], path.radiance.c[c]);
        store(pixels, path.pixel);
        for_each_active(ended, [&](int lane) { sums_.add(pixels[lane], value[0][lane], value[1][lane], value[2][lane]); });
    }

    const LaneScene& scene_;
    const SceneTables& tables_;
    const KernelSettings& settings_;
    const SurfaceReader surfaces_;
    const LightChoice lights_;
    const CameraPaths camera_paths_;
    FirstHits first_hits_;
    TileSums& sums_;
    KernelCounters& counters_;
    bool lights_are_sampled_ = false, sees_background_ = false;
    std::uint32_t next_ = 0;  ///< number of the job's next path

    /// Floats, and the bits of integers; room behind for stores of whole registers.
    alignas(64) float pool_[field_count][capacity + 2 * lanes];
};

}  // namespace fathom::inline FATHOM_LANES
