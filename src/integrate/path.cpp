// SPDX-License-Identifier: Apache-2.0
/// The path loop: each thread runs a pool of paths through stages (wavefront path tracing).
///
///     refill ─▶ trace ─▶ walk ─▶ arrive (emission, film, sorting) ─▶ shade, shadows ─▶ retire ─▶ refill ...
///
/// Each stage runs over the whole pool, `lanes` paths at a time. After the nearest hit the pool is compacted once,
/// sorted by closure kind and by material, so that shading runs the same code on full lanes. The radiance of a path
/// depends on its own random numbers alone, never on other paths.
#include <algorithm>

#include "integrate/fast/quads/quad_path.h"
#include "integrate/stages/camera_media.h"
#include "integrate/stages/indirect_clamp.h"
#include "integrate/stages/pool_sorter.h"
#include "integrate/stages/shade.h"
#include "integrate/stages/single_sided.h"
#include "integrate/stages/trace.h"
#include "integrate/stages/walk.h"
#include "kernel/pool.h"
#include "materials/read/mixture.h"

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
          materials_(scene),
          lights_(scene, settings.light_selection, false),
          emitter_(scene, lights_, settings.light_targets),
          settings_(settings),
          job_(job),
          lights_are_sampled_(settings.light_sampling && !tables_.lights.empty()),
          columns_(path_columns(scene.features, settings, job.records != nullptr || job.profile != nullptr)),
          camera_media_(scene.has(Feature::media_stacks) ? media_at(scene, camera.position, camera.shutter_open)
                                                         : MediumStack()),
          camera_paths_(scene, camera, settings, job),
          first_hits_(scene, camera, settings.aovs, sums),
          sums_(sums),
          counters_(counters),
          clock_(counters, settings.measure),
          sorter_(scene),
          see_through_(scene, counters),
          mixtures_(scene),
          recorder_(job.records, camera_paths_.total()),
          profiler_(job.profile, scene.tables, camera_paths_.total()),
          walk_(scene, settings, counters, clock_, profiler_),
          shade_(scene, camera, settings, counters, clock_, recorder_, profiler_)
    {
    }

    /// Traces all paths of the job.
    void run()
    {
        add_background_of_unseen_pixels();
        std::size_t active = 0;
        for (;;) {
            const std::size_t fresh = active;  // the new camera rays follow the other paths
            clock_.enter(RenderStage::camera);
            active = refill(active);
            if (active == 0) break;
            clock_.enter(RenderStage::trace);
            trace(fresh, active);
            if (scene_.has(Feature::camera_pass_through)) see_through_.pass_surfaces(*paths_, hits_, fresh, active);
            clock_.enter(RenderStage::arrival);
            if (recorder_.is_on()) recorder_.record_light_samples(*paths_, active);
            active = process_hits(active);
            std::swap(paths_, spare_);
            if (recorder_.is_on()) recorder_.record_surfaces(*paths_, sorter_.hits(), sorter_.size());
            if (profiler_.is_on()) arrive_in_profile();
            shade_.run(*paths_, sorter_.hits(), sorter_.kind_end());
            if (profiler_.is_on()) profiler_.record_light_samples(*paths_, sorter_.size());
            clock_.enter(RenderStage::film);
            active = retire_paths(active);
        }
        recorder_.finish();
    }

