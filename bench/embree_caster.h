// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Embree as a ray caster: each of its calls reads Fathom's ray arrays and fills hit arrays.
#include <embree3/rtcore.h>

#include <atomic>
#include <string>
#include <vector>

#include "ray_sets.h"

namespace fathom::bench {

/// Hit arrays of a ray set: nearest hits, or `blocked` for shadow rays.
struct Results {
    std::vector<float> t, u, v;
    std::vector<std::uint32_t> primitive, instance, blocked;

    explicit Results(std::size_t n)
        : t(n + 64), u(n + 64), v(n + 64), primitive(n + 64), instance(n + 64), blocked(n + 64)
    {
    }
    HitArraysOut arrays(std::size_t first)
    {
        return {&t[first], &u[first], &v[first], &primitive[first], &instance[first]};
    }
};

/// A BVH of Embree, built from Fathom's geometry tables.
class EmbreeCaster {
public:
    enum Call { single, packet8, packet16, stream, call_count };

    /// Builds a BVH of one triangle mesh, or of its instances; vertices and instances may move.
    ///
    /// isa      as Embree's option; empty: the machine's best
    /// threads  for construction
    EmbreeCaster(const GeometryTables& tables, const std::string& isa, int threads, bool robust);
    ~EmbreeCaster();
    EmbreeCaster(const EmbreeCaster&) = delete;
    EmbreeCaster& operator=(const EmbreeCaster&) = delete;

    /// Casts n rays from index `first`.
    void cast(const RaySet& set, std::size_t first, std::size_t n, Call call, bool coherent, Results& results) const;

    double build_s() const { return build_s_; }
    /// Processor time of the process.
    double build_cpu_s() const { return build_cpu_s_; }
    std::size_t bytes() const { return bytes_; }
    std::size_t peak_bytes() const { return peak_bytes_; }

private:
    static bool count_memory(void* self, ssize_t bytes, bool post);
    RTCScene new_scene(bool robust) const;
    void add_mesh(RTCScene scene, const GeometryTables& tables) const;
    void add_instance(RTCScene mesh, const GeometryTables& tables, const InstanceRecord& instance) const;

    RTCDevice device_ = nullptr;
    RTCScene scene_ = nullptr;
    double build_s_ = 0, build_cpu_s_ = 0;
    std::atomic<std::size_t> bytes_{0}, peak_bytes_{0};
};

}  // namespace fathom::bench
