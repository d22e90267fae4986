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

/// Pairs of random dimensions of the camera (group 0) and of each bounce (group bounce + 1).
enum CameraPair : std::uint32_t { pair_film, pair_lens, pair_time };
enum BouncePair : std::uint32_t { pair_light, pair_bsdf, pair_choice, pair_roulette };

class PathTracer {
public:
    PathTracer(const LaneScene& scene, const CameraTable& camera, const KernelSettings& settings, const KernelJob& job,
               TileSums& sums, KernelCounters& counters)
        : scene_(scene), tables_(scene.tables), camera_(camera), settings_(settings), job_(job), sums_(sums), counters_(counters)
    {
        samples_ = job.samples;
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
        const std::uint32_t total = job_.pixel_count * samples_;
        const std::size_t added = std::min<std::size_t>(PathPool::capacity - active, total - next_);
        for (std::size_t i = 0; i < added; i += lanes) generate(active + i, next_ + std::uint32_t(i), total);
        next_ += std::uint32_t(added);
        return active + added;
    }

    /// Paths number `first` and on of the job, pixel by pixel.
    void generate(std::size_t to, std::uint32_t first, std::uint32_t total)
    {
        UInt number = UInt(first) + iota();
        number = select(less(number, UInt(total)), number, UInt(first));
        // Exact, since a job has less than 2^20 samples.
        const UInt pixel = to_uint((to_float(number) + Float(0.5f)) * Float(1.0f / float(samples_)));
        const UInt sample = number - pixel * UInt(samples_) + UInt(job_.first_sample);
        const UInt xy = gather(job_.pixels, pixel);
        const UInt y = xy >> 16, x = xy & UInt(0xffff);
        const SampleKey key{hash(x + hash(y + UInt(hash(settings_.seed)))), reverse_bits(sample)};
        const UInt seed = group_seed(key, UInt(0));
        const Sample2 film = sample_2d(key, pair_seed(seed, pair_film));
        const Float film_x = (to_float(x) + film.x) * Float(1.0f / float(settings_.width));
        const Float film_y = (to_float(y) + film.y) * Float(1.0f / float(settings_.height));
        Sample2 lens{Float(0.5f), Float(0.5f)};
        if (camera_.lens_radius > 0) lens = sample_2d(key, pair_seed(seed, pair_lens));
        Float time(0.f);
        if (has_time_) time = sample_2d(key, pair_seed(seed, pair_time)).x;
        const CameraRay ray = camera_ray(camera_, film_x, film_y, lens, time);
        PathPool& p = *paths_;
        p.set(PathPool::origin, to, ray.o);
        p.set(PathPool::direction, to, ray.d);
        p.set(PathPool::throughput, to, Spectrum(Float(1)));
        p.set(PathPool::radiance, to, Spectrum(Float(0)));
        p.set(PathPool::pixel_hash, to, key.pixel_hash);
        p.set(PathPool::reversed_index, to, key.reversed_index);
        p.set(PathPool::state, to, UInt(PathPool::specular) | pixel << PathPool::pixel_shift);
        if (has_time_) p.set(PathPool::time, to, ray.time);
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
            store(&hits_.t[i], hit.t);
            store(&hits_.primitive[i], hit.primitive);
            store(&hits_.u[i], hit.u);
            store(&hits_.v[i], hit.v);
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
            const UInt primitive = load(&hits_.primitive[i]);
            const UInt state = p.integer(PathPool::state, i);
            const Mask alive = (state & UInt(PathPool::dead)) == UInt(0);
            const Mask hit = valid & alive & (primitive != UInt(no_index));
            const UInt info = info_of(primitive, hit);
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
        }
        for (std::size_t i = 0; i < emitting; i += lanes) add_emission(i, first_lanes(emitting - i));
        for (std::size_t i = 0; i < finished; ++i) {
            const std::size_t k = finished_[i];
            sums_.add(p.scalar_integer(PathPool::state, k) >> PathPool::pixel_shift & (PathPool::max_pixels - 1), p.data[PathPool::radiance][k], p.data[PathPool::radiance + 1][k],
                      p.data[PathPool::radiance + 2][k]);
        }
        return pack(active);
    }

    /// shape_info of a primitive; 0 outside the mask.
    UInt info_of(UInt primitive, Mask m) const
    {
        const int n = int(tables_.shape_of_primitive.size());
        if (n > LaneScene::small_table) return gather(scene_.primitive_info.data(), primitive, m);
        return select(m, lookup(scene_.primitive_info.data(), n, primitive), UInt(0));
    }

    std::size_t pack(std::size_t active)
    {
        const PathPool& from = *paths_;
        PathPool& to = *spare_;
        std::size_t packed = 0;
        const int fields = has_time_ ? PathPool::time + 1 : PathPool::state + 1;
        for (std::size_t i = 0; i < active; i += lanes) {
            const Mask m = mask_from_bits(survivors_[i / lanes]);
            for (int f = 0; f < fields; ++f) compress_store(&to.data[f][packed], load(&from.data[f][i]), m);
            compress_store(&packed_hits_.t[packed], load(&hits_.t[i]), m);
            compress_store(&packed_hits_.primitive[packed], load(&hits_.primitive[i]), m);
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
        const UInt primitive = gather(hits_.primitive, index, m);
        const Float t = gather(hits_.t, index, m);
        const UInt shape = gather(tables_.shape_of_primitive.data(), primitive, m);
        constexpr int stride = sizeof(ShapeTable) / 4;
        const auto* shapes = reinterpret_cast<const std::uint32_t*>(tables_.shapes.data());
        const UInt light_base = gather(shapes + offsetof(ShapeTable, light_base) / 4, shape * UInt(stride), m);
        const UInt first = gather(shapes + offsetof(ShapeTable, first_primitive) / 4, shape * UInt(stride), m);
        const UInt light_index = select(m, light_base + (primitive - first), UInt(0));
        const LightRecord<false> light(tables_.lights.data(), light_index);
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
            for_each_active(m, [&](int lane) { p.data[PathPool::radiance + c][emitting_[at + std::size_t(lane)]] = sum[lane]; });
        }
    }

    // ------------------------------------------------------------------------------------------- shade

    Vec3 quad_normal(UInt quad, Mask m) const
    {
        const auto& n = scene_.quad_normal;
        const int size = int(tables_.quads.size());
        if (size > LaneScene::small_table)
            return {gather(n[0].data(), quad, m), gather(n[1].data(), quad, m), gather(n[2].data(), quad, m)};
        return {lookup(n[0].data(), size, quad), lookup(n[1].data(), size, quad), lookup(n[2].data(), size, quad)};
    }

    Spectrum base_color(UInt material, Mask m) const
    {
        const int size = int(tables_.materials.size());
        Spectrum color;
        for (int c = 0; c < channels; ++c) {
            const float* table = scene_.material_color[c].data();
            color.c[c] = size > LaneScene::small_table ? gather(table, material, m) : lookup(table, size, material);
        }
        return color;
    }

    void shade_diffuse(std::size_t active)
    {
        PathPool& p = *paths_;
        for (std::size_t i = 0; i < active; i += lanes) {
            const Vec3 o = p.vector(PathPool::origin, i), d = p.vector(PathPool::direction, i);
            const Float t = load(&packed_hits_.t[i]);
            const UInt primitive = load(&packed_hits_.primitive[i]);
            const Mask valid = first_lanes(active - i);
            const UInt quad = primitive - UInt(tables_.first_quad());
            const Vec3 ng = quad_normal(quad, valid);
            // The side that the path is on.
            const Vec3 n = flip_sign(ng, -dot(d, ng));
            const Vec3 hit = fma(d, t, o);
            const Vec3 point = offset_origin(hit, n, t);

            const Spectrum albedo = base_color(info_of(primitive, valid) & UInt(0xffffff), valid);

            const SampleKey key{p.integer(PathPool::pixel_hash, i), p.integer(PathPool::reversed_index, i)};
            const UInt state = p.integer(PathPool::state, i);
            const UInt bounce = state & UInt(PathPool::bounce_mask);
            const UInt seed = group_seed(key, bounce + UInt(1));
            Spectrum throughput = p.spectrum(PathPool::throughput, i) * albedo;

            if (settings_.light_sampling && !tables_.lights.empty()) {
                const LightRecord<true> light(tables_.lights.data(), UInt(0));
                const LightSample s = sample_light(light, point, Float(0), sample_2d(key, pair_seed(seed, pair_light)));
                const Float cosine = dot(s.wi, n);
                const Mask lit = valid & (cosine > Float(0)) & (s.inverse_pdf > Float(0));
                if (any(lit)) {
                    counters_.rays += std::uint64_t(count(lit));
                    const Ray shadow{point, s.wi, s.distance * Float(1 - 0x1p-16f), Float(0)};
                    const Mask clear = lit & !scene_.flat.occluded(tables_, shadow, lit);
                    // f_cos / pdf, times the power heuristic in terms of r = bsdf_pdf / pdf: 1 / (1 + r^2).
                    const Float r = cosine * Float(inv_pi) * s.inverse_pdf;
                    const Float weight = r * reciprocal(fma(r, r, Float(1)));
                    const Spectrum add = throughput * s.radiance * weight;
                    p.set(PathPool::radiance, i,
                          p.spectrum(PathPool::radiance, i) + select(clear, add, Spectrum(Float(0))));
                }
            }

            const Vec3 local = sample_cosine_hemisphere(sample_2d(key, pair_seed(seed, pair_bsdf)));
            const Vec3 wi = Frame(n).to_world(local);
            UInt next_state = (state & UInt(~PathPool::specular)) + UInt(1);
            const Mask roulette = !less(bounce + UInt(1), UInt(std::uint32_t(settings_.roulette_depth)));
            if (any(roulette)) {
                const Float survival = min(max_component(throughput), Float(0.95f));
                const Mask dies = roulette & (sample_hash(key, pair_seed(seed, pair_roulette)) >= survival);
                throughput = select(roulette, throughput * (Float(1) / survival), throughput);
                next_state = select(dies, next_state | UInt(PathPool::dead), next_state);
            }
            if (settings_.max_depth >= 0)
                next_state = select(less(bounce + UInt(1), UInt(std::uint32_t(settings_.max_depth) + 1)), next_state,
                                    next_state | UInt(PathPool::dead));
            p.set(PathPool::origin, i, point);
            p.set(PathPool::direction, i, wi);
            p.set(PathPool::throughput, i, throughput);
            p.set(PathPool::bsdf_pdf, i, local.z * Float(inv_pi));
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
    std::uint32_t samples_ = 0, next_ = 0;  ///< per pixel of the job; number of the next path

    static constexpr std::size_t padded = PathPool::capacity + 32;
    PathPool pools_[2];
    PathPool *paths_ = &pools_[0], *spare_ = &pools_[1];
    HitArrays hits_, packed_hits_;
    std::uint32_t emitting_[padded], finished_[padded], survivors_[padded];
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
