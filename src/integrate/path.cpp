/// The path loop: a pool of paths per thread, run through stages.
///
///     refill ─▶ trace ─▶ sort ─▶ emission, film ─▶ shade, by kind of bsdf ─▶ shadows ─▶ refill ...
///
/// Each stage runs over the whole pool N lanes at a time. After the nearest hit the pool is packed once, kind by kind,
/// so that shading has full lanes that run the same code. What a path sums to depends on its own random numbers alone,
/// never on its neighbours.
#include <algorithm>

#include "integrate/fast/quads/quad_path.h"
#include "integrate/pool.h"
#include "integrate/shade_stage.h"

namespace fathom {

inline namespace FATHOM_LANES {

namespace {

class PathTracer {
public:
    PathTracer(const LaneScene& scene, const CameraRecord& camera, const KernelSettings& settings, const KernelJob& job,
               TileSums& sums, KernelCounters& counters)
        : scene_(scene),
          tables_(scene.tables),
          surfaces_(scene),
          lights_(scene, surfaces_),
          settings_(settings),
          lights_are_sampled_(settings.light_sampling && !tables_.lights.empty()),
          camera_paths_(scene, camera, settings, job),
          first_hits_(scene, surfaces_, camera, settings.aovs, sums),
          sums_(sums),
          counters_(counters),
          shade_(scene, settings, lights_are_sampled_, counters)
    {
        has_time_ = tables_.moving;
        // Fields of the pool that have to travel with a path.
        travelling_fields_ = has_time_                         ? PathPool::time + 1
                             : scene.has_kind(BsdfKind::glass) ? PathPool::eta_scale + 1
                                                               : PathPool::state + 1;
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
            shade_.run(*paths_, packed_hits_, kind_end_);
        }
    }

private:
    // ------------------------------------------------------------------------------------------- camera

    /// Appends camera paths until the pool is full or the job has no more. Returns the number of paths.
    std::size_t refill(std::size_t active)
    {
        const std::size_t added = std::min<std::size_t>(PathPool::capacity - active, camera_paths_.total() - next_);
        for (std::size_t i = 0; i < added; i += lanes) generate(active + i, next_ + std::uint32_t(i));
        next_ += std::uint32_t(added);
        return active + added;
    }

    /// Paths number `first` and on of the job.
    void generate(std::size_t to, std::uint32_t first)
    {
        const CameraPaths::Path path = camera_paths_.make(first);
        PathPool& p = *paths_;
        p.set(PathPool::origin, to, path.ray.o);
        p.set(PathPool::direction, to, path.ray.d);
        p.set(PathPool::throughput, to, Spectrum(Float(1)));
        p.set(PathPool::radiance, to, Spectrum(Float(0)));
        p.set(PathPool::pixel_hash, to, path.key.pixel_hash);
        p.set(PathPool::reversed_index, to, path.key.reversed_index);
        p.set(PathPool::state, to, UInt(PathPool::specular) | path.pixel << PathPool::pixel_shift);
        p.set(PathPool::bsdf_pdf, to, Float(0));
        p.set(PathPool::eta_scale, to, Float(1));
        p.set(PathPool::time, to, path.ray.time);
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
            store(&hits_.u[i], hit.u);
            store(&hits_.v[i], hit.v);
        }
    }

    void trace_range(std::size_t begin, std::size_t end, bool coherent)
    {
        if (begin == end) return;
        PathPool& p = *paths_;
        const auto field = [&](int f) { return &p.data[f][begin]; };
        const RayArrays rays{field(PathPool::origin),
                             field(PathPool::origin + 1),
                             field(PathPool::origin + 2),
                             field(PathPool::direction),
                             field(PathPool::direction + 1),
                             field(PathPool::direction + 2),
                             nullptr,
                             has_time_ ? field(PathPool::time) : nullptr,
                             end - begin};
        scene_.bvh.closest(
            rays, {&hits_.t[begin], &hits_.u[begin], &hits_.v[begin], &hits_.primitive[begin], &hits_.instance[begin]},
            coherent);
    }

    // ------------------------------------------------------------------------------------------- sort

    /// Ends the paths that left the scene or met what doesn't scatter, and packs the others, kind by kind, into the
    /// spare pool. Returns how many those are.
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
            const Mask scatters =
                hit & (kind != UInt(0u)) & may_scatter(settings_, state & UInt(PathPool::bounce_mask));
            list(valid & !scatters, i, finished_, finished);
            store(&kinds_[i], select(scatters, kind, UInt(0u)));
        }
        if (first_hits_.wanted()) add_first_hits(active);
        for (std::size_t i = 0; i < emitting; i += lanes) add_emission(i, first_lanes(emitting - i));
        for (std::size_t i = 0; i < missing; i += lanes) add_environment(i, first_lanes(missing - i));
        for (std::size_t i = 0; i < finished; ++i) {
            const std::size_t k = finished_[i];
            sums_.add(p.scalar_integer(PathPool::state, k) >> PathPool::pixel_shift & (PathPool::max_pixels - 1),
                      reversed_scalar(p.scalar_integer(PathPool::reversed_index, k)), p.data[PathPool::radiance][k],
                      p.data[PathPool::radiance + 1][k], p.data[PathPool::radiance + 2][k]);
        }
        std::size_t packed = 0;
        for (std::uint32_t kind = 1; kind < std::uint32_t(BsdfKind::count); ++kind) {
            if (scene_.has_kind(BsdfKind(kind))) packed = pack(active, kind, packed);
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
            compress_store(&packed_hits_.u[packed], load(&hits_.u[i]), m);
            compress_store(&packed_hits_.v[packed], load(&hits_.v[i]), m);
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
        hit.u = gather(hits_.u, index, m);
        hit.v = gather(hits_.v, index, m);
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
        const UInt flags = surfaces_.material_word(offsetof(MaterialRecord, flags), material, m);
        const UInt light_base = surfaces_.shape_word(offsetof(ShapeRecord, light_base), shape, m);
        const Mask is_light = m & (light_base != UInt(no_index));
        const UInt first = surfaces_.shape_word(offsetof(ShapeRecord, first_primitive), shape, is_light);
        const UInt light_index = select(is_light, light_base + (hit.primitive - first), UInt(0u));
        const Mask two_sided = (flags & UInt(MaterialRecord::two_sided_emission)) != UInt(0u);

        Mask shows = m & two_sided;
        const Surface s = surfaces_.read(hit, m);
        shows |= m & (dot(hit.d, s.ng) < Float(0));
        const Spectrum emitted = surfaces_.emission(s, material, m);
        const Mask specular = (p.gather_integer(PathPool::state, index, m) & UInt(PathPool::specular)) != UInt(0u);
        Float weight(1.f);
        if (const Mask shared = shows & is_light & !specular; lights_are_sampled_ && any(shared)) {
            const LightReader<false> light(tables_.lights.data(), light_index);
            const Float pdf = p.gather_number(PathPool::bsdf_pdf, index, m);
            weight = select(
                shared, mis_weight(pdf, light.pmf() * pdf_light(light, hit.o, hit.time, hit.d, hit.t, shared)), weight);
        }
        add_radiance(&emitting_[at], index, select(shows, emitted, Spectrum(Float(0))), weight, m);
    }

