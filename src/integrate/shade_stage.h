#pragma once
#include "integrate/kernel.h"
#include "integrate/light_choice.h"
#include "integrate/path_end.h"
#include "integrate/pool.h"
#include "integrate/shadow_queue.h"
#include "integrate/surface.h"
#include "shading/bsdf.h"

namespace fathom::inline FATHOM_LANES {

/// What happens to paths where they meet a surface that scatters: each has a light sampled and gets its next direction.
class ShadeStage {
public:
    ShadeStage(const LaneScene& scene, const KernelSettings& settings, bool lights_are_sampled,
               KernelCounters& counters)
        : scene_(scene),
          tables_(scene.tables),
          surfaces_(scene),
          lights_(scene, surfaces_),
          settings_(settings),
          counters_(counters),
          lights_are_sampled_(lights_are_sampled),
          has_time_(scene.tables.moving),
          has_glass_(scene.has_kind(BsdfKind::glass))
    {
    }

    /// Shades paths that are packed kind by kind. kind_end: where each BsdfKind ends in the pool.
    void run(PathPool& paths, const HitArrays& hits, const std::size_t* kind_end)
    {
        paths_ = &paths, hits_ = &hits;
        shadows_.clear();
        std::size_t begin = 0;
        for (std::uint32_t kind = 1; kind < std::uint32_t(BsdfKind::count); ++kind) {
            const std::size_t end = kind_end[kind];
            if (begin < end) switch (BsdfKind(kind)) {
                    case BsdfKind::diffuse:
                        shade<DiffuseBsdf>(begin, end);
                        break;
                    case BsdfKind::metal:
                        shade<MetalBsdf>(begin, end);
                        break;
                    case BsdfKind::fuzz_metal:
                        shade<FuzzMetalBsdf>(begin, end);
                        break;
                    case BsdfKind::glass:
                        shade<GlassBsdf>(begin, end);
                        break;
                    case BsdfKind::principled:
                        shade<PrincipledBsdf>(begin, end);
                        break;
                    case BsdfKind::none:
                    case BsdfKind::count:
                        break;
                }
            begin = end;
        }
        shadows_.trace(scene_, paths);
    }

private:
    /// Samples a light for each path, then its next direction.
    template <class Bsdf>
    void shade(std::size_t begin, std::size_t end)
    {
        for (std::size_t i = begin; i < end; i += lanes) shade_gang<Bsdf>(i, first_lanes(end - i));
    }

    template <class Bsdf>
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
        const Float t = load(&hits_->t[i]);
        const Float time = has_time_ ? p.number(PathPool::time, i) : Float(0);
        Spectrum throughput = p.spectrum(PathPool::throughput, i);

        // The surface, its normals turned to the side that the path is on.
        Vec3 hit_point, ng, ns;
        Float extent;
        MaterialPoint m;
        const SurfaceHit hit{p.vector(PathPool::origin, i),
                             d,
                             t,
                             load(&hits_->u[i]),
                             load(&hits_->v[i]),
                             time,
                             load(&hits_->primitive[i]),
                             scene_.is_flat ? UInt(no_index) : load(&hits_->instance[i])};
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
        const Frame frame(ns);
        const Bsdf bsdf(m);
        const Vec3 wo = upper(frame.to_local(-d));
        const auto start = [&](Vec3 wi) {
            const Vec3 side = Bsdf::transmits ? flip_sign(ng, dot(wi, ng)) : ng;
            return offset_origin(hit_point, side, extent);
        };

        if (lights_are_sampled_) {
            // Lights are seen from where the shadow ray starts: right at the surface a light that passes through it, or
            // a distance that ends behind the light, would be one of rounding.
            const Vec3 eye = offset_origin(hit_point, ng, extent);
            const Sample2 random = sample_2d(index, pair_seed(seed, pair_light));
            const LightSample sample = lights_.sample(valid, eye, key, seed, random, time);
            light_gang(i, valid, m, bsdf, frame, wo, ng, eye, start, throughput, sample, time);
        }

