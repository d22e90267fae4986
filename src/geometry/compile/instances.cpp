// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <map>
#include <utility>

#include "compile/check_sizes.h"
#include "compile/compiler.h"
#include "geometry/compile/instancing.h"
#include "geometry/compile/poses.h"

namespace fathom {

namespace {

class InstanceCompiler {
public:
    InstanceCompiler(Compiler& c, const FlattenedScene& all, const InstancedGeometry& contents)
        : c_(c), t_(c.tables), all_(all), contents_(contents)
    {
    }

    void run()
    {
        t_.instances.clear();
        t_.poses.clear();
        t_.shapes.resize(contents_.shapes_end);
        add(false);
        t_.still_instances = std::uint32_t(t_.instances.size());
        add(true);
        t_.moving = contents_.moving || !t_.poses.empty();
        const std::string& file = c_.scene.file;
        if (vanished_ > 0)
            c_.warnings.add(fmt::format("{}: shapes that are scaled to almost zero size are ignored", file), vanished_);
        if (opaque_ > 0) c_.warnings.add(fmt::format(alpha_unsupported, file), opaque_);
    }

private:
    void add(bool movable)
    {
        for (const FlattenedShape& p : all_.shapes) {
            if (!p.instanced || p.movable != movable) continue;
            if (is_degenerate(p.render_from_node))
                ++vanished_;
            else
                add_instance(p);
        }
    }

    void add_instance(const FlattenedShape& p)
    {
        InstanceRecord instance;
        instance.mesh_shape = contents_.shapes.at(shared_geometry(c_, *p.shape));
        instance.object_id = p.object_id;
        instance.shape = shape_of(*p.shape, instance.mesh_shape);
        const Transform inverse = p.render_from_node.inverse();
        for (std::size_t i = 0; i < 12; ++i) instance.object_from_render[i] = float(inverse.m[i / 4][i % 4]);
        if (p.motion >= 0)
            instance.poses = append_poses(t_, pose_tables(all_.motions[std::size_t(p.motion)]), c_.scene.file);
        t_.instances.push_back(instance);
    }

    /// Creates a shape without primitives of its own, for the material and flags of instances. Instances of equal
    /// content and material share it, unless they emit: then each has its own lights.
    std::uint32_t shape_of(const Shape& described, std::uint32_t mesh_shape)
    {
        ShapeRecord shape = t_.shapes[mesh_shape];
        shape.material = material_index(t_, described);
        const MaterialRecord& material = t_.materials[shape.material];
        // Instances are never flipped: normals transform by the inverse transpose, which keeps their side under
        // mirroring.
        shape.flags &= ~std::uint32_t(ShapeRecord::alpha_tested);
        if (material.alpha_mode != std::uint32_t(AlphaMode::opaque)) {
            const bool is_round = shape.first_primitive >= t_.first_sphere();
            opaque_ += is_round;
            if (!is_round) shape.flags |= ShapeRecord::alpha_tested;
        }
        const auto number = std::uint32_t(t_.shapes.size());
        if (!material.features.has(MaterialFeature::emits)) {
            const auto [known, is_new] = shapes_.try_emplace({mesh_shape, shape.material}, number);
            if (!is_new) return known->second;
        }
        t_.shapes.push_back(shape);
        return number;
    }

    Compiler& c_;
    SceneTables& t_;
    const FlattenedScene& all_;
    const InstancedGeometry& contents_;
    std::size_t opaque_ = 0, vanished_ = 0;
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> shapes_;  ///< indexed by mesh_shape and material
};

}  // namespace

void compile_instances(Compiler& c, const FlattenedScene& occurrences, const InstancedGeometry& contents)
{
    InstanceCompiler(c, occurrences, contents).run();
}

}  // namespace fathom
