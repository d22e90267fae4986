// SPDX-License-Identifier: Apache-2.0
/// Implementation of the BVH's public interface, which takes and returns plain arrays.
#include "geometry/bvh/bvh.h"

#include <algorithm>
#include <chrono>
#include <cstring>
#include <optional>

#include "geometry/bvh/builder/builder.h"
#include "geometry/bvh/builder/occlusion.h"
#include "geometry/bvh/traversal/short_rays.h"

namespace fathom {

struct Bvh::Data : BvhData {
    std::optional<bvh::BvhBuilder> builder;  ///< kept if the BVH may be updated
};

Bvh::Bvh() : data_(std::make_unique<Data>()) {}
Bvh::~Bvh() = default;
Bvh::Bvh(Bvh&&) noexcept = default;
Bvh& Bvh::operator=(Bvh&&) noexcept = default;

void Bvh::build(const GeometryTables& tables, BvhQuality level)
{
    const auto start = std::chrono::steady_clock::now();
    auto data = std::make_unique<Data>();
    data->alpha_test = data_->alpha_test;
    data->alpha_context = data_->alpha_context;
    data->builder.emplace(tables, *data, level).build();
    if (!tables.editable) data->builder.reset();
    data->statistics.build_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    data_ = std::move(data);
    set_alpha_test(data_->alpha_test, data_->alpha_context);
}

void Bvh::update(const std::vector<std::uint32_t>& changed)
{
    auto& builder = data_->builder;
    if (builder && !builder->update(changed)) build(*data_->tables, builder->level());
}

void Bvh::expect(const RayArrays& shadow_rays)
{
    if (!data_->empty && !data_->moving && !data_->builder) bvh::order_by_occlusion(*data_, shadow_rays);
}

void Bvh::set_alpha_test(AlphaTest test, const void* context)
{
    const std::vector<ShapeRecord>* shapes = data_->tables ? &data_->tables->shapes : nullptr;
    data_->alpha_test = test;
    data_->alpha_context = context;
    data_->has_alpha = test && shapes && std::any_of(shapes->begin(), shapes->end(), [](const ShapeRecord& shape) {
                           return shape.flags & ShapeRecord::alpha_tested;
                       });
}

bool Bvh::visit_boxes(const VisitBox& visit) const
{
    if (data_->empty || data_->moving || !BvhReference::is_node(data_->root)) return false;
    std::vector<std::uint32_t> nodes{data_->root};
    while (!nodes.empty()) {
        const BvhNode& node = data_->nodes[BvhReference::node(nodes.back())];
        nodes.pop_back();
        for (std::size_t i = 0; i < bvh_width; ++i) {
            float low[3], high[3];
            for (std::size_t k = 0; k < 3; ++k) low[k] = node.bounds[k][i], high[k] = node.bounds[k + 3][i];
            const bool is_empty = !(low[0] <= high[0]), is_divisible = BvhReference::is_node(node.child[i]);
            if (!is_empty && visit(low, high, is_divisible) && is_divisible) nodes.push_back(node.child[i]);
        }
    }
    return true;
}

float Bvh::radius() const
{
    return data_->radius;
}

const BvhStatistics& Bvh::statistics() const
{
    return data_->statistics;
}

namespace {

// Sorting incoherent rays by octant, so that they share the upper part of the tree, was tried and rejected: it gained
// up to 20 % on first bounces and lost as much on third bounces.

/// Times outside the shutter interval are clamped to it, since motion is unknown elsewhere.
void prepare_times(const GeometryTables& tables, Float time, RayTimes& times, int i)
{
    const float open = tables.shutter_open, close = tables.shutter_close;
    store(times.shutter + i, clamp((time - Float(open)) * Float(1 / (close - open)), Float(0), Float(1)));
    const KeyTime vertices = vertex_key(tables, time);
    store(times.key + i, vertices.key);
    store(times.fraction + i, vertices.fraction);
}

/// Prepares rays [at, at + n) for tracing; n is at most stream_size.
void prepare(const RayArrays& rays, std::size_t at, int n, const BvhData& bvh, StreamMemory& memory)
{
    for (int i = 0; i < n; i += lanes) {
        const std::size_t k = at + std::size_t(i);
        const Float t_max = rays.t_max ? load(rays.t_max + k) : Float(infinity);
        const Float time = rays.time ? load(rays.time + k) : Float(0);
        memory.world[i / lanes].prepare(load_vec3(rays.ox + k, rays.oy + k, rays.oz + k),
                                        load_vec3(rays.dx + k, rays.dy + k, rays.dz + k), t_max, time, bvh.radius);
        store(memory.hits.t + i, t_max);
        store(memory.hits.what + i, UInt(no_index));
        store(memory.hits.instance + i, UInt(no_index));
        if (bvh.moving) prepare_times(*bvh.tables, time, memory.times, i);
    }
}

/// Stores the hits of a stream in the arrays of a HitArraysOut.
struct PutHits {
    alignas(64) float t[stream_size], u[stream_size], v[stream_size];
    alignas(64) std::uint32_t primitive[stream_size], instance[stream_size];