        const Float choice = sample_2d(key, pair_seed(seed, pair_choice)).x;
        const BsdfSample next = bsdf.sample(wo, sample_2d(index, pair_seed(seed, pair_bsdf)), choice);
        const Vec3 wi = frame.to_world(next.wi);
        throughput = throughput * next.weight;
        // A shading normal must not send light through the surface, nor keep it from passing.
        const Float side = dot(wi, ng);
        throughput = select(equal(side > Float(0), next.wi.z > Float(0)), throughput, Spectrum(Float(0)));
        UInt next_state = (state & UInt(~PathPool::specular)) + UInt(1u);
        next_state = select(next.is_delta, next_state | UInt(PathPool::specular), next_state);
        Float eta_scale(1.f);
        if (has_glass_) {
            eta_scale = p.number(PathPool::eta_scale, i) * next.eta * next.eta;
            p.set(PathPool::eta_scale, i, eta_scale, valid);
        }
        const Mask ends = apply_roulette(settings_, key, seed, bounce, eta_scale, throughput);
        next_state = select(ends, next_state | UInt(PathPool::dead), next_state);
        p.set(PathPool::origin, i, start(wi), valid);
        p.set(PathPool::direction, i, wi, valid);
        p.set(PathPool::throughput, i, throughput, valid);
        p.set(PathPool::bsdf_pdf, i, next.pdf, valid);
        p.set(PathPool::state, i, next_state, valid);
    }

    /// Directions that rounding put below the horizon come back above it.
    static Vec3 upper(Vec3 w) { return {w.x, w.y, max(w.z, Float(1e-4f))}; }

    /// What is left after the way through the material's inside.
    Spectrum absorb(Spectrum throughput, UInt material, Float t, Mask inside, Mask m) const
    {
        const Spectrum sigma = surfaces_.material_spectrum(offsetof(MaterialRecord, absorption), material, m & inside);
        for (int c = 0; c < channels; ++c)
            throughput.c[c] = throughput.c[c] * select(inside, exp(-(sigma.c[c] * t)), Float(1));
        return throughput;
    }

    /// Adds a light sample's contribution if nothing is in the way.
    template <class Bsdf, class Start>
    [[gnu::always_inline]] void light_gang(std::size_t i, Mask valid, const MaterialPoint& m, const Bsdf& bsdf,
                                           const Frame& frame, Vec3 wo, Vec3 ng, Vec3 eye, const Start& start,
                                           const Spectrum& throughput, const LightSample& s, Float time)
    {
        PathPool& p = *paths_;
        Mask lit = valid & (s.inverse_pdf > Float(0));
        const Vec3 wi = frame.to_local(s.wi);
        lit &= bsdf.has_smooth() & equal(wi.z > Float(0), dot(s.wi, ng) > Float(0));
        if (!Bsdf::transmits) lit &= wi.z > Float(0);
        const BsdfEval e = bsdf.eval(wo, wi);
        const Float r = e.pdf * s.inverse_pdf;
        const Float weight = select(s.is_delta, Float(1), Float(1) / fma(r, r, Float(1))) * s.inverse_pdf;
        const Spectrum add = throughput * e.f_cos * s.radiance * weight;
        lit &= any_positive(add);
        if (none(lit)) return;
        counters_.rays += std::uint64_t(count(lit));
        const Vec3 o = Bsdf::transmits ? start(s.wi) : eye;
        // On the surface's other side the way is longer or shorter.
        const Float distance = Bsdf::transmits ? s.distance + dot(eye - o, s.wi) : s.distance;
        const Ray ray{o, s.wi, distance * Float(1 - 0x1p-16f), time};
        if (scene_.is_flat) {
            const Mask clear = lit & !scene_.flat.occluded(tables_, ray, lit);
            p.set(PathPool::radiance, i, p.spectrum(PathPool::radiance, i) + select(clear, add, Spectrum(Float(0))),
                  valid);
            return;
        }
        shadows_.push(ray, add, i, lit);
    }

    const LaneScene& scene_;
    const SceneTables& tables_;
    const SurfaceReader surfaces_;
    const LightChoice lights_;
    const KernelSettings& settings_;
    KernelCounters& counters_;
    bool lights_are_sampled_, has_time_, has_glass_;

    PathPool* paths_ = nullptr;
    const HitArrays* hits_ = nullptr;
    ShadowQueue shadows_;
};

}  // namespace fathom::inline FATHOM_LANES