    void add_environment(std::size_t at, Mask m)
    {
        const PathPool& p = *paths_;
        const UInt index = load(&missing_[at]);
        const Vec3 d = p.gather_vector(PathPool::direction, index, m);
        const UInt state = p.gather_integer(PathPool::state, index, m);
        const Mask specular = (state & UInt(PathPool::specular)) != UInt(0u);
        const Mask from_camera = (state & UInt(PathPool::bounce_mask)) == UInt(0u);
        const Float pdf = p.gather_number(PathPool::bsdf_pdf, index, m);
        const Spectrum radiance =
            lights_.environment(settings_.background, lights_are_sampled_, d, from_camera, specular, pdf, m);
        add_radiance(&missing_[at], index, radiance, Float(1), m);
    }

    // ------------------------------------------------------------------------------------------- first hits

    /// Albedo, normal, depth and the like of the paths that come straight from the camera.
    void add_first_hits(std::size_t active)
    {
        const PathPool& p = *paths_;
        for (std::size_t i = 0; i < active; i += lanes) {
            const UInt state = p.integer(PathPool::state, i);
            // A path of bounce 0 that has not been shaded yet.
            const Mask m =
                first_lanes(active - i) & ((state & UInt(PathPool::bounce_mask | PathPool::dead)) == UInt(0u));
            const Mask hits = m & (load(&hits_.primitive[i]) != UInt(no_index));
            if (none(hits)) continue;
            first_hits_.add(gather_hit(iota() + UInt(std::uint32_t(i)), hits),
                            (state >> PathPool::pixel_shift) & UInt(PathPool::max_pixels - 1),
                            p.integer(PathPool::reversed_index, i), hits);
        }
    }

    const LaneScene& scene_;
    const SceneTables& tables_;
    const SurfaceReader surfaces_;
    const LightChoice lights_;
    const KernelSettings& settings_;
    const bool lights_are_sampled_;
    const CameraPaths camera_paths_;
    FirstHits first_hits_;
    TileSums& sums_;
    KernelCounters& counters_;
    bool has_time_ = false;
    int travelling_fields_ = 0;
    std::uint32_t next_ = 0;                                   ///< number of the job's next path
    std::size_t kind_end_[std::size_t(BsdfKind::count)] = {};  ///< in the packed pool, by kind

    static constexpr std::size_t padded = PathPool::padded;
    PathPool pools_[2];
    PathPool *paths_ = &pools_[0], *spare_ = &pools_[1];
    HitArrays hits_, packed_hits_;
    ShadeStage shade_;
    alignas(64) std::uint32_t kinds_[padded];
    std::uint32_t emitting_[padded], missing_[padded], finished_[padded];
};

}  // namespace

}  // namespace FATHOM_LANES

void render_job(const KernelScene& scene, const CameraRecord& camera, const KernelSettings& settings,
                const KernelJob& job, TileSums& sums, KernelCounters& counters)
{
    const auto& lane_scene = static_cast<const LaneScene&>(scene);
    // On the heap, since they are too much for small stacks. Left uninitialised: every stage writes what the next one
    // reads.
    const auto run = [&]<class Tracer>(std::type_identity<Tracer>) {
        const std::unique_ptr<Tracer> tracer(new Tracer(lane_scene, camera, settings, job, sums, counters));
        tracer->run();
    };
    if (lane_scene.only_diffuse_quads)
        run(std::type_identity<QuadTracer>());
    else
        run(std::type_identity<PathTracer>());
}

}  // namespace fathom
