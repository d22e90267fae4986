/// What the tree offers to its callers: plain arrays in, plain arrays out.
#include "geometry/bvh.h"

#include "geometry/bvh_stream.h"

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

/// Rays [at, at + n), at most stream_size, made ready for tracing.
void prepare(const RayArrays& rays, std::size_t at, int n, float radius, StreamMemory& memory)
{
    for (int i = 0; i < n; i += lanes) {
        const std::size_t k = at + std::size_t(i);
        const Float t_max = rays.t_max ? load(rays.t_max + k) : Float(infinity);
        const Float time = rays.time ? load(rays.time + k) : Float(0);
        memory.world[i / lanes].prepare(load_vec3(rays.ox + k, rays.oy + k, rays.oz + k),
                                        load_vec3(rays.dx + k, rays.dy + k, rays.dz + k), t_max, time, radius);
        alignas(64) float limits[lanes];
        store(limits, t_max);
        for (int lane = 0; lane < lanes; ++lane) memory.hits[i + lane] = {limits[lane]};
    }
}

void put(const HitArraysOut& hits, std::size_t i, const RayHit& hit)
{
    hits.t[i] = hit.t;
    hits.u[i] = hit.key & 1 ? 1 - hit.u : hit.u;
    hits.v[i] = hit.key & 1 ? 1 - hit.v : hit.v;
    hits.primitive[i] = hit.key == no_index ? no_index : hit.key >> 1;
    hits.instance[i] = hit.instance;
}

template <bool any_hit, class Put>
void trace(const BvhData& bvh, const RayArrays& rays, const Put& put_hit)
{
    static thread_local StreamMemory memory;
    for (std::size_t at = 0; at < rays.count; at += stream_size) {
        const int n = int(std::min(std::size_t(stream_size), rays.count - at));
        prepare(rays, at, n, bvh.radius, memory);
        if (!bvh.empty) {
            Stream<any_hit> stream(bvh, memory);
            for (int i = 0; i < n; ++i) stream.add(i, bvh.root);
            stream.run();
        }
        for (int i = 0; i < n; ++i) put_hit(at + std::size_t(i), memory.hits[i]);
    }
}

}  // namespace

void Bvh::closest(const RayArrays& rays, const HitArraysOut& hits, bool coherent) const
{
    trace<false>(*data_, rays, [&](std::size_t i, const RayHit& hit) { put(hits, i, hit); });
}

void Bvh::occluded(const RayArrays& rays, std::uint32_t* blocked, bool coherent) const
{
    trace<true>(*data_, rays, [&](std::size_t i, const RayHit& hit) { blocked[i] = hit.key != no_index; });
}

}  // namespace fathom