    PutHits(const BvhData& bvh, const RayHits& hits, int n)
    {
        for (int i = 0; i < n; i += lanes) {
            const UInt what = load(hits.what + i);
            const Mask none = what == UInt(no_index), is_place = ((what & UInt(hit_is_index)) != UInt(0u)) & !none;
            const UInt key = select(is_place, gather(bvh.keys.data(), what & UInt(~hit_is_index), is_place), what);
            const Mask second = (key & UInt(1u)) != UInt(0u);
            const Float along = load(hits.u + i), across = load(hits.v + i);
            store(t + i, load(hits.t + i));
            store(u + i, select(second, Float(1) - along, along));
            store(v + i, select(second, Float(1) - across, across));
            store(primitive + i, select(none, UInt(no_index), key >> 1));
            store(instance + i, load(hits.instance + i));
        }
    }
};

/// Packets of fewer coherent rays are slower than single rays.
constexpr int min_packet = 8;

template <bool any_hit, bool moving>
void start_at_root(RayMask rays, Stream<any_hit, moving>& stream)
{
    for (RayMask m = rays; m; m &= m - 1) {
        stream.begin(std::countr_zero(m));
    }
}

template <bool any_hit, bool moving>
void trace_coherent(const BvhData& bvh, RayMask rest, StreamMemory& memory, Stream<any_hit, moving>& stream)
{
    while (rest) {
        const RayMask rays = coherent_rays(memory.world, rest);
        rest &= ~rays;
        if (std::popcount(rays) >= min_packet)
            PacketTraversal<any_hit, moving>(bvh, memory, stream, rays, {bvh.root, no_index, bvh.radius}).run();
        else
            start_at_root(rays, stream);
    }
    stream.run();
}

/// Traces the first n rays of the stream's memory.
template <bool any_hit, bool moving>
void trace(const BvhData& bvh, int n, bool coherent, StreamMemory& memory)
{
    Stream<any_hit, moving> stream(bvh, memory);
    const RayMask all = n == 64 ? ~RayMask(0) : (RayMask(1) << n) - 1;
    if constexpr (lanes > 1) {
        if (coherent) return trace_coherent(bvh, all, memory, stream);
        if constexpr (any_hit && !moving) {
            ShortRayPacketTraversal neighbors(bvh, memory, stream, all);
            if (neighbors.fits()) {
                neighbors.run();
                return stream.run();
            }
        }
    }
    start_at_root(all, stream);
    stream.run();
}

/// Sorts rays coarsely by time before they are cut into streams: rays of similar time see similar boxes. The order of
/// rays does not affect their hits.
class SortedByTime {
public:
    static constexpr std::size_t most = 512;

    SortedByTime(const RayArrays& rays, std::size_t first, std::size_t n, float open, float close) : first_(first)
    {
        constexpr std::size_t buckets = 8;
        const float scale = float(buckets) / (close - open);
        std::uint32_t begin[buckets + 1] = {};
        std::uint8_t bucket[most];
        for (std::size_t i = 0; i < n; ++i) {
            const float at = (rays.time[first + i] - open) * scale;
            bucket[i] = std::uint8_t(std::clamp(at, 0.f, float(buckets - 1)));
            ++begin[bucket[i] + 1];
        }
        for (std::size_t i = 0; i < buckets; ++i) begin[i + 1] += begin[i];
        for (std::size_t i = 0; i < n; ++i) order_[begin[bucket[i]]++] = std::uint32_t(i);
        const float* const from[] = {rays.ox, rays.oy, rays.oz, rays.dx, rays.dy, rays.dz, rays.time, rays.t_max};
        for (int field = 0; field < (rays.t_max ? 8 : 7); ++field)
            for (std::size_t i = 0; i < n; ++i) data_[field][i] = from[field][first + order_[i]];
        sorted = {data_[0], data_[1], data_[2],       data_[3], data_[4], data_[5], rays.t_max ? data_[7] : nullptr,
                  data_[6], n,        rays.alpha_test};
    }
    std::size_t place(std::size_t i) const { return first_ + order_[i]; }

