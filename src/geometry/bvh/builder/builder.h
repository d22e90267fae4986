// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <algorithm>
#include <vector>

#include "geometry/bvh/builder/items.h"
#include "geometry/bvh/layout/data.h"

namespace fathom::bvh {

/// Peak memory of construction.
struct Peak {
    std::size_t bytes = 0;
    void track_peak(std::size_t now) { bytes = std::max(bytes, now); }
};

/// Builds the BVH of scene tables, and later rebuilds the parts that have changed.
class BvhBuilder {
public:
    BvhBuilder(const GeometryTables& tables, BvhData& tree, BvhQuality level)
        : tables_(tables), tree_(tree), level_(level)
    {
    }

    /// Builds the BVH and its statistics.
    void build();
    /// See Bvh::update. Returns false if too much of the arrays is no longer used, so that the BVH must be rebuilt.
    bool update(const std::vector<std::uint32_t>& changed);
    BvhQuality level() const { return level_; }

private:
    /// A subtree within the BVH's arrays, with its own root.
    struct Part {
        std::uint32_t root = 0;
        MovingBox box;
        int depth = 0;
        bool empty = true;
    };
    struct Mesh {
        std::size_t first_triangle = 0;
        int depth = 0;
    };
    struct Place {
        std::size_t node = 0, other = 0;
    };

    std::vector<std::uint32_t> find_meshes();
    void add_mesh(std::uint32_t shape, BvhQuality level);
    std::size_t max_triangles_in(std::uint32_t shape) const;
    template <class MakeList>
    Part add_part(const MakeList& make_list, BvhQuality level);
    void add_movable();
    Part join(const Part& a, const Part& b);
    std::size_t leaves_bytes() const;

    const GeometryTables& tables_;
    BvhData& tree_;
    const BvhQuality level_;
    std::vector<Mesh> meshes_;  ///< indexed by shape
    std::vector<MovingBox> boxes_;
    Part still_;              ///< subtree of all static items, without movable ones
    Place begin_of_movable_;  ///< position in the arrays after the static subtree and the meshes
    Place most_;              ///< limits on begin_of_movable_ before the BVH must be rebuilt
    std::size_t next_triangle_ = 0;
    Peak peak_;
};

}  // namespace fathom::bvh
