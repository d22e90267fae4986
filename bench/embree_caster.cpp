// SPDX-License-Identifier: Apache-2.0
#include "embree_caster.h"

#include <algorithm>
#include <cstring>

namespace fathom::bench {

namespace {

std::array<float, 12> inverse_of(const std::array<float, 12>& m)
{
    Transform t;
    for (std::size_t i = 0; i < 12; ++i) t.m[i / 4][i % 4] = m[i];
    const Transform inverse = t.inverse();
    std::array<float, 12> rows{};
    for (std::size_t i = 0; i < 12; ++i) rows[i] = float(inverse.m[i / 4][i % 4]);
    return rows;
}

}  // namespace

EmbreeCaster::EmbreeCaster(const GeometryTables& tables, const std::string& isa, int threads, bool robust)
{
    const std::string config = "hugepages=1,threads=" + std::to_string(threads) + (isa.empty() ? "" : ",isa=" + isa);
    device_ = rtcNewDevice(config.c_str());
    rtcSetDeviceMemoryMonitorFunction(device_, &count_memory, this);
    scene_ = new_scene(robust);
    RTCScene mesh = tables.instances.empty() ? scene_ : new_scene(robust);
    add_mesh(mesh, tables);
    const double start = now(threads), cpu_start = now(1);
    rtcCommitScene(mesh);
    if (mesh != scene_) {
        for (const InstanceRecord& instance : tables.instances) add_instance(mesh, tables, instance);
        rtcReleaseScene(mesh);  // each instance holds a reference to it
        rtcCommitScene(scene_);
    }
    build_s_ = now(threads) - start;
    build_cpu_s_ = now(1) - cpu_start;
}

RTCScene EmbreeCaster::new_scene(bool robust) const
{
    RTCScene scene = rtcNewScene(device_);
    rtcSetSceneBuildQuality(scene, RTC_BUILD_QUALITY_MEDIUM);
    rtcSetSceneFlags(scene, robust ? RTC_SCENE_FLAG_ROBUST : RTC_SCENE_FLAG_NONE);
    return scene;
}

void EmbreeCaster::add_mesh(RTCScene scene, const GeometryTables& t) const
{
    RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
    const std::size_t times = std::max<std::size_t>(1, t.vertex_times.size()), n = t.positions.size() / times;
    rtcSetGeometryTimeStepCount(geometry, unsigned(times));
    for (std::size_t k = 0; k < times; ++k)
        std::memcpy(
            rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, unsigned(k), RTC_FORMAT_FLOAT3, sizeof(Vec3f), n),
            &t.positions[k * n], n * sizeof(Vec3f));
    std::memcpy(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 12, t.triangle_count()),
                t.triangles.data(), t.triangles.size() * 4);
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene, geometry);
    rtcReleaseGeometry(geometry);
}

namespace {

/// The pose as Embree's decomposition; rigid poses only.
RTCQuaternionDecomposition decomposition(const PoseRecord& pose)
{
    RTCQuaternionDecomposition q;
    rtcInitQuaternionDecomposition(&q);
    rtcQuaternionDecompositionSetQuaternion(&q, pose.rotation[3], pose.rotation[0], pose.rotation[1], pose.rotation[2]);
    rtcQuaternionDecompositionSetTranslation(&q, pose.translation[0], pose.translation[1], pose.translation[2]);
    return q;
}

}  // namespace

void EmbreeCaster::add_instance(RTCScene mesh, const GeometryTables& tables, const InstanceRecord& placed) const
{
    RTCGeometry instance = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_INSTANCE);
    rtcSetGeometryInstancedScene(instance, mesh);
    rtcSetGeometryTimeStepCount(instance, std::max(1u, placed.pose_count()));
    for (std::uint32_t k = 0; k < placed.pose_count(); ++k) {
        const RTCQuaternionDecomposition pose = decomposition(tables.poses[placed.first_pose() + k]);
        rtcSetGeometryTransformQuaternion(instance, k, &pose);
    }
    if (placed.pose_count() == 0) {
        const std::array<float, 12> transform = inverse_of(placed.object_from_render);
        rtcSetGeometryTransform(instance, 0, RTC_FORMAT_FLOAT3X4_ROW_MAJOR, transform.data());
    }
    rtcCommitGeometry(instance);
    rtcAttachGeometry(scene_, instance);
    rtcReleaseGeometry(instance);
}

EmbreeCaster::~EmbreeCaster()
{
    rtcReleaseScene(scene_);
    rtcReleaseDevice(device_);
}

bool EmbreeCaster::count_memory(void* self, ssize_t bytes, bool)
{
    auto& caster = *static_cast<EmbreeCaster*>(self);
    const std::size_t now = caster.bytes_ += std::size_t(bytes);
    std::size_t peak = caster.peak_bytes_;
    while (now > peak && !caster.peak_bytes_.compare_exchange_weak(peak, now)) {
    }
    return true;
}