    RayArrays sorted;

private:
    std::size_t first_;
    std::uint32_t order_[most];
    alignas(64) float data_[8][most + 64];
};

/// Traces rays in streams. put(hits, n, at) stores hits [0, n) as those of rays [at, at + n).
template <bool any_hit, class Put>
void trace_streams(const BvhData& bvh, const RayArrays& rays, bool coherent, BvhVisits* visits, const Put& put)
{
    static thread_local StreamMemory memory;
    memory.visits = {};
    memory.alpha_test = rays.alpha_test ? rays.alpha_test : bvh.alpha_test;
    for (std::size_t at = 0; at < rays.count; at += stream_size) {
        const int n = int(std::min(std::size_t(stream_size), rays.count - at));
        prepare(rays, at, n, bvh, memory);
        if (!bvh.empty)
            bvh.moving ? trace<any_hit, true>(bvh, n, coherent, memory)
                       : trace<any_hit, false>(bvh, n, coherent, memory);
        put(memory.hits, n, at);
    }
    if (!visits) return;
    visits->nodes += memory.visits.nodes;
    visits->primitives += memory.visits.primitives;
}

/// Traces rays, sorted by time if that is faster. put_in_order(hits, n, at) is as in trace_streams(); put_one(hits, i,
/// to) stores hit i as that of ray `to`.
template <bool any_hit, class PutInOrder, class Prepare, class PutOne>
void trace_all(const BvhData& bvh, const RayArrays& rays, bool coherent, BvhVisits* visits,
               const PutInOrder& put_in_order, const Prepare& prepared, const PutOne& put_one)
{
    if (!bvh.moving || !coherent || !rays.time || rays.count <= stream_size)
        return trace_streams<any_hit>(bvh, rays, coherent, visits, put_in_order);
    for (std::size_t first = 0; first < rays.count; first += SortedByTime::most) {
        const std::size_t n = std::min(SortedByTime::most, rays.count - first);
        const SortedByTime by_time(rays, first, n, bvh.tables->shutter_open, bvh.tables->shutter_close);
        trace_streams<any_hit>(bvh, by_time.sorted, true, visits, [&](const RayHits& hits, int count, std::size_t at) {
            const auto found = prepared(hits, count);
            for (int i = 0; i < count; ++i) put_one(found, i, by_time.place(at + std::size_t(i)));
        });
    }
}

}  // namespace

void Bvh::closest(const RayArrays& rays, const HitArraysOut& out, bool coherent, BvhVisits* visits) const
{
    const auto prepared = [&](const RayHits& hits, int n) { return PutHits(*data_, hits, n); };
    const auto put_in_order = [&](const RayHits& hits, int n, std::size_t at) {
        const PutHits found = prepared(hits, n);
        const std::size_t bytes = std::size_t(n) * sizeof(float);
        std::memcpy(out.t + at, found.t, bytes);
        std::memcpy(out.u + at, found.u, bytes);
        std::memcpy(out.v + at, found.v, bytes);
        std::memcpy(out.primitive + at, found.primitive, bytes);
        std::memcpy(out.instance + at, found.instance, bytes);
    };
    trace_all<false>(*data_, rays, coherent, visits, put_in_order, prepared,
                     [&](const PutHits& found, int i, std::size_t to) {
                         out.t[to] = found.t[i], out.u[to] = found.u[i], out.v[to] = found.v[i];
                         out.primitive[to] = found.primitive[i], out.instance[to] = found.instance[i];
                     });
}

void Bvh::occluded(const RayArrays& rays, std::uint32_t* blocked, bool coherent, BvhVisits* visits) const
{
    const auto put_in_order = [&](const RayHits& hits, int n, std::size_t at) {
        for (int i = 0; i < n; ++i) blocked[at + std::size_t(i)] = hits.what[i] != no_index;
    };
    const auto prepared = [](const RayHits& hits, int) { return hits.what; };
    trace_all<true>(*data_, rays, coherent, visits, put_in_order, prepared,
                    [&](const std::uint32_t* what, int i, std::size_t to) { blocked[to] = what[i] != no_index; });
}

}  // namespace fathom
