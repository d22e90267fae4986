/// The path loop: a pool of paths per thread, run through stages.
///
///     refill ─▶ trace ─▶ sort ─▶ emission, film ─▶ shade (light sample, shadow, next direction) ─▶ refill ...
///
/// Each stage runs over the whole pool N lanes at a time. After the nearest hit the pool is compacted once, so that
/// shading has full lanes. What a path sums to depends on its own random numbers alone, never on its neighbours.
#include <algorithm>

#include "integrate/camera.h"
#include "integrate/pool.h"
#include "integrate/scene.h"
#include "light/light.h"

namespace fathom {

namespace {

/// Pairs of random dimensions: the camera's, then the same number for each bounce.
enum Pair : std::uint32_t { pair_pixel = 0, pair_lens, pair_time, pair_first_bounce };
enum BouncePair : std::uint32_t { pair_light = 0, pair_bsdf, pair_choice, pair_roulette, pairs_per_bounce };

class PathTracer {
public:
    PathTracer(const LaneScene& scene, const CameraTable& camera, const KernelSettings& settings, const KernelJob& job,
               TileSums& sums, KernelCounters& counters)
        : scene_(scene), tables_(scene.tables), camera_(camera), settings_(settings), job_(job), sums_(sums), counters_(counters)
    {
        next_sample_ = job.first_sample;
        has_time_ = tables_.moving;
    }

    void run()
    {
        std::size_t active = 0;
        for (;;) {
            active = refill(active);
            if (active == 0) return;
            trace(active);
            active = sort(active);
            std::swap(paths_, spare_);
            shade_diffuse(active);
        }
    }

private:
    // ------------------------------------------------------------------------------------------- camera

    /// Appends camera paths until the pool is full or the job has no more. Returns the number of paths.
    std::size_t refill(std::size_t active)
    {
        const std::size_t room = PathPool::capacity - active;
        std::size_t added = 0;
        while (added < room && next_pixel_ < job_.pixel_count) {
            const std::uint32_t xy = job_.pixels[next_pixel_];
            const std::uint32_t x = xy % std::uint32_t(settings_.width), y = xy / std::uint32_t(settings_.width);
            const std::uint32_t pixel_hash = hash(x + hash(y + hash(settings_.seed)));
            const std::size_t n = std::min<std::size_t>(job_.last_sample - next_sample_, room - added);
            for (std::size_t i = 0; i < n; ++i) {
                new_x_[added + i] = x;
                new_y_[added + i] = y;
                new_sample_[added + i] = next_sample_ + std::uint32_t(i);
                new_pixel_[added + i] = next_pixel_;
                new_hash_[added + i] = pixel_hash;
            }
            added += n;
            next_sample_ += std::uint32_t(n);
            if (next_sample_ == job_.last_sample) {
                next_sample_ = job_.first_sample;
                ++next_pixel_;
            }
        }
        for (std::size_t i = 0; i < added; i += lanes) generate(active + i, i);
        return active + added;
    }

    void generate(std::size_t to, std::size_t from)
    {
        const SampleKey key{load(&new_hash_[from]), reverse_bits(load(&new_sample_[from]))};
        const Sample2 film = sample_2d(key, UInt(pair_pixel));
        const Float x = (to_float(load(&new_x_[from])) + film.x) * Float(1.0f / float(settings_.width));
        const Float y = (to_float(load(&new_y_[from])) + film.y) * Float(1.0f / float(settings_.height));
        Sample2 lens{Float(0.5f), Float(0.5f)};
        if (camera_.lens_radius > 0) lens = sample_2d(key, UInt(pair_lens));
        Float time(0.f);
        if (has_time_) time = sample_1d(key, UInt(pair_time));
        const CameraRay ray = camera_ray(camera_, x, y, lens, time);
        PathPool& p = *paths_;
        p.set(PathPool::origin, to, ray.o);
        p.set(PathPool::direction, to, ray.d);
        p.set(PathPool::throughput, to, Spectrum(Float(1)));
        p.set(PathPool::radiance, to, Spectrum(Float(0)));
        p.set(PathPool::pixel_hash, to, key.pixel_hash);
        p.set(PathPool::reversed_index, to, key.reversed_index);
        p.set(PathPool::pixel, to, load(&new_pixel_[from]));
        p.set(PathPool::state, to, UInt(PathPool::specular));
        p.set(PathPool::bsdf_pdf, to, float_bits(Float(0)));
        p.set(PathPool::eta_scale, to, float_bits(Float(1)));
        p.set(PathPool::time, to, float_bits(ray.time));
    }

