/// What the tree offers to its callers: plain arrays in, plain arrays out.
#include "geometry/bvh.h"

#include "geometry/bvh_single.h"

namespace fathom {

struct Bvh::Data : BvhData {};

Bvh::Bvh() : data_(std::make_unique<Data>()) {}
Bvh::~Bvh() = default;
Bvh::Bvh(Bvh&&) noexcept = default;
Bvh& Bvh::operator=(Bvh&&) noexcept = default;

void Bvh::build(const SceneTables& tables)
{
    auto data = std::make_unique<Data>();
    data->alpha_test = data_->alpha_test;
    data->alpha_context = data_->alpha_context;
    build_bvh(tables, *data);
    data->has_alpha = data->alpha_test && data->any_alpha_shape;
    data_ = std::move(data);
}

void Bvh::set_alpha_test(AlphaTest test, const void* context)
{
    data_->alpha_test = test;
    data_->alpha_context = context;
    data_->has_alpha = test && data_->any_alpha_shape;
}

const BvhStatistics& Bvh::statistics() const
{
    return data_->statistics;
}

namespace {

/// `lanes` rays from number `at` on.
void prepare(const RayArrays& rays, std::size_t at, float radius, PreparedRays& prepared)
{
    const Float t_max = rays.t_max ? load(rays.t_max + at) : Float(infinity);
    const Float time = rays.time ? load(rays.time + at) : Float(0);
    prepared.prepare(load_vec3(rays.ox + at, rays.oy + at, rays.oz + at),
                     load_vec3(rays.dx + at, rays.dy + at, rays.dz + at), t_max, time, radius);
}

void put(const HitArraysOut& hits, std::size_t i, const SingleHit& hit)
{
    hits.t[i] = hit.t;
    hits.u[i] = hit.key & 1 ? 1 - hit.u : hit.u;
    hits.v[i] = hit.key & 1 ? 1 - hit.v : hit.v;
    hits.primitive[i] = hit.key == no_index ? no_index : hit.key >> 1;
    hits.instance[i] = hit.instance;
}

}  // namespace

void Bvh::closest(const RayArrays& rays, const HitArraysOut& hits, bool coherent) const
{
    const BvhData& bvh = *data_;
    PreparedRays prepared;
    for (std::size_t at = 0; at < rays.count; at += lanes) {
        prepare(rays, at, bvh.radius, prepared);
        const int n = int(std::min(std::size_t(lanes), rays.count - at));
        for (int i = 0; i < n; ++i) {
            SingleHit hit{prepared.f[PreparedRays::t_max][i]};
            if (!bvh.empty) SingleTraversal<false>(bvh, prepared, i, no_index).run(bvh.root, hit);
            put(hits, at + std::size_t(i), hit);
        }
    }
}

void Bvh::occluded(const RayArrays& rays, std::uint32_t* blocked, bool coherent) const
{
    const BvhData& bvh = *data_;
    PreparedRays prepared;
    for (std::size_t at = 0; at < rays.count; at += lanes) {
        prepare(rays, at, bvh.radius, prepared);
        const int n = int(std::min(std::size_t(lanes), rays.count - at));
        for (int i = 0; i < n; ++i) {
            SingleHit hit{prepared.f[PreparedRays::t_max][i]};
            blocked[at + std::size_t(i)] =
                !bvh.empty && SingleTraversal<true>(bvh, prepared, i, no_index).run(bvh.root, hit);
        }
    }
}

}  // namespace fathom
