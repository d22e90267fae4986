// SPDX-License-Identifier: Apache-2.0
/// Light tracing: paths start at lights and are connected to the camera at every surface. They find caustics, which
/// paths from the camera meet rarely or never. Its weights against path tracing are in stages/light_tracing.h.
///
/// The loop is that of path.cpp with other stages:
///
///     emit ─▶ trace ─▶ walk ─▶ sort ─▶ connect and scatter ─▶ shadow rays ─▶ splats ─▶ emit ...
#include <algorithm>

#include "integrate/stages/adjoint.h"
#include "integrate/stages/light_media.h"
#include "integrate/stages/pool_sorter.h"
#include "integrate/stages/shade.h"
#include "integrate/stages/single_sided.h"
#include "integrate/stages/splat_pixel.h"
#include "integrate/stages/trace.h"
#include "integrate/stages/walk.h"
#include "materials/read/mixture.h"

namespace fathom {
inline namespace FATHOM_LANES {

namespace {

/// Settings of the stages that light paths share with camera paths.
KernelSettings without_light_samples(KernelSettings settings)
{
    settings.light_sampling = false;
    settings.clamp_indirect = 0;
    settings.guiding = nullptr;
    return settings;
}

class LightTracer {
public:
    LightTracer(const LaneScene& scene, const CameraRecord& camera, const KernelSettings& settings,
                const LightPathJob& job, LightPathResults& results, KernelCounters& counters)
        : scene_(scene),
          tables_(scene.tables),
          camera_(camera),
          settings_(without_light_samples(settings)),
          job_(job),
          surfaces_(scene),
          materials_(scene),
          lights_(scene, settings.light_selection, false),
          emitter_(scene, lights_, settings.light_targets),
          media_(scene, emitter_, camera.shutter_open),
          connector_(camera, settings_),
          pixels_(scene, settings_),
          light_paths_(float(settings.light_paths)),
          columns_(columns_of(scene, settings_)),
          results_(results),
          counters_(counters),
          clock_(counters, settings.measure),
          sorter_(scene),
          see_through_(scene, counters),
          mixtures_(scene),
          profiler_(nullptr, scene.tables, 0),
          walk_(scene, settings_, counters, clock_, profiler_)
    {
    }

    void run()
    {
        std::size_t active = 0;
        for (;;) {
            clock_.enter(RenderStage::camera);
            active = refill(active);
            if (active == 0) break;
            clock_.enter(RenderStage::trace);
            counters_.count_rays(RayKind::bounce, active);
            trace_paths(scene_, *paths_, hits_, 0, active, false);
            clock_.enter(RenderStage::arrival);
            active = process_hits(active);
            std::swap(paths_, spare_);
            shade(active);
            active = remove_dead_paths(*paths_, columns_, active, ended_, [](const auto&, std::size_t) {});
        }
    }

private:
    static PathColumns columns_of(const LaneScene& scene, const KernelSettings& settings)
    {
        PathColumns columns = path_columns(scene.features, settings, true);
        columns.add(PathColumn::eta_scale);
        columns.add(PathColumn::light_sampling_state);
        return columns;
    }

    // ------------------------------------------------------------------------------------------- emission

    std::size_t refill(std::size_t active)
    {
        const std::size_t added = std::min<std::size_t>(pool_capacity - active, job_.count - next_);
        std::size_t size = active;
        for (std::size_t i = 0; i < added; i += lanes)
            emit(size, job_.first + next_ + std::uint32_t(i), first_lanes(added - i));
        next_ += std::uint32_t(added);
        return size;
    }

    /// Appends light paths from number `first` on, except those that carry nothing.
    void emit(std::size_t& size, std::uint32_t first, Mask m)
    {
        const SampleKey key{UInt(hash(job_.sample + hash(settings_.seed ^ light_seed))),
                            reverse_bits(iota() + UInt(first))};
        const UInt seed = group_seed(key, UInt(0u));
        Float time(0.f);
        if (scene_.has(Feature::motion))
            time = fma(sample_2d(key, pair_seed(seed, pair_time)).x,
                       Float(camera_.shutter_close - camera_.shutter_open), Float(camera_.shutter_open));
        const LightEmitter::Emission e = emitter_.emit(
            {sample_2d(key, pair_seed(seed, pair_emitter)).x, sample_2d(key, pair_seed(seed, pair_emission_point)),
             sample_2d(key, pair_seed(seed, pair_emission_direction))},
            time, m);
        m &= any_positive(e.power);
        PathPool& p = *paths_;
        p.origin.append(size, e.o, m);
        p.direction.append(size, e.d, m);
        p.throughput.append(size, e.power * Float(1 / light_paths_), m);
        p.radiance.append(size, Spectrum(Float(0)), m);
        p.pixel_hash.append(size, key.pixel_hash, m);
        p.reversed_index.append(size, key.reversed_index, m);
        // The flag PathPool::specular tells that the path leaves photons: only delta lobes have scattered it.
        const Mask makes_caustics = results_.records_photons ? emitter_.makes_caustics(e.light, -e.d, m) : Mask(false);
        p.state.append(size, select(makes_caustics, UInt(PathPool::specular), UInt(0u)), m);
        p.bsdf_pdf.append(size, Float(0), m);
        p.exit_offset.append(size, Float(0), m);
        // Russian roulette compares the throughput with that at the start.
        p.eta_scale.append(size, Float(light_paths_) / max_component(e.power), m);
        p.time.append(size, time, m);
        const MediumStack media = media_.at(e.light, m);
        p.media.low.append(size, media.low(), m), p.media.high.append(size, media.high(), m);
        p.number.append(size, e.light, m);
        p.walk_steps.append(size, UInt(0u), m);
        if (columns_.has(PathColumn::walk_coefficients)) forget_medium(p, size);
        p.connection.append(size, Float(no_vertex), m);
        p.scatter_pdf.append(size, Float(0), m);
        size += std::size_t(count(m));
    }

    // ------------------------------------------------------------------------------------------- arrival

    /// Sorts the paths that hit a surface which scatters into the spare pool. Paths end where a medium scatters them.
    std::size_t process_hits(std::size_t active)
    {
        if (scene_.has(Feature::attenuation)) walk_.run(*paths_, hits_, active);
        if (scene_.has(Feature::mixtures)) mixtures_.choose(*paths_, hits_, active, scene_.has(Feature::motion));
        for (std::size_t i = 0; i < active; i += lanes) {
            const Mask valid = first_lanes(active - i) & !(hits_.t.load(i) < Float(0));
            const UInt primitive = hits_.primitive.load(i);
            const Mask hit = valid & (primitive != UInt(no_index));
            const UInt instance = scene_.is_flat ? UInt(no_index) : hits_.instance.load(i);
            const UInt info = scene_.shape_info_of(primitive, instance, hit);
            UInt bucket = info & UInt(LaneScene::bucket_mask);
            if (scene_.has(Feature::mixtures)) bucket = mixtures_.bucket(hits_.material.load(i), bucket, hit);
            const Mask scatters = hit & !less(bucket, UInt(1u << LaneScene::kind_shift)) &
                                  (may_scatter(settings_, paths_->state.load(i) & UInt(PathPool::bounce_mask)) |
                                   ((info & UInt(LaneScene::passes_without_bounce)) != UInt(0u)));
            sorter_.set_bucket(i, select(scatters, bucket, UInt(0u)));
        }
        clock_.enter(RenderStage::sort);
        return sorter_.run(*paths_, *spare_, columns_, hits_, active);
    }

    // ------------------------------------------------------------------------------------------- vertices

    void shade(std::size_t active)
    {
        shadows_.clear();
        connections_ = 0;
        std::size_t begin = 0;
        for (std::uint32_t kind = 0; kind < closure_kind_count; ++kind) {
            const std::size_t end = sorter_.kind_end()[kind];
            if (begin < end)
                Closures::visit(ClosureKind(kind), [&]<class Closure>() {
                    for (std::size_t i = begin; i < end; i += lanes) visit<Closure>(i, first_lanes(end - i));
                });
            begin = end;
        }
        clock_.enter(RenderStage::shadow);
        if (traces_from_camera())
            trace_connections();
        else
            counters_.costs.clear_shadow_rays += shadows_.trace(scene_, *paths_, settings_, clock_);
        clock_.enter(RenderStage::film);
        splat(active);
    }

    /// A gang of light paths at a surface.
    struct Vertex {
        std::size_t i;
        Mask valid;
        SurfaceHit hit;
        MediumStack media;
        VertexRandom random;
        UInt state, bounce;
        Spectrum throughput;  ///< on arrival
        /// Lanes whose path has no vertex before this one: their light may be sampled here by the path tracer.
        Mask is_first;
        UInt light;
        Float distance;   ///< from the light, for the lanes of is_first
        Mask unhittable;  ///< is_first and the light is one that rays do not hit
    };

    template <class Closure>
    void visit(std::size_t i, Mask valid)
    {
        clock_.enter(RenderStage::surface);
        count_vertices(counters_, valid);
        const Vertex v = load_vertex(i, valid);
        if (results_.records_arrivals) record_arrivals(v);
        PathPool& p = *paths_;
        p.radiance.store(i, Spectrum(Float(0)), valid);
        if constexpr (Closure::is_fiber) {
            p.state.store(i, v.state | UInt(PathPool::dead), valid);
        } else {
            ShadingPoint<Closure> at = read_point<Closure>(v, v.hit, v.media);
            const Mask sees_camera = may_scatter(settings_, v.bounce) & valid;
            if (any(sees_camera)) connect(v, at, sees_camera);
            if (results_.records_photons) record_photons(v, at, sees_camera);
            scatter_on(v, at);
        }
    }

    Vertex load_vertex(std::size_t i, Mask valid) const
    {
        const PathPool& p = *paths_;
        const UInt state = p.state.load(i), bounce = state & UInt(PathPool::bounce_mask);
        const SurfaceHit hit = load_hit(scene_, p, sorter_.hits(), i);
        MediumStack media;
        if (scene_.has(Feature::media_stacks)) media = p.media.load(i);
        const Mask first = valid & (p.connection.load(i) < Float(0));
        const UInt light = select(first, p.number.load(i), UInt(0u));
        // Passed boundaries are steps of a walk, which choose other random numbers.
        UInt group = bounce + UInt(1u);
        if (columns_.has(PathColumn::walk_steps)) group = group | p.walk_steps.load(i) << 16;
        return {i,
                valid,
                hit,
                media,
                VertexRandom({p.pixel_hash.load(i), p.reversed_index.load(i)}, group),
                state,
                bounce,
                p.throughput.load(i),
                first,
                light,
                hit.t + p.exit_offset.load(i),
                any(first) ? lights_.is_unhittable(light, first) : Mask(false)};
    }

    void record_arrivals(const Vertex& v)
    {
        const PathPool& p = *paths_;
        float distance[lanes], pdf[lanes];
        store(distance, v.distance);
        store(pdf, emitter_.own_density(v.light, -v.hit.d, v.distance, v.hit.time, v.is_first).direction);
        for (std::size_t k = 0; k < lanes; ++k) {
            const std::size_t i = v.i + k;
            if (!(mask_bits(v.is_first) >> k & 1)) continue;
            const float t = sorter_.hits().t[i];
            const Vec3f d{p.direction.x[i], p.direction.y[i], p.direction.z[i]};
            results_.arrivals.push_back({reverse_bits_scalar(p.reversed_index[i]),
                                         p.number[i],
                                         {p.origin.x[i] + d.x * t, p.origin.y[i] + d.y * t, p.origin.z[i] + d.z * t},
                                         d,
                                         distance[k],
                                         pdf[k]});
        }
    }

    /// Records the paths of m that only delta lobes have scattered, at least one, where others do.
    template <class Closure>
    [[gnu::noinline]] void record_photons(const Vertex& v, const ShadingPoint<Closure>& at, Mask m)
    {
        m &= !v.is_first & ((v.state & UInt(PathPool::specular)) != UInt(0u)) & Closure(at.material).has_non_delta();
        if (Closure::transmits) m &= !at.skips_interface;
        if (none(m)) return;
        const Vec3 vectors[3] = {at.p, -v.hit.d, at.ng};
        float values[12][lanes];
        for (int k = 0; k < 3; ++k) {
            store(values[3 * k], vectors[k].x), store(values[3 * k + 1], vectors[k].y);
            store(values[3 * k + 2], vectors[k].z), store(values[9 + k], v.throughput.c[k]);
        }
        for_each_active(m, [&](int lane) {
            const auto vector = [&](int k) { return Vec3f{values[k][lane], values[k + 1][lane], values[k + 2][lane]}; };
            const std::size_t i = v.i + std::size_t(lane);
            results_.photons.push_back({vector(0), vector(3), vector(6), vector(9), job_.sample,
                                        reverse_bits_scalar(paths_->reversed_index[i]),
                                        paths_->state[i] & PathPool::bounce_mask});
        });
    }

    template <class Closure>
    ShadingPoint<Closure> read_point(const Vertex& v, const SurfaceHit& hit, const MediumStack& media)
    {
        return read_shading_point<Closure>(surfaces_, materials_, hit,
                                           scene_.has(Feature::media_stacks) ? &media : nullptr, v.valid, clock_);
    }
    /// The vertex as the path tracer sees it: from a point at a distance along `out`. `at`: as the light path sees it.
    template <class Closure>
    ShadingPoint<Closure> seen_from(const Vertex& v, const ShadingPoint<Closure>& at, const Vec3& out, Float distance)
    {
        SurfaceHit hit = v.hit;
        hit.o = fma(out, distance, at.p);
        hit.d = -out;
        hit.t = distance;
        const Mask beyond = Closure::transmits ? dot(out, at.ng) < Float(0) : Mask(false);
        return read_point<Closure>(v, hit, select(beyond, at.media_beyond, at.media));
    }

    /// How the path tracer scatters from the light to `seen`: f_cos and density. lit: cleared where it does not.
    template <class Closure>
    BsdfEval eval_from_camera(const Vertex& v, ShadingPoint<Closure>& seen, Spectrum& throughput, Mask& lit) const
    {
        if (scene_.has(Feature::one_sided) && !Closure::transmits) {
            const LaneFeatures features = materials_.features(seen.material_index, lit & seen.inside);
            lit &= !(seen.inside & features.has(MaterialFeature::one_sided));
        }
        if constexpr (is_layered<Closure> && Closure::transmits)
            choose_channel(v.random.key, v.random.seed, seen.material, throughput);
        const Closure closure(seen.material);
        const Vec3 to_light = -v.hit.d, wi = seen.frame.to_local(to_light);
        lit &= closure.has_non_delta() & equal(wi.z > Float(0), dot(to_light, seen.ng) > Float(0));
        if (!Closure::transmits) lit &= wi.z > Float(0);
        if (Closure::transmits) lit &= !seen.skips_interface;
        return eval_for_light(closure, seen.wo, wi, v.unhittable);
    }

    /// light_end() of paths at their first vertex. scatter_pdf: density with which the path tracer samples the
    /// direction of the light by the closure. is_delta: lanes where it scatters by a delta lobe, so that it samples no
    /// light.
    Float light_end_of(const Vertex& v, const Vec3& eye, Float scatter_pdf, Mask is_delta, Mask is_direct) const
    {
        const Vec3 wi = -v.hit.d;
        const Float time = v.hit.time;
        const Float emission = emitter_.density(v.light, eye, wi, v.distance, time, v.is_first) * Float(light_paths_);
        const Float nee_pdf = lights_.any_density_of(v.light, eye, time, wi, v.distance, v.is_first);
        return light_end(emission, path_variants(select(is_delta, Float(0), nee_pdf),
                                                 select(is_delta, Float(1), scatter_pdf), is_direct, v.unhittable));
    }

    /// Connects the vertex to the camera.
    template <class Closure>
    [[gnu::noinline]] void connect(const Vertex& v, const ShadingPoint<Closure>& at, Mask m)
    {
        if (none(m & Closure(at.material).has_non_delta())) return;
        const UInt lens_seed = pair_seed(v.random.seed, pair_connection_lens);
        const CameraConnector::Connection c = connector_.connect(at.p, sample_2d(v.random.key, lens_seed));
        m &= c.valid & pixels_.may_contain(c.x, c.y);
        if (!Closure::transmits) m &= dot(c.d, at.ng) < Float(0);
        if (none(m)) return;
        ShadingPoint<Closure> seen = seen_from(v, at, -c.d, c.distance);
        m &= !passes_camera_rays(seen, m);
        Spectrum light = v.throughput;
        const BsdfEval e = eval_from_camera(v, seen, light, m);
        const Float cosine_light = max(abs(dot(v.hit.d, seen.ng)), Float(1e-20f)), cosine = abs(dot(c.d, seen.ng));
        const Float pixels = connector_.pixels_per_area(c.d, c.distance) * cosine;
        Float end = paths_->connection.load(v.i);
        if (any(v.is_first)) end = select(v.is_first, light_end_of(v, at.eye(), e.pdf, Mask(false), Mask(true)), end);
        const Float connection = pixels * e.pdf / cosine_light;
        const Float weight = light_tracing_weight(connection, end);
        // Most connections bring little that path tracing does not find with little noise: few of them are traced.
        const Float survival = min(weight * Float(1 / weight_of_sure_connection), Float(1));
        m &= sample_2d(v.random.key, pair_seed(v.random.seed, pair_connection_roulette)).x < survival;
        light = light * e.f_cos * (pixels * weight / (cosine_light * survival));
        m &= any_positive(light);
        if (none(m)) return;
        const Sample2 film = sample_2d(v.random.key, pair_seed(v.random.seed, pair_connection_film));
        film_x_.store(v.i, c.x), film_y_.store(v.i, c.y), film_u_.store(v.i, film.x), film_v_.store(v.i, film.y);
        path_ratio_.store(v.i, connection * connection * end);
        counters_.count_rays(RayKind::shadow, std::uint64_t(count(m)));
        queue(v, at, seen, c, light, m);
    }

    /// Lanes of m whose surface camera rays pass.
    template <class Closure>
    Mask passes_camera_rays(const ShadingPoint<Closure>& seen, Mask m) const
    {
        if (!scene_.has(Feature::camera_pass_through)) return Mask(false);
        const LaneFeatures features = materials_.features(seen.material_index, m);
        return features.has(MaterialFeature::hidden_from_camera) |
               (features.has(MaterialFeature::single_sided) & seen.inside);
    }

    /// Whether visibility is traced from the camera: flat scenes leave surfaces out of their list for shadow rays, and
    /// camera rays pass some surfaces that shadow rays do not.
    bool traces_from_camera() const { return scene_.is_flat || scene_.has(Feature::camera_pass_through); }

    template <class Closure>
    void queue(const Vertex& v, const ShadingPoint<Closure>& at, const ShadingPoint<Closure>& seen,
               const CameraConnector::Connection& c, Spectrum light, Mask m)
    {
        const Vec3 start = seen.start(-c.d);
        const Vec3 way = c.lens - start;
        const Float distance = sqrt(dot(way, way));
        const UInt path = iota() + UInt(std::uint32_t(v.i));
        const Mask beyond = Closure::transmits ? dot(c.d, at.ng) > Float(0) : Mask(false);
        const MediumStack media = select(beyond, at.media_beyond, at.media);
        // Rays that pass surfaces are attenuated segment by segment when they are traced.
        const bool passes = !traces_from_camera() && scene_.has(Feature::transmissive_shadows);
        if (scene_.has(Feature::attenuation) && !passes) {
            const UInt medium = media.current();
            const Spectrum extinction = gather(tables_.media, &MediumRecord::extinction, medium, m);
            light = light * select(medium == UInt(0u), Spectrum(Float(1)), transmittance(extinction, distance));
        }
        if (traces_from_camera()) {
            PathPool& to = connection_rays_;
            to.origin.append(connections_, c.lens, m);
            to.direction.append(connections_, -(way * (Float(1) / distance)), m);
            to.time.append(connections_, v.hit.time, m);
            to.throughput.append(connections_, light, m);
            to.exit_offset.append(connections_, distance * Float(1 - 0x1p-16f), m);
            to.number.append(connections_, path, m);
            connections_ += std::size_t(count(m));
            return;
        }
        const Ray ray{start, way * (Float(1) / distance), distance, v.hit.time};
        if (passes)
            shadows_.push(ray, light, media, path, Mask(false), m);
        else
            shadows_.push(ray, light, path, Mask(false), m);
    }

    /// Traces the connections from the camera; those that reach their vertex bring their light.
    void trace_connections()
    {
        if (connections_ == 0) return;
        PathPool& rays = connection_rays_;
        trace_paths(scene_, rays, connection_hits_, 0, connections_, false);
        if (scene_.has(Feature::camera_pass_through))
            see_through_.pass_surfaces(rays, connection_hits_, 0, connections_);
        for (std::size_t k = 0; k < connections_; ++k) {
            if (connection_hits_.primitive[k] != no_index && connection_hits_.t[k] < rays.exit_offset[k]) continue;
            ++counters_.costs.clear_shadow_rays;
            for (int c = 0; c < channels; ++c) paths_->radiance.c[c][rays.number[k]] = rays.throughput.c[c][k];
        }
    }

    void splat(std::size_t active)
    {
        const PathPool& p = *paths_;
        for (std::size_t i = 0; i < active; ++i) {
            float light[channels];
            bool any = false;
            for (int c = 0; c < channels; ++c) any |= (light[c] = p.radiance.c[c][i]) > 0;
            if (!any) continue;
            const SplatPixel::Place to = pixels_.choose(film_x_[i], film_y_[i], film_u_[i], film_v_[i]);
            if (!to.valid) continue;
            results_.splats.push_back({to.pixel,
                                       {light[0] * to.weight, light[1] * to.weight, light[2] * to.weight},
                                       path_ratio_[i],
                                       reverse_bits_scalar(p.reversed_index[i])});
        }
    }

    // ------------------------------------------------------------------------------------------- scattering

    template <class Closure>
    [[gnu::noinline]] void scatter_on(const Vertex& v, ShadingPoint<Closure>& at)
    {
        clock_.enter(RenderStage::scatter);
        const std::size_t i = v.i;
        PathPool& p = *paths_;
        Spectrum ignored = v.throughput;
        if constexpr (is_layered<Closure> && Closure::transmits)
            choose_channel(v.random.key, v.random.seed, at.material, ignored);
        const Closure closure(at.material);
        const Scattered next = scatter(closure, at, Guidance{}, v.random, Spectrum(Float(1)));
        UndeflectedPaths passing;
        if (passes_interfaces<Closure>(scene_))
            passing = find_undeflected(scene_, materials_, at, v.hit, next.wi, v.valid);
        const auto [undeflected, no_bounce] = passing;
        ShadingPoint<Closure> seen = seen_from(v, at, next.wi, Float(1));
        Spectrum throughput = v.throughput;
        Mask continues = v.valid & any_positive(next.throughput) & !next.enters_subsurface;
        Mask lit = continues & !next.is_delta;
        const BsdfEval e = eval_from_camera(v, seen, throughput, lit);
        const Mask delta = continues & next.is_delta & (undeflected | is_reversible(at, next.wi));
        const Spectrum scattered = e.f_cos * adjoint_factor(at.ng, v.hit.d, next.wi, next.pdf);
        const Spectrum mirrored = next.throughput * delta_adjoint_factor(at.ng, at.frame.n, v.hit.d, next);
        throughput = throughput * select(next.is_delta, select(undeflected, next.throughput, mirrored), scattered);
        continues = (lit | delta) & any_positive(throughput);

        Float end = p.connection.load(i);
        if (any(v.is_first & !undeflected))
            end = select(v.is_first, light_end_of(v, at.eye(), e.pdf, next.is_delta, Mask(false)), end);
        p.connection.store(i, end, v.valid & !undeflected);
        advance(v, at, next, throughput, continues, undeflected, no_bounce);
    }

    /// Stores the next ray, unless Russian roulette ends the path.
    template <class Closure>
    void advance(const Vertex& v, const ShadingPoint<Closure>& at, const Scattered& next, Spectrum throughput,
                 Mask continues, Mask undeflected, Mask no_bounce)
    {
        PathPool& p = *paths_;
        const std::size_t i = v.i;
        Roulette roulette = roulette_by_throughput(settings_, v.bounce, p.eta_scale.load(i), throughput);
        roulette.plays &= !no_bounce;
        Mask ends = !continues | apply_roulette(roulette, v.random.key, v.random.seed, throughput);
        if (Closure::transmits) ends |= !no_bounce & !may_scatter(settings_, v.bounce);
        const UInt kept = select(next.is_delta | undeflected, v.state, v.state & UInt(~PathPool::specular));
        UInt state = kept + select(no_bounce, UInt(0u), UInt(1u));
        if (scene_.has(Feature::open_media)) {
            const UInt step = p.walk_steps.load(i) + UInt(1u);
            p.walk_steps.store(i, step, no_bounce);
            ends |= no_bounce & !less(step, UInt(MediumStage::max_steps));
        }
        p.state.store(i, select(ends, state | UInt(PathPool::dead), state), v.valid);
        if (scene_.has(Feature::media_stacks)) {
            const Mask beyond = Closure::transmits ? dot(next.wi, at.ng) < Float(0) : Mask(false);
            p.media.store(i, select(beyond, at.media_beyond, at.media), v.valid);
        }
        const Vec3 start = at.start(next.wi);
        const Float offset = p.exit_offset.load(i) + dot(start - v.hit.o, v.hit.d);
        p.exit_offset.store(i, select(undeflected, offset, Float(0)), v.valid);
        p.origin.store(i, start, v.valid);
        p.direction.store(i, next.wi, v.valid);
        p.throughput.store(i, throughput, v.valid);
    }

    /// Separates the random numbers of light paths from those of pixels.
    static constexpr std::uint32_t light_seed = 0x6c696768;

    const LaneScene& scene_;
    const SceneTables& tables_;
    const CameraRecord& camera_;
    const KernelSettings settings_;
    const LightPathJob& job_;
    const SurfaceReader surfaces_;
    const MaterialReader materials_;
    const LightSampler lights_;
    const LightEmitter emitter_;
    const LightMedia media_;
    const CameraConnector connector_;
    const SplatPixel pixels_;
    const float light_paths_;
    const PathColumns columns_;
    LightPathResults& results_;
    KernelCounters& counters_;
    StageClock clock_;
    std::uint32_t next_ = 0;  ///< number of the job's next path, from its first

    PathPool pools_[2];
    PathPool *paths_ = &pools_[0], *spare_ = &pools_[1];
    HitColumns hits_;
    PoolSorter sorter_;
    CameraPassThrough see_through_;
    MixtureStage mixtures_;
    PathProfiler profiler_;  ///< off: only paths from the camera are profiled
    MediumStage walk_;
    ShadowQueue shadows_;
    Column<float> film_x_, film_y_, film_u_, film_v_;  ///< of the connections: positions in the image, random numbers
    Column<float> path_ratio_;                         ///< LightSplat::path_ratio of the connections
    std::size_t connections_ = 0;
    PathPool connection_rays_;  ///< from the camera: throughput holds the light, exit_offset the distance
    HitColumns connection_hits_;
    Column<std::uint32_t> ended_;
};

}  // namespace

}  // namespace FATHOM_LANES

void trace_light_paths(const KernelScene& scene, const CameraRecord& camera, const KernelSettings& settings,
                       const LightPathJob& job, LightPathResults& results, KernelCounters& counters)
{
    const std::unique_ptr<LightTracer> tracer(
        new LightTracer(static_cast<const LaneScene&>(scene), camera, settings, job, results, counters));
    tracer->run();
}

}  // namespace fathom