    // ------------------------------------------------------------------------------------------- trace

    void trace(std::size_t active)
    {
        const PathPool& p = *paths_;
        counters_.rays += active;
        for (std::size_t i = 0; i < active; i += lanes) {
            const Ray ray{p.vector(PathPool::origin, i), p.vector(PathPool::direction, i), Float(infinity),
                          p.number(PathPool::time, i)};
            const Hit hit = scene_.flat.closest(tables_, ray);
            store(&hits_.data[HitArrays::t][i], float_bits(hit.t));
            store(&hits_.data[HitArrays::primitive][i], hit.primitive);
            store(&hits_.data[HitArrays::u][i], float_bits(hit.u));
            store(&hits_.data[HitArrays::v][i], float_bits(hit.v));
        }
    }

    // ------------------------------------------------------------------------------------------- sort

    /// Ends the paths that left the scene or met what doesn't scatter, and packs the others into the spare pool.
    std::size_t sort(std::size_t active)
    {
        PathPool& p = *paths_;
        std::size_t emitting = 0, finished = 0;
        for (std::size_t i = 0; i < active; i += lanes) {
            const Mask valid = first_lanes(active - i);
            const UInt primitive = load(&hits_.data[HitArrays::primitive][i]);
            const UInt state = p.integer(PathPool::state, i);
            const Mask alive = (state & UInt(PathPool::dead)) == UInt(0);
            const Mask hit = valid & alive & (primitive != UInt(no_index));
            const UInt info = gather(scene_.primitive_info.data(), primitive, hit);
            const Mask emits = hit & ((info & UInt(LaneScene::emits)) != UInt(0));
            if (any(emits)) {
                compress_store(&emitting_[emitting], iota() + UInt(std::uint32_t(i)), emits);
                emitting += std::size_t(count(emits));
            }
            const Mask scatters = hit & (((info >> LaneScene::kind_shift) & UInt(0xf)) != UInt(0));
            const Mask ends = valid & !scatters;
            compress_store(&finished_[finished], iota() + UInt(std::uint32_t(i)), ends);
            finished += std::size_t(count(ends));
            survivors_[i / lanes] = mask_bits(scatters);
            store(&info_[i], info);
        }
        for (std::size_t i = 0; i < emitting; i += lanes) add_emission(i, first_lanes(emitting - i));
        for (std::size_t i = 0; i < finished; ++i) {
            const std::size_t k = finished_[i];
            sums_.add(p.data[PathPool::pixel][k], p.scalar(PathPool::radiance, k), p.scalar(PathPool::radiance + 1, k),
                      p.scalar(PathPool::radiance + 2, k));
        }
        return pack(active);
    }

    std::size_t pack(std::size_t active)
    {
        const PathPool& from = *paths_;
        PathPool& to = *spare_;
        std::size_t packed = 0;
        const int fields = has_time_ ? PathPool::field_count : PathPool::eta_scale + 1;
        for (std::size_t i = 0; i < active; i += lanes) {
            const Mask m = mask_from_bits(survivors_[i / lanes]);
            for (int f = 0; f < fields; ++f) compress_store(&to.data[f][packed], load(&from.data[f][i]), m);
            for (int f = 0; f < 2; ++f) compress_store(&packed_hits_.data[f][packed], load(&hits_.data[f][i]), m);
            compress_store(&packed_info_[packed], load(&info_[i]), m);
            packed += std::size_t(count(m));
        }
        return packed;
    }

