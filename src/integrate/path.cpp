/// The path loop: a pool of paths per thread, run through stages.
///
///     refill ─▶ trace ─▶ sort ─▶ emission, film ─▶ shade, by kind of bsdf ─▶ shadows ─▶ refill ...
///
/// Each stage runs over the whole pool N lanes at a time. After the nearest hit the pool is packed once, kind by kind, so
/// that shading has full lanes that run the same code. What a path sums to depends on its own random numbers alone, never
/// on its neighbours.
#include <algorithm>

#include "fathom/description.h"
#include "integrate/camera.h"
#include "integrate/pool.h"
#include "integrate/scene.h"
#include "integrate/surface.h"
#include "light/environment.h"
#include "light/light.h"

namespace fathom {

inline namespace FATHOM_LANES {

namespace {

/// Pairs of random dimensions of the camera (group 0) and of each bounce (group bounce + 1).
enum CameraPair : std::uint32_t { pair_film, pair_lens, pair_time };
enum BouncePair : std::uint32_t { pair_light, pair_bsdf, pair_choice, pair_roulette };

class PathTracer {
public:
    PathTracer(const LaneScene& scene, const CameraTable& camera, const KernelSettings& settings, const KernelJob& job,
               TileSums& sums, KernelCounters& counters)
        : scene_(scene), tables_(scene.tables), surfaces_(scene), camera_(camera), settings_(settings), job_(job),
          sums_(sums), counters_(counters)
    {
        has_time_ = tables_.moving;
        has_glass_ = scene.kinds >> std::uint32_t(BsdfKind::glass) & 1;
        // Fields of the pool that have to travel with a path.
        travelling_fields_ = has_time_ ? PathPool::time + 1 : has_glass_ ? PathPool::eta_scale + 1 : PathPool::state + 1;
        lights_are_sampled_ = settings.light_sampling && !tables_.lights.empty();
    }

    void run()
    {
        std::size_t active = 0;
        for (;;) {
            const std::size_t fresh = active;  // camera rays come behind the others
            active = refill(active);
            if (active == 0) return;
            trace(fresh, active);
            active = sort(active);
            std::swap(paths_, spare_);
            shade_all();
        }
    }

private:
    // ------------------------------------------------------------------------------------------- camera

    /// Appends camera paths until the pool is full or the job has no more. Returns the number of paths.
    std::size_t refill(std::size_t active)
    {
        const std::uint32_t total = job_.pixel_count * job_.samples;
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
        const UInt pixel = to_uint((to_float(number) + Float(0.5f)) * Float(1.0f / float(job_.samples)));
        const UInt sample = number - pixel * UInt(job_.samples) + UInt(job_.first_sample);
        const UInt xy = gather(job_.pixels, pixel);
        const UInt y = xy >> 16, x = xy & UInt(0xffffu);
        const SampleKey key{hash(x + hash(y + UInt(hash(settings_.seed)))), reverse_bits(sample)};
        const UInt seed = group_seed(key, UInt(0u));
        const Sample2 film = sample_2d(key, pair_seed(seed, pair_film));
        Float dx = film.x, dy = film.y;
        if (settings_.filter != 0) {
            const FilterTable& filter = scene_.filters[settings_.filter - 1];
            dx = Float(0.5f) + filter.sample(film.x);
            dy = Float(0.5f) + filter.sample(film.y);
        }
        const Float film_x = (to_float(x) + dx) * Float(1.0f / float(settings_.width));
        const Float film_y = (to_float(y) + dy) * Float(1.0f / float(settings_.height));
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
        p.set(PathPool::bsdf_pdf, to, Float(0));
        p.set(PathPool::eta_scale, to, Float(1));
        p.set(PathPool::time, to, ray.time);
    }

    // ------------------------------------------------------------------------------------------- trace

    void trace(std::size_t fresh, std::size_t active)
    {
        PathPool& p = *paths_;
        counters_.rays += active;
        if (!scene_.is_flat) {
            trace_range(0, fresh, false);
            trace_range(fresh, active, true);
            return;
        }
        for (std::size_t i = 0; i < active; i += lanes) {
            const Ray ray{p.vector(PathPool::origin, i), p.vector(PathPool::direction, i), Float(infinity),
                          has_time_ ? p.number(PathPool::time, i) : Float(0)};
            const Hit hit = scene_.flat.closest(tables_, ray);
            store(&hits_.t[i], hit.t);
            store(&hits_.primitive[i], hit.primitive);
            if (scene_.simple) continue;
            store(&hits_.u[i], hit.u);
            store(&hits_.v[i], hit.v);
        }
    }

    void trace_range(std::size_t begin, std::size_t end, bool coherent)
    {
        if (begin == end) return;
        PathPool& p = *paths_;
        const auto field = [&](int f) { return &p.data[f][begin]; };
        const RayArrays rays{field(PathPool::origin),        field(PathPool::origin + 1),    field(PathPool::origin + 2),
                             field(PathPool::direction),     field(PathPool::direction + 1), field(PathPool::direction + 2),
                             nullptr, has_time_ ? field(PathPool::time) : nullptr, end - begin};
        scene_.bvh.closest(rays, {&hits_.t[begin], &hits_.u[begin], &hits_.v[begin], &hits_.primitive[begin], &hits_.instance[begin]},
                           coherent);
    }

    // ------------------------------------------------------------------------------------------- sort

    /// Ends the paths that left the scene or met what doesn't scatter, and packs the others, kind by kind, into the spare
    /// pool. Returns how many those are.
    std::size_t sort(std::size_t active)
    {
        std::size_t emitting = 0, missing = 0, finished = 0;
        PathPool& p = *paths_;
        for (std::size_t i = 0; i < active; i += lanes) {
            const Mask valid = first_lanes(active - i);
            const UInt primitive = load(&hits_.primitive[i]);
            const UInt state = p.integer(PathPool::state, i);
            const Mask alive = valid & ((state & UInt(PathPool::dead)) == UInt(0u));
            const Mask hit = alive & (primitive != UInt(no_index));
            const UInt instance = scene_.is_flat ? UInt(no_index) : load(&hits_.instance[i]);
            const UInt info = scene_.info_of(primitive, instance, hit);
            list(hit & ((info & UInt(LaneScene::emits)) != UInt(0u)), i, emitting_, emitting);
            if (scene_.sees_environment || settings_.background.given) list(alive & !hit, i, missing_, missing);
            const UInt kind = (info >> LaneScene::kind_shift) & UInt(LaneScene::kind_mask);
            const Mask scatters = hit & (kind != UInt(0u));
            list(valid & !scatters, i, finished_, finished);
            store(&kinds_[i], select(scatters, kind, UInt(0u)));
        }
        if (settings_.aovs.any()) add_first_hits(active);
        for (std::size_t i = 0; i < emitting; i += lanes) add_emission(i, first_lanes(emitting - i));
        for (std::size_t i = 0; i < missing; i += lanes) add_environment(i, first_lanes(missing - i));
        for (std::size_t i = 0; i < finished; ++i) {
            const std::size_t k = finished_[i];
            sums_.add(p.scalar_integer(PathPool::state, k) >> PathPool::pixel_shift & (PathPool::max_pixels - 1),
                      p.data[PathPool::radiance][k], p.data[PathPool::radiance + 1][k], p.data[PathPool::radiance + 2][k]);
        }
        std::size_t packed = 0;
        for (std::uint32_t kind = 1; kind < std::uint32_t(BsdfKind::count); ++kind) {
            if (scene_.kinds >> kind & 1) packed = pack(active, kind, packed);
            kind_end_[kind] = packed;
        }
        return packed;
    }

    /// Appends the numbers of the lanes, which begin at `first`, to a list.
    static void list(Mask m, std::size_t first, std::uint32_t* numbers, std::size_t& size)
    {
        if (none(m)) return;
        compress_store(numbers + size, iota() + UInt(std::uint32_t(first)), m);
        size += std::size_t(count(m));
    }

    std::size_t pack(std::size_t active, std::uint32_t kind, std::size_t packed)
    {
        const PathPool& from = *paths_;
        PathPool& to = *spare_;
        for (std::size_t i = 0; i < active; i += lanes) {
            const Mask m = load(&kinds_[i]) == UInt(kind);
            if (none(m)) continue;
            for (int f = 0; f < travelling_fields_; ++f) compress_store(&to.data[f][packed], load(&from.data[f][i]), m);
            compress_store(&packed_hits_.t[packed], load(&hits_.t[i]), m);
            compress_store(&packed_hits_.primitive[packed], load(&hits_.primitive[i]), m);
            if (!scene_.simple) {
                compress_store(&packed_hits_.u[packed], load(&hits_.u[i]), m);
                compress_store(&packed_hits_.v[packed], load(&hits_.v[i]), m);
            }
            if (!scene_.is_flat) compress_store(&packed_hits_.instance[packed], load(&hits_.instance[i]), m);
            packed += std::size_t(count(m));
        }
        return packed;
    }

    /// The hits of the listed paths.
    SurfaceHit gather_hit(UInt index, Mask m) const
    {
        const PathPool& p = *paths_;
        SurfaceHit hit;
        hit.o = p.gather_vector(PathPool::origin, index, m);
        hit.d = p.gather_vector(PathPool::direction, index, m);
        hit.t = gather(hits_.t, index, m);
        hit.primitive = gather(hits_.primitive, index, m);
        hit.time = has_time_ ? p.gather_number(PathPool::time, index, m) : Float(0);
        hit.u = scene_.simple ? Float(0) : gather(hits_.u, index, m);
        hit.v = scene_.simple ? Float(0) : gather(hits_.v, index, m);
        hit.instance = scene_.is_flat ? UInt(no_index) : gather(hits_.instance, index, m);
        return hit;
    }

    /// Adds throughput * emitted * weight to the radiance of the listed paths.
    void add_radiance(const std::uint32_t* numbers, UInt index, const Spectrum& emitted, Float weight, Mask m)
    {
        PathPool& p = *paths_;
        for (int c = 0; c < channels; ++c) {
            const Float old = p.gather_number(PathPool::radiance + c, index, m);
            const Float throughput = p.gather_number(PathPool::throughput + c, index, m);
            float sum[lanes];
            store(sum, fma(throughput * emitted.c[c], weight, old));
            for_each_active(m, [&](int lane) { p.data[PathPool::radiance + c][numbers[lane]] = sum[lane]; });
        }
    }

    /// What the surfaces hit by the listed paths emit towards them, weighted against light sampling.
    void add_emission(std::size_t at, Mask m)
    {
        const PathPool& p = *paths_;
        const UInt index = load(&emitting_[at]);
        const SurfaceHit hit = gather_hit(index, m);
        const UInt shape = surfaces_.shape_of(hit.primitive, hit.instance, m);
        const UInt material = surfaces_.material_of(shape, m);
        const UInt flags = surfaces_.material_word(offsetof(MaterialTable, flags), material, m);
        const UInt light_base = surfaces_.shape_word(offsetof(ShapeTable, light_base), shape, m);
        const Mask is_light = m & (light_base != UInt(no_index));
        const UInt first = surfaces_.shape_word(offsetof(ShapeTable, first_primitive), shape, is_light);
        const UInt light_index = select(is_light, light_base + (hit.primitive - first), UInt(0u));
        const Mask two_sided = (flags & UInt(MaterialTable::two_sided_emission)) != UInt(0u);

        Mask shows = m & two_sided;
        Spectrum emitted;
        if (scene_.simple) {
            const LightRecord<false> light(tables_.lights.data(), light_index);
            shows |= is_light & (dot(hit.d, light.normal()) < Float(0));
            emitted = light.radiance();
        } else {
            const Surface s = surfaces_.read(hit, m);
            shows |= m & (dot(hit.d, s.ng) < Float(0));
            emitted = surfaces_.emission(s, material, m);
        }
        const Mask specular = (p.gather_integer(PathPool::state, index, m) & UInt(PathPool::specular)) != UInt(0u);
        Float weight(1.f);
        if (const Mask shared = shows & is_light & !specular; lights_are_sampled_ && any(shared)) {
            const LightRecord<false> light(tables_.lights.data(), light_index);
            const Float pdf = p.gather_number(PathPool::bsdf_pdf, index, m);
            weight = select(shared, mis_weight(pdf, light.pmf() * pdf_light(light, hit.o, hit.time, hit.d, hit.t)), weight);
        }
        add_radiance(&emitting_[at], index, select(shows, emitted, Spectrum(Float(0))), weight, m);
    }

    void add_environment(std::size_t at, Mask m)
    {
        const PathPool& p = *paths_;
        const UInt index = load(&missing_[at]);
        const Vec3 d = p.gather_vector(PathPool::direction, index, m);
        const UInt state = p.gather_integer(PathPool::state, index, m);
        Spectrum radiance = environment_radiance(tables_, d, m);
        if (settings_.background.given) {
            const Mask seen = (state & UInt(PathPool::bounce_mask)) == UInt(0u);
            radiance = select(seen, Spectrum(settings_.background.radiance), radiance);
        }
        Float weight(1.f);
        const Mask specular = (state & UInt(PathPool::specular)) != UInt(0u);
        if (lights_are_sampled_ && tables_.environment.light != no_index && any(m & !specular)) {
            const Float pdf = p.gather_number(PathPool::bsdf_pdf, index, m);
            const Float pmf(tables_.lights[tables_.environment.light].pmf);
            weight = select(specular, Float(1), mis_weight(pdf, pmf * environment_pdf(tables_, d)));
        }
        add_radiance(&missing_[at], index, radiance, weight, m);
    }

    // ------------------------------------------------------------------------------------------- first hits

    /// Albedo, normal, depth and the like of the paths that come straight from the camera.
    void add_first_hits(std::size_t active)
    {
        const PathPool& p = *paths_;
        for (std::size_t i = 0; i < active; i += lanes) {
            const UInt state = p.integer(PathPool::state, i);
            // A path of bounce 0 that has not been shaded yet.
            const Mask m = first_lanes(active - i) & ((state & UInt(PathPool::bounce_mask | PathPool::dead)) == UInt(0u));
            const Mask hits = m & (load(&hits_.primitive[i]) != UInt(no_index));
            if (none(hits)) continue;
            const SurfaceHit hit = gather_hit(iota() + UInt(std::uint32_t(i)), hits);
            Surface s = surfaces_.read(hit, hits);
            const UInt material = surfaces_.material_of(s.shape, hits);
            const MaterialPoint point = surfaces_.material(s, material, hits, hits);
            const Vec3 n = flip_sign(s.ns, -dot(hit.d, s.ng));
            const Float depth = dot(s.p - hit.o, Vec3(Float(camera_.forward[0]), Float(camera_.forward[1]), Float(camera_.forward[2])));
            const UInt object = surfaces_.shape_word(offsetof(ShapeTable, object_id), s.shape, hits);
            const Float values[] = {point.base_color.c[0], point.base_color.c[1 % channels], point.base_color.c[2 % channels],
                                    n.x, n.y, n.z, depth * Float(float(1 / tables_.render_scale)),
                                    s.at.p_world.x, s.at.p_world.y, s.at.p_world.z};
            put_first_hits(values, state, hits, object, material, p.integer(PathPool::reversed_index, i));
        }
    }

    void put_first_hits(const Float* values, UInt state, Mask hits, UInt object, UInt material, UInt reversed_index)
    {
        constexpr int value_count = 10;
        float value[value_count][lanes];
        std::uint32_t pixel[lanes], ids[3][lanes];
        for (int v = 0; v < value_count; ++v) store(value[v], values[v]);
        store(pixel, (state >> PathPool::pixel_shift) & UInt(PathPool::max_pixels - 1));
        store(ids[0], reverse_bits(reversed_index)), store(ids[1], object), store(ids[2], material);
        const AovPlaces& places = settings_.aovs;
        for_each_active(hits, [&](int lane) {
            const std::uint32_t at = pixel[lane];
            const auto put = [&](int place, int first, int n) {
                for (int k = 0; place >= 0 && k < n; ++k) sums_.add_first_hit(at, place + k, value[first + k][lane]);
            };
            put(places.albedo, 0, 3), put(places.normal, 3, 3), put(places.depth, 6, 1), put(places.position, 7, 3);
            if (places.alpha >= 0) sums_.add_first_hit(at, places.alpha, 1);
            if (places.hits >= 0) sums_.add_first_hit(at, places.hits, 1);
            if (places.ids >= 0) sums_.set_ids(at, places.ids, ids[0][lane], ids[1][lane], ids[2][lane]);
        });
    }

    // ------------------------------------------------------------------------------------------- shade

    void shade_all()
    {
        shadows_ = 0;
        std::size_t begin = 0;
        for (std::uint32_t kind = 1; kind < std::uint32_t(BsdfKind::count); ++kind) {
            const std::size_t end = kind_end_[kind];
            if (begin < end) switch (BsdfKind(kind)) {
                    case BsdfKind::diffuse: scene_.simple ? shade<DiffuseBsdf, true>(begin, end) : shade<DiffuseBsdf, false>(begin, end); break;
                    case BsdfKind::metal: shade<MetalBsdf, false>(begin, end); break;
                    case BsdfKind::fuzz_metal: shade<FuzzMetalBsdf, false>(begin, end); break;
                    case BsdfKind::glass: shade<GlassBsdf, false>(begin, end); break;
                    case BsdfKind::principled: shade<PrincipledBsdf, false>(begin, end); break;
                    case BsdfKind::none:
                    case BsdfKind::count: break;
                }
            begin = end;
        }
        if (shadows_ > 0) trace_shadows();
    }

    /// Samples a light for each path, then its next direction.
    template <class Bsdf, bool simple>
    void shade(std::size_t begin, std::size_t end)
    {
        for (std::size_t i = begin; i < end; i += lanes) shade_gang<Bsdf, simple>(i, first_lanes(end - i));
    }

    template <class Bsdf, bool simple>
    [[gnu::always_inline]] void shade_gang(std::size_t i, Mask valid)
    {
        PathPool& p = *paths_;
        const SampleKey key{p.integer(PathPool::pixel_hash, i), p.integer(PathPool::reversed_index, i)};
        const UInt state = p.integer(PathPool::state, i);
        const UInt bounce = state & UInt(PathPool::bounce_mask);
        const UInt seed = group_seed(key, bounce + UInt(1u));
        // The light's point and the next direction are never multiplied with each other.
        const UInt index = shuffled_index(key, seed);
        const Vec3 d = p.vector(PathPool::direction, i);
        const Float t = load(&packed_hits_.t[i]);
        const Float time = has_time_ ? p.number(PathPool::time, i) : Float(0);
        Spectrum throughput = p.spectrum(PathPool::throughput, i);

        // The surface, its normals turned to the side that the path is on.
        Vec3 hit_point, ng, ns;
        Float extent;
        MaterialPoint m;
        if constexpr (simple) {
            const UInt primitive = load(&packed_hits_.primitive[i]);
            const Vec3 front = scene_.quad_normal_of(primitive - UInt(tables_.first_quad()), valid);
            ng = ns = flip_sign(front, -dot(d, front));
            hit_point = fma(d, t, p.vector(PathPool::origin, i));
            extent = max(t, scene_.quad_extent_of(primitive - UInt(tables_.first_quad()), valid));
            m.base_color = scene_.material_color_of(scene_.info_of(primitive, UInt(no_index), valid) & UInt(LaneScene::material_mask), valid);
            m.roughness = Float(0);
        } else {
            const SurfaceHit hit{p.vector(PathPool::origin, i), d, t, load(&packed_hits_.u[i]), load(&packed_hits_.v[i]), time,
                                 load(&packed_hits_.primitive[i]),
                                 scene_.is_flat ? UInt(no_index) : load(&packed_hits_.instance[i])};
            Surface s = surfaces_.read(hit, valid);
            const UInt material = surfaces_.material_of(s.shape, valid);
            const Float facing = -dot(d, s.ng);
            m = surfaces_.material(s, material, facing > Float(0), valid);
            hit_point = s.p;
            extent = s.extent;
            ng = flip_sign(s.ng, facing);
            ns = flip_sign(s.ns, facing);
            // Seen from behind its shading normal, a surface shows its geometric one.
            ns = select(dot(d, ns) < Float(-1e-4f), ns, ng);
            if (scene_.has_absorption) throughput = absorb(throughput, material, t, facing <= Float(0), valid);
        }
        const Frame frame(ns);
        const Bsdf bsdf(m);
        const Vec3 wo = simple ? Vec3(Float(0), Float(0), Float(1)) : upper(frame.to_local(-d));
        const auto start = [&](Vec3 wi) {
            const Vec3 side = Bsdf::transmits ? flip_sign(ng, dot(wi, ng)) : ng;
            return offset_origin(hit_point, side, extent);
        };

        if (lights_are_sampled_) {
            // Lights are seen from where the shadow ray starts: right at the surface a light that passes through it, or a
            // distance that ends behind the light, would be one of rounding.
            const Vec3 eye = offset_origin(hit_point, ng, extent);
            const Sample2 random = sample_2d(index, pair_seed(seed, pair_light));
            const LightSample sample = tables_.lights.size() == 1 && tables_.environment.light == no_index
                                           ? sample_light(LightRecord<true>(tables_.lights.data(), UInt(0u)), eye, time, random)
                                           : choose_light(valid, eye, key, seed, random, time);
            light_gang<simple>(i, valid, m, bsdf, frame, wo, ng, eye, start, throughput, sample, time);
        }

        const Float choice = simple ? Float(0) : sample_2d(key, pair_seed(seed, pair_choice)).x;
        const BsdfSample next = bsdf.sample(wo, sample_2d(index, pair_seed(seed, pair_bsdf)), choice);
        const Vec3 wi = frame.to_world(next.wi);
        throughput = throughput * next.weight;
        if constexpr (!simple) {
            // A shading normal must not send light through the surface, nor keep it from passing.
            const Float side = dot(wi, ng);
            throughput = select(equal(side > Float(0), next.wi.z > Float(0)), throughput, Spectrum(Float(0)));
        }
        UInt next_state = (state & UInt(~PathPool::specular)) + UInt(1u);
        if constexpr (!simple) next_state = select(next.is_delta, next_state | UInt(PathPool::specular), next_state);
        Float eta_scale(1.f);
        if (has_glass_) {
            eta_scale = p.number(PathPool::eta_scale, i) * next.eta * next.eta;
            p.set(PathPool::eta_scale, i, eta_scale, valid);
        }
        end_some(key, seed, bounce, eta_scale, throughput, next_state);
        put<simple>(PathPool::origin, i, start(wi), valid);
        put<simple>(PathPool::direction, i, wi, valid);
        put<simple>(PathPool::throughput, i, throughput, valid);
        put<simple>(PathPool::bsdf_pdf, i, next.pdf, valid);
        put<simple>(PathPool::state, i, next_state, valid);
    }

    /// Writes a field of the lanes of the mask. In a simple scene the lanes behind them belong to nobody.
    template <bool simple, class Value>
    void put(int field, std::size_t i, const Value& value, Mask valid)
    {
        if constexpr (simple)
            paths_->set(field, i, value);
        else
            paths_->set(field, i, value, valid);
    }

    /// Directions that rounding put below the horizon come back above it.
    static Vec3 upper(Vec3 w) { return {w.x, w.y, max(w.z, Float(1e-4f))}; }

    /// What is left after the way through the material's inside.
    Spectrum absorb(Spectrum throughput, UInt material, Float t, Mask inside, Mask m) const
    {
        const Spectrum sigma = surfaces_.material_spectrum(offsetof(MaterialTable, absorption), material, m & inside);
        for (int c = 0; c < channels; ++c) throughput.c[c] = throughput.c[c] * select(inside, exp(-(sigma.c[c] * t)), Float(1));
        return throughput;
    }

    /// Russian roulette, and the limit of depth.
    void end_some(const SampleKey& key, UInt seed, UInt bounce, Float eta_scale, Spectrum& throughput, UInt& state) const
    {
        const Mask dark = !(max_component(throughput) > Float(0));
        state = select(dark, state | UInt(PathPool::dead), state);
        const Mask roulette = !less(bounce + UInt(1u), UInt(std::uint32_t(settings_.roulette_depth)));
        if (any(roulette)) {
            // Refraction's scaling of radiance is undone: it is no loss.
            const Float survival = clamp(max_component(throughput) * eta_scale, Float(1e-3f), Float(0.95f));
            const Mask dies = roulette & (sample_hash(key, pair_seed(seed, pair_roulette)) >= survival);
            throughput = select(roulette, throughput * reciprocal(survival), throughput);
            state = select(dies, state | UInt(PathPool::dead), state);
        }
        if (settings_.max_depth >= 0)
            state = select(less(bounce + UInt(1u), UInt(std::uint32_t(settings_.max_depth) + 1)), state, state | UInt(PathPool::dead));
        else
            // Bounces are counted in 16 bits: a path that got there is one in a number too large to be met.
            state = select(less(bounce, UInt(0xfff0u)), state, state | UInt(PathPool::dead));
    }

    /// Chooses one of several lights by power, then a point on it; the sample's density is that of both.
    LightSample choose_light(Mask valid, Vec3 eye, const SampleKey& key, UInt seed, Sample2 random, Float time) const
    {
        const Float u = sample_2d(key, pair_seed(seed, pair_choice)).y;
        const UInt index = detail::find_interval(tables_.light_cdf.data(), UInt(0u), int(tables_.lights.size()), u);
        const LightRecord<false> light(tables_.lights.data(), index);
        LightSample s = sample_light(light, eye, time, random);
        const Mask environment = is_kind(light.kind(), LightTableKind::environment);
        if (any(valid & environment)) {
            const EnvironmentSample e = sample_environment(tables_, random, valid & environment);
            s.wi = select(environment, e.wi, s.wi);
            s.distance = select(environment, Float(infinity), s.distance);
            s.inverse_pdf = select(environment, e.inverse_pdf, s.inverse_pdf);
            s.radiance = select(environment, e.radiance, s.radiance);
            s.is_delta = s.is_delta & !environment;
        }
        if (const UInt material = light.material(); scene_.textured && any(valid & (material != UInt(no_index))))
            s.radiance = s.radiance * light_texture(light, material, eye, s, valid & (material != UInt(no_index)));
        s.inverse_pdf = s.inverse_pdf / light.pmf();
        return s;
    }

    /// The emission texture's factor at the sampled point of a light.
    template <class Light>
    Spectrum light_texture(const Light& light, UInt material, Vec3 from, const LightSample& s, Mask m) const
    {
        SurfaceHit hit;
        hit.o = from;
        hit.d = s.wi;
        hit.t = s.distance;
        hit.time = Float(0);
        hit.primitive = light.primitive();
        hit.instance = UInt(no_index);
        // Barycentric weights of a triangle's point; other kinds find theirs from the position.
        const Vec3 r = fma(s.wi, s.distance, from) - light.position();
        const Vec3 u = light.edge_u(), v = light.edge_v();
        const Vec3 n = cross(u, v);
        const Float scale = Float(1) / max(dot(n, n), Float(1e-30f));
        hit.u = dot(cross(r, v), n) * scale;
        hit.v = dot(cross(u, r), n) * scale;
        const Surface surface = surfaces_.read(hit, m);
        const UInt texture = surfaces_.material_word(offsetof(MaterialTable, emission_texture), material, m);
        const Texel t = evaluate_textures(tables_, texture, surface.at, m);
        Spectrum factor;
        for (int c = 0; c < channels; ++c) factor.c[c] = select(m, t.c[c], Float(1));
        return factor;
    }

    /// Adds a light sample's contribution if nothing is in the way.
    template <bool simple, class Bsdf, class Start>
    [[gnu::always_inline]] void light_gang(std::size_t i, Mask valid, const MaterialPoint& m, const Bsdf& bsdf, const Frame& frame, Vec3 wo, Vec3 ng,
                                           Vec3 eye, const Start& start, const Spectrum& throughput, const LightSample& s, Float time)
    {
        PathPool& p = *paths_;
        Mask lit = valid & (s.inverse_pdf > Float(0));
        Spectrum add;
        if constexpr (simple) {
            // f_cos / pdf, times the power heuristic in terms of r = bsdf_pdf / pdf: 1 / (1 + r^2).
            const Float cosine = dot(s.wi, ng);
            lit &= cosine > Float(0);
            const Float r = cosine * Float(inv_pi) * s.inverse_pdf;
            Float weight = r * reciprocal(fma(r, r, Float(1)));
            if (any(s.is_delta)) weight = select(s.is_delta, r, weight);
            add = throughput * m.base_color * s.radiance * weight;
        } else {
            const Vec3 wi = frame.to_local(s.wi);
            lit &= bsdf.has_smooth() & equal(wi.z > Float(0), dot(s.wi, ng) > Float(0));
            if (!Bsdf::transmits) lit &= wi.z > Float(0);
            const BsdfEval e = bsdf.eval(wo, wi);
            const Float r = e.pdf * s.inverse_pdf;
            const Float weight = select(s.is_delta, Float(1), Float(1) / fma(r, r, Float(1))) * s.inverse_pdf;
            add = throughput * e.f_cos * s.radiance * weight;
            lit &= any_positive(add);
        }
        if (none(lit)) return;
        counters_.rays += std::uint64_t(count(lit));
        const Vec3 o = Bsdf::transmits ? start(s.wi) : eye;
        // On the surface's other side the way is longer or shorter.
        const Float distance = Bsdf::transmits ? s.distance + dot(eye - o, s.wi) : s.distance;
        const Float t_max = distance * Float(1 - 0x1p-16f);
        if (scene_.is_flat) {
            const Mask clear = lit & !scene_.flat.occluded(tables_, Ray{o, s.wi, t_max, time}, lit);
            put<simple>(PathPool::radiance, i, p.spectrum(PathPool::radiance, i) + select(clear, add, Spectrum(Float(0))), valid);
            return;
        }
        const auto keep = [&](int field, Float value) { compress_store(&shadow_data_[field][shadows_], value, lit); };
        keep(0, o.x), keep(1, o.y), keep(2, o.z), keep(3, s.wi.x), keep(4, s.wi.y), keep(5, s.wi.z), keep(6, t_max), keep(7, time);
        for (int c = 0; c < channels; ++c) keep(8 + c, add.c[c]);
        compress_store(&shadow_path_[shadows_], iota() + UInt(std::uint32_t(i)), lit);
        shadows_ += std::size_t(count(lit));
    }

    /// Adds the contributions of the shadow rays that nothing blocks.
    void trace_shadows()
    {
        const auto& s = shadow_data_;
        scene_.bvh.occluded({s[0], s[1], s[2], s[3], s[4], s[5], s[6], has_time_ ? s[7] : nullptr, shadows_}, blocked_, false);
        PathPool& p = *paths_;
        for (std::size_t k = 0; k < shadows_; ++k)
            if (!blocked_[k])
                for (int c = 0; c < channels; ++c) p.data[PathPool::radiance + c][shadow_path_[k]] += s[8 + c][k];
    }

    const LaneScene& scene_;
    const SceneTables& tables_;
    const SurfaceReader surfaces_;
    const CameraTable& camera_;
    const KernelSettings& settings_;
    const KernelJob& job_;
    TileSums& sums_;
    KernelCounters& counters_;
    bool has_time_ = false, has_glass_ = false, lights_are_sampled_ = false;
    int travelling_fields_ = 0;
    std::uint32_t next_ = 0;  ///< number of the job's next path
    std::size_t shadows_ = 0;
    std::size_t kind_end_[std::size_t(BsdfKind::count)] = {};  ///< in the packed pool, by kind

    static constexpr std::size_t padded = PathPool::capacity + 32;
    PathPool pools_[2];
    PathPool *paths_ = &pools_[0], *spare_ = &pools_[1];
    HitArrays hits_, packed_hits_;
    alignas(64) std::uint32_t kinds_[padded];
    alignas(64) float shadow_data_[8 + channels][padded];
    std::uint32_t shadow_path_[padded], blocked_[padded];
    std::uint32_t emitting_[padded], missing_[padded], finished_[padded];
};

}  // namespace

}  // namespace FATHOM_LANES

void render_job(const KernelScene& scene, const CameraTable& camera, const KernelSettings& settings, const KernelJob& job,
                TileSums& sums, KernelCounters& counters)
{
    // Some 100 kB: too much for small stacks. Left uninitialised: every stage writes what the next one reads.
    const std::unique_ptr<PathTracer> tracer(
        new PathTracer(static_cast<const LaneScene&>(scene), camera, settings, job, sums, counters));
    tracer->run();
}

}  // namespace fathom
