#pragma once
#include "geometry/flat.h"
#include "integrate/kernel.h"

namespace fathom::inline FATHOM_LANES {

/// The kernel's scene: the tables, the acceleration structure, and what is worth precomputing per primitive.
struct LaneScene final : KernelScene {
    std::shared_ptr<const SceneTables> tables_owner;
    const SceneTables& tables;
    bool is_flat = false;
    FlatScene flat;
    /// Per shape: material in the low 24 bits, BsdfKind above, the emission flag on top.
    std::vector<std::uint32_t> shape_info;
    static constexpr std::uint32_t emits = 1u << 31;
    static constexpr int kind_shift = 24;
    /// Per primitive, if the scene is flat: shape_info of its shape.
    std::vector<std::uint32_t> primitive_info;
    std::vector<float> quad_normal[3];  ///< unit, by quad; padded for lookup()
    std::vector<float> material_color[channels];  ///< padded likewise
    static constexpr int small_table = 32;
    std::uint32_t kinds = 0;            ///< bit per BsdfKind that occurs
    bool textured = false;
    bool sees_environment = false;      ///< rays that leave the scene bring something

    explicit LaneScene(std::shared_ptr<const SceneTables> t);
    std::size_t memory_bytes() const override;
};

}  // namespace fathom::inline FATHOM_LANES