    /// Adds what the surfaces hit by the listed paths emit towards them, weighted against light sampling.
    void add_emission(std::size_t at, Mask m)
    {
        PathPool& p = *paths_;
        const UInt index = load(&emitting_[at]);
        const Vec3 o = p.gather_vector(PathPool::origin, index, m), d = p.gather_vector(PathPool::direction, index, m);
        const UInt primitive = gather(hits_.data[HitArrays::primitive], index, m);
        const Float t = bits_float(gather(hits_.data[HitArrays::t], index, m));
        const UInt shape = gather(tables_.shape_of_primitive.data(), primitive, m);
        constexpr int stride = sizeof(ShapeTable) / 4;
        const auto* shapes = reinterpret_cast<const std::uint32_t*>(tables_.shapes.data());
        const UInt light_base = gather(shapes + offsetof(ShapeTable, light_base) / 4, shape * UInt(stride), m);
        const UInt first = gather(shapes + offsetof(ShapeTable, first_primitive) / 4, shape * UInt(stride), m);
        const UInt light_index = select(m, light_base + (primitive - first), UInt(0));
        const LightRecord light(tables_.lights.data(), light_index, tables_.lights.size() == 1);
        const Float facing = -dot(d, light.normal());
        const Mask shows = m & ((facing > Float(0)) | (light.two_sided() != UInt(0)));
        const Mask specular = (p.gather_integer(PathPool::state, index, m) & UInt(PathPool::specular)) != UInt(0);
        Float weight(1.f);
        if (settings_.light_sampling && any(shows & !specular)) {
            const Float pdf = p.gather_number(PathPool::bsdf_pdf, index, m);
            weight = select(specular, Float(1), mis_weight(pdf, light.pmf() * pdf_light(light, o, Float(0), d, t)));
        }
        const Spectrum emitted = select(shows, light.radiance(), Spectrum(Float(0)));
        for (int c = 0; c < channels; ++c) {
            const Float old = p.gather_number(PathPool::radiance + c, index, m);
            const Float beta = p.gather_number(PathPool::throughput + c, index, m);
            alignas(64) float sum[lanes];
            store(sum, fma(beta * emitted.c[c], weight, old));
            for_each_active(m, [&](int lane) { p.set_scalar(PathPool::radiance + c, emitting_[at + std::size_t(lane)], sum[lane]); });
        }
    }

    // ------------------------------------------------------------------------------------------- shade

