/// What the tree offers to its callers: plain arrays in, plain arrays out.
#include "geometry/bvh.h"

#include "geometry/bvh_neighbours.h"

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

// Sorting incoherent rays by octant, to let those of one octant share the upper part of the tree, gained up to 20 % on
// first bounces and lost as much on third ones: not done.

/// Rays [at, at + n), at most stream_size, made ready for tracing.
void prepare(const RayArrays& rays, std::size_t at, int n, float radius, StreamMemory& memory)
{
    for (int i = 0; i < n; i += lanes) {
        const std::size_t k = at + std::size_t(i);
        const Float t_max = rays.t_max ? load(rays.t_max + k) : Float(infinity);
        const Float time = rays.time ? load(rays.time + k) : Float(0);
        memory.world[i / lanes].prepare(load_vec3(rays.ox + k, rays.oy + k, rays.oz + k),
                                        load_vec3(rays.dx + k, rays.dy + k, rays.dz + k), t_max, time, radius);
        store(memory.hits.t + i, t_max);
        store(memory.hits.what + i, UInt(no_index));
        store(memory.hits.instance + i, UInt(no_index));
    }
}

void put(const BvhData& bvh, const RayHits& hits, int i, const HitArraysOut& out, std::size_t to)
{
    const BvhKey key = hits.key(bvh, i);
    out.t[to] = hits.t[i];
    out.u[to] = key & 1 ? 1 - hits.u[i] : hits.u[i];
    out.v[to] = key & 1 ? 1 - hits.v[i] : hits.v[i];
    out.primitive[to] = key == no_index ? no_index : key >> 1;
    out.instance[to] = hits.instance[i];
}

/// Too few rays that are alike are not worth a walk of their own.
constexpr int least_packet = 8;

template <bool any_hit>
void start_at_root(const BvhData& bvh, RayMask rays, Stream<any_hit>& stream)
{
    for (RayMask m = rays; m; m &= m - 1) {
        stream.defer(std::countr_zero(m), bvh.root, 0);
        stream.start(std::countr_zero(m));
    }
}

template <bool any_hit>
void trace_alike(const BvhData& bvh, RayMask rest, StreamMemory& memory, Stream<any_hit>& stream)
{
    while (rest) {
        const RayMask rays = alike(memory, rest);
        rest &= ~rays;
        if (std::popcount(rays) >= least_packet)
            PacketTraversal<any_hit>(bvh, memory, stream, rays).run();
        else
            start_at_root(bvh, rays, stream);
    }
    stream.run();
}

/// Traces the first n rays of the memory.
template <bool any_hit>
void trace(const BvhData& bvh, int n, bool coherent, StreamMemory& memory)
{
    Stream<any_hit> stream(bvh, memory);
    for (int i = 0; i < n; ++i) stream.add(i);
    const RayMask all = n == 64 ? ~RayMask(0) : (RayMask(1) << n) - 1;
    if constexpr (lanes > 1) {
        if (coherent) return trace_alike(bvh, all, memory, stream);
        if (any_hit) {
            NeighbourTraversal<any_hit> neighbours(bvh, memory, stream, all);
            if (neighbours.fits()) {
                neighbours.run();
                return stream.run();
            }
        }
    }
    start_at_root(bvh, all, stream);
    stream.run();
}

template <bool any_hit, class Put>
void trace_all(const BvhData& bvh, const RayArrays& rays, bool coherent, const Put& put_hit)
{
    static thread_local StreamMemory memory;
    for (std::size_t at = 0; at < rays.count; at += stream_size) {
        const int n = int(std::min(std::size_t(stream_size), rays.count - at));
        prepare(rays, at, n, bvh.radius, memory);
        if (!bvh.empty) trace<any_hit>(bvh, n, coherent, memory);
        for (int i = 0; i < n; ++i) put_hit(memory.hits, i, at + std::size_t(i));
    }
}

}  // namespace

void Bvh::closest(const RayArrays& rays, const HitArraysOut& hits, bool coherent) const
{
    trace_all<false>(*data_, rays, coherent,
                     [&](const RayHits& from, int i, std::size_t to) { put(*data_, from, i, hits, to); });
}

void Bvh::occluded(const RayArrays& rays, std::uint32_t* blocked, bool coherent) const
{
    trace_all<true>(*data_, rays, coherent,
                    [&](const RayHits& from, int i, std::size_t to) { blocked[to] = from.what[i] != no_index; });
}

}  // namespace fathom