private:
    // ------------------------------------------------------------------------------------------- camera

    /// Appends camera paths until the pool is full or the job has no more. Returns the number of paths.
    std::size_t refill(std::size_t active)
    {
        const std::size_t added = std::min<std::size_t>(pool_capacity - active, camera_paths_.total() - next_);
        for (std::size_t i = 0; i < added; i += lanes) generate(active + i, next_ + std::uint32_t(i));
        next_ += std::uint32_t(added);
        return active + added;
    }

    /// Adds the samples of pixels without paths.
    void add_background_of_unseen_pixels()
    {
        const KernelBackground& background = settings_.background;
        const Rgb& c = background.radiance;
        if (!background.given || (c[0] == 0 && c[1] == 0 && c[2] == 0)) return;
        for (std::uint32_t pixel : camera_paths_.unseen_pixels())
            for (std::uint32_t i = 0; i < job_.samples; ++i) sums_.add(pixel, job_.first_sample + i, c[0], c[1], c[2]);
    }

    /// Generates `lanes` paths of the job from number `first` on.
    void generate(std::size_t to, std::uint32_t first)
    {
        const CameraPaths::Path path = camera_paths_.make(first);
        PathPool& p = *paths_;
        p.origin.store(to, path.ray.o);
        p.direction.store(to, path.ray.d);
        p.throughput.store(to, Spectrum(Float(1)));
        p.radiance.store(to, Spectrum(Float(0)));
        p.pixel_hash.store(to, path.key.pixel_hash);
        p.reversed_index.store(to, path.key.reversed_index);
        p.state.store(to, UInt(PathPool::specular) | path.pixel << PathPool::pixel_shift);
        p.bsdf_pdf.store(to, Float(0));
        p.exit_offset.store(to, Float(0));
        p.eta_scale.store(to, Float(1));
        p.time.store(to, path.ray.time);
        p.media.store(to, camera_media_);
        if (columns_.has(PathColumn::indirect_left)) p.indirect_left.store(to, Float(settings_.clamp_indirect));
        p.walk_steps.store(to, UInt(0u));
        if (columns_.has(PathColumn::number)) p.number.store(to, iota() + UInt(first));
        if (columns_.has(PathColumn::walk_coefficients)) forget_medium(p, to);
        if (columns_.has(PathColumn::light_tracing)) p.connection.store(to, Float(no_vertex));
        if (columns_.has(PathColumn::gathered)) p.gathered.store(to, UInt(PathPool::nothing));
    }

    // ------------------------------------------------------------------------------------------- trace

    void trace(std::size_t fresh, std::size_t active)
    {
        counters_.count_rays(RayKind::bounce, fresh);
        counters_.count_rays(RayKind::camera, active - fresh);
        if (profiler_.is_on()) profiler_.charge(*paths_, fresh, active);
        if (scene_.is_flat) {
            trace_paths(scene_, *paths_, hits_, 0, active, false);
            if (profiler_.is_on()) profiler_.charge_rays(*paths_, 0, active);
            return;
        }
        trace_paths(scene_, *paths_, hits_, 0, fresh, false);
        if (profiler_.is_on()) profiler_.charge_rays(*paths_, 0, fresh);
        trace_paths(scene_, *paths_, hits_, fresh, active, true);
        if (profiler_.is_on()) profiler_.charge_rays(*paths_, fresh, active);
    }

    // ------------------------------------------------------------------------------------------- arrive

    /// Ends the paths that left the scene or hit a surface that does not scatter. Compacts the others, sorted, into the
    /// spare pool, followed by those that a medium scattered. Returns the number of paths that continue.
    std::size_t process_hits(std::size_t active)
    {
        if (scene_.has(Feature::attenuation)) {
            walk_.run(*paths_, hits_, active);
            if (profiler_.is_on()) profiler_.record_media(*paths_, hits_, active);
        }
        if (scene_.has(Feature::mixtures)) mixtures_.choose(*paths_, hits_, active, columns_.has(PathColumn::time));
        std::size_t emitting = 0, missing = 0, finished = 0, walking = 0;
        PathPool& p = *paths_;
        for (std::size_t i = 0; i < active; i += lanes) {
            Mask valid = first_lanes(active - i);
            if (scene_.has(Feature::scattering_media)) {
                const Mask walks = valid & (hits_.t.load(i) < Float(0));
                append_indices(walks, i, walking_, walking);
                valid &= !walks;
            }
            const UInt primitive = hits_.primitive.load(i);
            const Mask hit = valid & (primitive != UInt(no_index));
            const UInt instance = scene_.is_flat ? UInt(no_index) : hits_.instance.load(i);
            surfaces_.fetch_indices(primitive, hit);
            const UInt info = scene_.shape_info_of(primitive, instance, hit);
            const Mask emits = hit & ((info & UInt(LaneScene::emits)) != UInt(0u));
            append_indices(emits & !is_black(primitive, instance, emits), i, emitting_, emitting);
            if (scene_.has(Feature::environment) || settings_.background.given)
                append_indices(valid & !hit, i, missing_, missing);
            UInt bucket = info & UInt(LaneScene::bucket_mask);
            if (scene_.has(Feature::mixtures)) bucket = mixtures_.bucket(hits_.material.load(i), bucket, hit);
            const Mask scatters = hit & !less(bucket, UInt(1u << LaneScene::kind_shift)) &
                                  (may_scatter(settings_, p.state.load(i) & UInt(PathPool::bounce_mask)) |
                                   ((info & UInt(LaneScene::passes_without_bounce)) != UInt(0u)));
            append_indices(valid & !scatters, i, finished_, finished);
            if (columns_.has(PathColumn::nee_probability)) bucket = bucket | choose_light_chance(i, scatters);
            sorter_.set_bucket(i, select(scatters, bucket, UInt(0u)));
        }
        if (first_hits_.wanted()) add_first_hits(active);
        for (std::size_t i = 0; i < emitting; i += lanes) add_emission(i, first_lanes(emitting - i));
        for (std::size_t i = 0; i < missing; i += lanes) add_environment(i, first_lanes(missing - i));
        if (profiler_.is_on()) {
            profiler_.record_emission(*paths_, hits_, scene_.is_flat, active);
            profiler_.charge(*paths_, 0, active);
        }
        clock_.enter(RenderStage::film);
        for (std::size_t i = 0; i < finished; ++i) {
            fetch_sums(finished_[std::min(i + fetched_ahead, finished - 1)]);
            finish(finished_[i]);
        }
        clock_.enter(RenderStage::sort);
        const std::size_t packed = sorter_.run(*paths_, *spare_, columns_, hits_, active);
        const auto append = [&](const auto& from, auto& to) {
            for (std::size_t k = 0; k < walking; ++k) to[packed + k] = from[walking_[k]];
        };
        if (walking > 0) {
            PathPool::for_each_live_column(*paths_, *spare_, columns_, append);
            append(paths_->bsdf_pdf, spare_->bsdf_pdf);
            append(paths_->exit_offset, spare_->exit_offset);
        }
        return packed + walking;
    }

    /// Moves the profile's paths to the surfaces that are shaded next, which sorting was for.
    void arrive_in_profile()
    {
        profiler_.arrive(*paths_, sorter_.hits(), scene_.is_flat, scene_.has(Feature::mixtures), sorter_.size());
        profiler_.charge(*paths_, 0, sorter_.size());
    }

    /// Decides which paths of the gang, among the lanes of m, sample a light at their vertex. Returns the bucket flag
    /// that shades these paths separately from the others.
    UInt choose_light_chance(std::size_t i, Mask m)
    {
        PathPool& p = *paths_;
        const GuidingTables& tables = *settings_.guiding;
        const SampleKey key{p.pixel_hash.load(i), p.reversed_index.load(i)};
        const UInt bounce = p.state.load(i) & UInt(PathPool::bounce_mask);
        const UInt seed = group_seed(key, bounce + UInt(1u));
        const Vec3 at = fma(p.direction.load(i), hits_.t.load(i), p.origin.load(i));
        const UInt cube = guiding_cube(tables, at, guiding_noise(sample_hash(key, pair_seed(seed, pair_guiding))));
        const Float chance = nee_probability(tables, cube, mean(p.throughput.load(i)), m);
        const Mask samples = sample_hash(key, pair_seed(seed, pair_light_chance)) < chance;
        p.nee_probability.store(i, select(samples, chance, -chance));
        return select(samples, UInt(LaneScene::samples_light), UInt(0u));
    }

    // ------------------------------------------------------------------------------------------- end

    /// Film sums are prefetched this many paths ahead.
    static constexpr std::size_t fetched_ahead = 8;
    void fetch_sums(std::size_t i) const { sums_.fetch(PathPool::pixel_of(paths_->state[i])); }

    /// Adds a path's radiance to the film.
    void finish(std::size_t i)
    {
        const PathPool& p = *paths_;
        if (recorder_.is_on()) recorder_.end_path(p, i);
        if (profiler_.is_on()) profiler_.end_path(p.number[i]);
        sums_.add(PathPool::pixel_of(p.state[i]), reverse_bits_scalar(p.reversed_index[i]), p.radiance.c[0][i],
                  p.radiance.c[1][i], p.radiance.c[2][i]);
    }

    /// Ends the paths that shading marked as dead, before the next rays are traced. Returns the number of paths left.
    std::size_t retire_paths(std::size_t active)
    {
        return remove_dead_paths(*paths_, columns_, active, finished_,
                                 [&](const Column<std::uint32_t>& dead, std::size_t k) {
                                     fetch_sums(dead[k - std::min(k, fetched_ahead)]);
                                     finish(dead[k]);
                                 });
    }

    // ------------------------------------------------------------------------------------------- emission

    /// Hits of the paths with these numbers.
    SurfaceHit gather_hit(UInt index, Mask m) const
    {
        const PathPool& p = *paths_;
        return {p.origin.gather(index, m),        p.direction.gather(index, m),
                hits_.t.gather(index, m),         hits_.u.gather(index, m),
                hits_.v.gather(index, m),         columns_.has(PathColumn::time) ? p.time.gather(index, m) : Float(0),
                hits_.primitive.gather(index, m), scene_.is_flat ? UInt(no_index) : hits_.instance.gather(index, m)};
    }

    /// Adds throughput * emitted * weight to the radiance of the `lanes` paths that are listed from numbers[at] on.
    void add_radiance(const Column<std::uint32_t>& numbers, std::size_t at, const Spectrum& emitted, Float weight,
                      Mask m)
    {
        PathPool& p = *paths_;
        const UInt index = numbers.load(at);
        if (columns_.has(PathColumn::indirect_left)) weight = weight * indirect_scale(index, emitted * weight, m);
        for (int c = 0; c < channels; ++c) {
            const Float old = p.radiance.c[c].gather(index, m);
            const Float throughput = p.throughput.c[c].gather(index, m);
            float sum[lanes];
            store(sum, fma(throughput * emitted.c[c], weight, old));
            for_each_active(m, [&](int lane) { p.radiance.c[c][numbers[at + std::size_t(lane)]] = sum[lane]; });
        }
    }

    /// Factor that clamps indirect light: see integrate/stages/indirect_clamp.h. light: before multiplication by
    /// throughput.
    [[gnu::noinline]] Float indirect_scale(UInt path, Spectrum light, Mask m)
    {
        PathPool& p = *paths_;
        Spectrum brought;
        for (int c = 0; c < channels; ++c) brought.c[c] = p.throughput.c[c].gather(path, m) * light.c[c];
        const UInt surfaces = p.state.gather(path, m) & UInt(PathPool::bounce_mask);
        return fathom::indirect_scale(p, path, surfaces, brought, m);
    }

    /// Lanes of m whose primitive, on a shape that emits, has a black emission texture.
    Mask is_black(UInt primitive, UInt instance, Mask m) const
    {
        if (tables_.black_lights.empty() || none(m)) return Mask(false);
        const UInt light = surfaces_.light_of(scene_.shape_of(primitive, instance, m), primitive, m);
        m &= light != UInt(no_index);
        return m & (gather(tables_.black_lights.data(), light, m) != UInt(0u));
    }

    /// Adds the emission of the surfaces that the listed paths hit, MIS-weighted against light sampling.
    void add_emission(std::size_t at, Mask m)
    {
        const PathPool& p = *paths_;
        const UInt index = emitting_.load(at);
        const SurfaceHit hit = gather_hit(index, m);
        const Surface s = surfaces_.read(hit, m);
        const LaneFeatures features = materials_.features(s.material, m);
        const UInt state = p.state.gather(index, m);
        const auto has = [](UInt bits, std::uint32_t flag) { return (bits & UInt(flag)) != UInt(0u); };
        // Unlit materials are visible to camera and mirror rays but do not illuminate other surfaces.
        const Mask would_light = features.has(MaterialFeature::unlit) & has(state, PathPool::scattered);
        const Mask two_sided = features.has(MaterialFeature::two_sided_emission);
        const Mask shows = m & (two_sided | (dot(hit.d, s.ng) < Float(0))) & !would_light;
        const Spectrum emitted = materials_.emission(s, features, m);
        const Mask specular = has(state, PathPool::specular);
        Float weight(1.f);
        if (lights_are_sampled_) {
            const UInt light = surfaces_.light_of(s.shape, hit.primitive, m);
            if (const Mask shared = shows & (light != UInt(no_index)) & !specular; any(shared)) {
                const UInt number = select(shared, light, UInt(0u));
                const Float pdf = p.bsdf_pdf.gather(index, m);
                const Float exit_offset = scene_.has(Feature::exit_offsets) ? p.exit_offset.gather(index, m) : Float(0);
                weight = select(shared,
                                lights_.emission_weight_of(number, fma(hit.d, -exit_offset, hit.o), hit.time, hit.d,
                                                           hit.t + exit_offset, hit.u, pdf, shared),
                                weight);
            }
        }
        if (columns_.has(PathColumn::light_tracing) && lights_are_sampled_)
            weight = weight * weight_of_emission(index, hit, s, specular, shows);
        add_radiance(emitting_, at, select(shows, emitted, Spectrum(Float(0))), weight, m);
    }
    /// Weight of emission that the paths of these numbers hit, against light tracing.
    [[gnu::noinline]] Float weight_of_emission(UInt index, const SurfaceHit& hit, const Surface& s, Mask specular,
                                               Mask m) const
    {
        const PathPool& p = *paths_;
        const UInt light = surfaces_.light_of(s.shape, hit.primitive, m);
        const Float connection = p.connection.gather(index, m);
        m &= (light != UInt(no_index)) & (connection >= Float(0));
        if (none(m)) return Float(1);
        const UInt number = select(m, light, UInt(0u));
        const Float offset = scene_.has(Feature::exit_offsets) ? p.exit_offset.gather(index, m) : Float(0);
        const Vec3 o = fma(hit.d, -offset, hit.o);
        const Float distance = hit.t + offset;
        const Float nee_pdf = lights_.density_of(number, o, hit.time, hit.d, distance, hit.u, m);
        return select(m,
                      weight_against_light_paths(index, number, o, hit.d, distance, hit.time,
                                                 select(specular, Float(0), nee_pdf), m),
                      Float(1));
    }
    /// Weight of light that the closures of these paths found along d, against light tracing. nee_pdf: density of
    /// sampling it at the last vertex; 0 after a delta lobe.
    Float weight_against_light_paths(UInt index, UInt light, const Vec3& o, const Vec3& d, Float distance, Float time,
                                     Float nee_pdf, Mask m) const
    {
        const Float emission = emitter_.density(light, o, d, distance, time, m) * Float(float(settings_.light_paths));
        const Float scatter_pdf = paths_->scatter_pdf.gather(index, m);
        const Float weight =
            path_tracing_weight(paths_->connection.gather(index, m), emission,
                                path_variants(nee_pdf, abs(scatter_pdf), scatter_pdf < Float(0), Mask(false)));
        if (!columns_.has(PathColumn::gathered)) return weight;
        const Mask is_in_photons = (paths_->gathered.gather(index, m) == UInt(PathPool::caustics_before)) &
                                   (emission > Float(0)) & emitter_.makes_caustics(light, d, m);
        return select(is_in_photons, Float(0), weight);
    }

    void add_environment(std::size_t at, Mask m)
    {
        const PathPool& p = *paths_;
        const UInt index = missing_.load(at);
        const Vec3 d = p.direction.gather(index, m);
        const UInt state = p.state.gather(index, m);
        const Mask specular = (state & UInt(PathPool::specular)) != UInt(0u);
        const Mask from_camera = (state & UInt(PathPool::bounce_mask)) == UInt(0u);
        const Float pdf = p.bsdf_pdf.gather(index, m);
        const Spectrum radiance =
            lights_.environment(settings_.background, lights_are_sampled_, d, from_camera, specular, pdf, m);
        Float weight(1.f);
        if (columns_.has(PathColumn::light_tracing) && lights_are_sampled_ && tables_.environment.light != no_index) {
            const Mask found = m & (p.connection.gather(index, m) >= Float(0));
            const Float nee_pdf = select(specular, Float(0), lights_.environment_density(d));
            weight =
                select(found,
                       weight_against_light_paths(index, UInt(tables_.environment.light), p.origin.gather(index, m), d,
                                                  Float(infinity), Float(0), nee_pdf, found),
                       Float(1));
        }
        add_radiance(missing_, at, radiance, weight, m);
    }

    // ------------------------------------------------------------------------------------------- first hits

    /// Adds the auxiliary layers (albedo, normal, depth, ids) of paths that come straight from the camera.
    void add_first_hits(std::size_t active)
    {
        const PathPool& p = *paths_;
        for (std::size_t i = 0; i < active; i += lanes) {
            const UInt state = p.state.load(i);
            const Mask valid = first_lanes(active - i);
            if (scene_.has(Feature::open_media))
                first_hits_.add_scattered(PathPool::pixel_of(state),
                                          valid & (hits_.t.load(i) == Float(MediumStage::scattered_first)));
            const Mask m = valid & ((state & UInt(PathPool::bounce_mask)) == UInt(0u));
            const Mask hits = m & (hits_.primitive.load(i) != UInt(no_index));
            if (none(hits)) continue;
            SurfaceHit hit = gather_hit(iota() + UInt(std::uint32_t(i)), hits);
            if (scene_.has(Feature::mixtures)) hit.material = hits_.material.load(i);
            if (scene_.has(Feature::open_media)) {
                // Depth counts from the camera, which lies before all open boundaries that the ray has passed.
                const Float way = p.exit_offset.load(i);
                hit.o = fma(hit.d, -way, hit.o), hit.t = hit.t + way;
            }
            first_hits_.add(hit, p.media.load(i), PathPool::pixel_of(state), p.reversed_index.load(i), hits);
        }
    }

    const LaneScene& scene_;
    const SceneTables& tables_;
    const SurfaceReader surfaces_;
    const MaterialReader materials_;
    const LightSampler lights_;
    const LightEmitter emitter_;
    const KernelSettings& settings_;
    const KernelJob& job_;
    const bool lights_are_sampled_;
    const PathColumns columns_;
    const MediumStack camera_media_;
    const CameraPaths camera_paths_;
    FirstHits first_hits_;
    TileSums& sums_;
    KernelCounters& counters_;
    StageClock clock_;
    std::uint32_t next_ = 0;  ///< number of the job's next path

    PathPool pools_[2];
    PathPool *paths_ = &pools_[0], *spare_ = &pools_[1];
    HitColumns hits_;
    PoolSorter sorter_;
    CameraPassThrough see_through_;
    MixtureStage mixtures_;
    PathRecorder recorder_;
    PathProfiler profiler_;
    MediumStage walk_;
    ShadeStage shade_;
    Column<std::uint32_t> emitting_, missing_, finished_, walking_;
};

}  // namespace

}  // namespace FATHOM_LANES

void render_job(const KernelScene& scene, const CameraRecord& camera, const KernelSettings& settings,
                const KernelJob& job, TileSums& sums, KernelCounters& counters)
{
    const auto& lane_scene = static_cast<const LaneScene&>(scene);
    // Tracers are too large for small stacks. They stay uninitialized because every stage writes its outputs before the
    // next stage reads them.
    const auto run = [&]<class Tracer>(std::type_identity<Tracer>) {
        const std::unique_ptr<Tracer> tracer(new Tracer(lane_scene, camera, settings, job, sums, counters));
        tracer->run();
    };
    if (!lane_scene.has(Feature::only_quads) || settings.clamp_indirect > 0 || settings.light_paths > 0 || job.profile)
        run(std::type_identity<PathTracer>());
    // The quad loops do not record paths: they are faster without guiding than the general loop is with it.
    else if (job.records)
        return;
    else if (lane_scene.has(Feature::only_plain_quads))
        run(std::type_identity<QuadTracer<true>>());
    else
        run(std::type_identity<QuadTracer<false>>());
}

}  // namespace fathom