    void shade_diffuse(std::size_t active)
    {
        PathPool& p = *paths_;
        for (std::size_t i = 0; i < active; i += lanes) {
            const Vec3 o = p.vector(PathPool::origin, i), d = p.vector(PathPool::direction, i);
            const Float t = bits_float(load(&packed_hits_.data[HitArrays::t][i]));
            const UInt primitive = load(&packed_hits_.data[HitArrays::primitive][i]);
            const Mask valid = first_lanes(active - i);
            const UInt quad = primitive - UInt(tables_.first_quad());
            const Vec3 ng{gather(scene_.quad_normal[0].data(), quad, valid), gather(scene_.quad_normal[1].data(), quad, valid),
                          gather(scene_.quad_normal[2].data(), quad, valid)};
            // The side that the path is on.
            const Vec3 n = flip_sign(ng, -dot(d, ng));
            const Vec3 hit = fma(d, t, o);
            const Vec3 point = offset_origin(hit, n, t);

            const UInt material = load(&packed_info_[i]) & UInt(0xffffff);
            Spectrum albedo;
            for (int c = 0; c < channels; ++c) albedo.c[c] = gather(scene_.material_color[c].data(), material, valid);

            const SampleKey key{p.integer(PathPool::pixel_hash, i), p.integer(PathPool::reversed_index, i)};
            const UInt state = p.integer(PathPool::state, i);
            const UInt bounce = state & UInt(PathPool::bounce_mask);
            const UInt pair = bounce * UInt(pairs_per_bounce) + UInt(pair_first_bounce);
            Spectrum throughput = p.spectrum(PathPool::throughput, i);

            if (settings_.light_sampling && !tables_.lights.empty()) {
                const LightRecord light(tables_.lights.data(), UInt(0), true);
                const LightSample s = sample_light(light, point, Float(0), sample_2d(key, pair + UInt(pair_light)));
                const Float cosine = dot(s.wi, n);
                const Mask lit = valid & (cosine > Float(0)) & any_positive(s.radiance);
                if (any(lit)) {
                    counters_.rays += std::uint64_t(count(lit));
                    const Ray shadow{point, s.wi, s.distance * Float(1 - 0x1p-16f), Float(0)};
                    const Mask clear = lit & !scene_.flat.occluded(tables_, shadow, lit);
                    const Float bsdf_pdf = cosine * Float(inv_pi);
                    const Float weight = bsdf_pdf / s.pdf * mis_weight(s.pdf, bsdf_pdf);
                    const Spectrum add = throughput * albedo * s.radiance * weight;
                    p.set(PathPool::radiance, i,
                          p.spectrum(PathPool::radiance, i) + select(clear, add, Spectrum(Float(0))));
                }
            }

            const Vec3 local = sample_cosine_hemisphere(sample_2d(key, pair + UInt(pair_bsdf)));
            const Vec3 wi = Frame(n).to_world(local);
            throughput = throughput * albedo;
            UInt next_state = bounce + UInt(1);
            const Mask roulette = !less(bounce + UInt(1), UInt(std::uint32_t(settings_.roulette_depth)));
            if (any(roulette)) {
                const Float survival = min(max_component(throughput), Float(0.95f));
                const Mask dies = roulette & (sample_1d(key, pair + UInt(pair_roulette)) >= survival);
                throughput = select(roulette, throughput * (Float(1) / survival), throughput);
                next_state = select(dies, next_state | UInt(PathPool::dead), next_state);
            }
            if (settings_.max_depth >= 0)
                next_state = select(less(bounce + UInt(1), UInt(std::uint32_t(settings_.max_depth) + 1)), next_state,
                                    next_state | UInt(PathPool::dead));
            p.set(PathPool::origin, i, point);
            p.set(PathPool::direction, i, wi);
            p.set(PathPool::throughput, i, throughput);
            p.set(PathPool::bsdf_pdf, i, float_bits(local.z * Float(inv_pi)));
            p.set(PathPool::state, i, next_state);
        }
    }

    const LaneScene& scene_;
    const SceneTables& tables_;
    const CameraTable& camera_;
    const KernelSettings& settings_;
    const KernelJob& job_;
    TileSums& sums_;
    KernelCounters& counters_;
    bool has_time_ = false;
    std::uint32_t next_pixel_ = 0, next_sample_ = 0;

    static constexpr std::size_t padded = PathPool::capacity + 16;
    PathPool pools_[2];
    PathPool *paths_ = &pools_[0], *spare_ = &pools_[1];
    HitArrays hits_, packed_hits_;
    alignas(64) std::uint32_t info_[padded], packed_info_[padded];
    std::uint32_t emitting_[padded], finished_[padded], survivors_[padded];
    std::uint32_t new_x_[padded], new_y_[padded], new_sample_[padded], new_pixel_[padded], new_hash_[padded];
};

}  // namespace

void render_job(const KernelScene& scene, const CameraTable& camera, const KernelSettings& settings, const KernelJob& job,
                TileSums& sums, KernelCounters& counters)
{
    // Some 100 kB: too much for small stacks.
    const auto tracer = std::make_unique<PathTracer>(static_cast<const LaneScene&>(scene), camera, settings, job, sums, counters);
    tracer->run();
}

}  // namespace fathom