namespace {

void cast_single(RTCScene scene, RTCIntersectContext& context, const RaySet& set, std::size_t first, std::size_t n,
                 Results& results)
{
    for (std::size_t i = first; i < first + n; ++i) {
        RTCRayHit r;
        const float time = set.time.empty() ? 0 : set.time[i];
        r.ray = {set.o[0][i], set.o[1][i], set.o[2][i],  0,   set.d[0][i], set.d[1][i],
                 set.d[2][i], time,        set.t_max[i], ~0u, 0,           0};
        if (set.shadow) {
            rtcOccluded1(scene, &context, &r.ray);
            results.blocked[i] = r.ray.tfar < 0;
            continue;
        }
        r.hit.geomID = r.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
        r.hit.primID = ~0u;
        rtcIntersect1(scene, &context, &r);
        results.t[i] = r.ray.tfar, results.u[i] = r.hit.u, results.v[i] = r.hit.v;
        results.primitive[i] = r.hit.primID, results.instance[i] = r.hit.instID[0];
    }
}

/// Casts rays in packets. Packet: RTCRayHit8 or RTCRayHit16.
template <int N, class Packet, class Intersect, class Occluded>
void cast_packets(const RaySet& set, std::size_t first, std::size_t n, Results& results, const Intersect& intersect,
                  const Occluded& occluded)
{
    for (std::size_t i = first; i < first + n; i += N) {
        Packet p;
        alignas(64) int valid[N];
        for (int k = 0; k < N; ++k) valid[k] = i + std::size_t(k) < first + n ? -1 : 0;
        const auto copy = [&](float* to, const std::vector<float>& from) { std::memcpy(to, &from[i], N * 4); };
        copy(p.ray.org_x, set.o[0]), copy(p.ray.org_y, set.o[1]), copy(p.ray.org_z, set.o[2]);
        copy(p.ray.dir_x, set.d[0]), copy(p.ray.dir_y, set.d[1]), copy(p.ray.dir_z, set.d[2]);
        copy(p.ray.tfar, set.t_max);
        std::memset(p.ray.tnear, 0, N * 4);
        if (set.time.empty())
            std::memset(p.ray.time, 0, N * 4);
        else
            copy(p.ray.time, set.time);
        std::memset(p.ray.mask, 0xff, N * 4);
        std::memset(p.ray.flags, 0, N * 4);
        if (set.shadow) {
            occluded(valid, p);
            for (int k = 0; k < N; ++k) results.blocked[i + std::size_t(k)] = p.ray.tfar[k] < 0;
            continue;
        }
        std::memset(p.hit.geomID, 0xff, N * 4);
        std::memset(p.hit.instID, 0xff, sizeof p.hit.instID);
        std::memset(p.hit.primID, 0xff, N * 4);
        intersect(valid, p);
        std::memcpy(&results.t[i], p.ray.tfar, N * 4);
        std::memcpy(&results.u[i], p.hit.u, N * 4);
        std::memcpy(&results.v[i], p.hit.v, N * 4);
        std::memcpy(&results.primitive[i], p.hit.primID, N * 4);
        std::memcpy(&results.instance[i], p.hit.instID[0], N * 4);
    }
}

void cast_stream(RTCScene scene, RTCIntersectContext& context, const RaySet& set, std::size_t first, std::size_t n,
                 Results& results)
{
    constexpr std::size_t size = 1024;
    struct Scratch {
        alignas(64) float zero[size], t[size], ng[3][size];
        alignas(64) std::uint32_t ones[size], id[size], flags[size], geometry[size];
        Scratch()
        {
            std::memset(this, 0, sizeof *this);
            std::memset(ones, 0xff, sizeof ones);
        }
    };
    static thread_local Scratch s;
    const auto pointer = [](const std::vector<float>& v, std::size_t i) { return const_cast<float*>(&v[i]); };
    for (std::size_t i = first; i < first + n; i += size) {
        const std::size_t m = std::min(size, first + n - i);
        float* t = set.shadow ? s.t : &results.t[i];
        std::memcpy(t, &set.t_max[i], m * 4);
        RTCRayHitNp p;
        p.ray = {pointer(set.o[0], i),
                 pointer(set.o[1], i),
                 pointer(set.o[2], i),
                 s.zero,
                 pointer(set.d[0], i),
                 pointer(set.d[1], i),
                 pointer(set.d[2], i),
                 set.time.empty() ? s.zero : pointer(set.time, i),
                 t,
                 s.ones,
                 s.id,
                 s.flags};
        if (set.shadow) {
            rtcOccludedNp(scene, &context, &p.ray, unsigned(m));
            for (std::size_t k = 0; k < m; ++k) results.blocked[i + k] = t[k] < 0;
            continue;
        }
        std::memset(s.geometry, 0xff, m * 4);
        std::memset(&results.primitive[i], 0xff, m * 4);
        std::memset(&results.instance[i], 0xff, m * 4);
        p.hit = {s.ng[0],       s.ng[1],
                 s.ng[2],       &results.u[i],
                 &results.v[i], &results.primitive[i],
                 s.geometry,    {&results.instance[i]}};
        rtcIntersectNp(scene, &context, &p, unsigned(m));
    }
}

}  // namespace

void EmbreeCaster::cast(const RaySet& set, std::size_t first, std::size_t n, Call call, bool coherent,
                        Results& results) const
{
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    context.flags = coherent ? RTC_INTERSECT_CONTEXT_FLAG_COHERENT : RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
    switch (call) {
        case single:
            return cast_single(scene_, context, set, first, n, results);
        case packet8:
            return cast_packets<8, RTCRayHit8>(
                set, first, n, results,
                [&](const int* valid, RTCRayHit8& p) { rtcIntersect8(valid, scene_, &context, &p); },
                [&](const int* valid, RTCRayHit8& p) { rtcOccluded8(valid, scene_, &context, &p.ray); });
        case packet16:
            return cast_packets<16, RTCRayHit16>(
                set, first, n, results,
                [&](const int* valid, RTCRayHit16& p) { rtcIntersect16(valid, scene_, &context, &p); },
                [&](const int* valid, RTCRayHit16& p) { rtcOccluded16(valid, scene_, &context, &p.ray); });
        default:
            return cast_stream(scene_, context, set, first, n, results);
    }
}

}  // namespace fathom::bench
