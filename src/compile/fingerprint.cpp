// SPDX-License-Identifier: Apache-2.0
#include "compile/fingerprint.h"

namespace fathom {

std::uint64_t Fingerprints::all() const
{
    Fingerprint f;
    f.add(this, sizeof *this);
    return f.value();
}

std::uint64_t fingerprint_vertices(const GeometryTables& t)
{
    Fingerprint f;
    f.add(t.positions), f.add(t.normals), f.add(t.tangents), f.add(t.vertex_times);
    return f.value();
}

std::uint64_t fingerprint_geometry(const GeometryTables& t)
{
    Fingerprint f;
    f.add(t.colors), f.add(t.uv0), f.add(t.uv1);
    f.add(t.triangles), f.add(t.quads), f.add(t.spheres), f.add(t.disks), f.add(t.curves), f.add(t.curve_points);
    f.add(t.points), f.add(t.frames), f.add(t.shape_of_primitive);
    f.add(&t.origin, sizeof t.origin), f.add(&t.render_scale, sizeof t.render_scale);
    return f.value();
}

std::uint64_t fingerprint_materials(const SceneTables& t)
{
    Fingerprint f;
    f.add(t.materials), f.add(t.layers), f.add(t.disney), f.add(t.measured), f.add(t.measured_values),
        f.add(t.mixtures), f.add(t.media), f.add(t.texels), f.add(t.environment.texels);
    f.add(t.picture_texels);
    f.add(t.ramp_stops), f.add(t.texture_spaces);
    for (const auto& image : t.packed_images) f.add(image);
    for (const TextureRecord& texture : t.textures) {
        // Hashes members individually, since the record may have padding.
        f.add(&texture.texels, sizeof texture.texels);
        f.add(&texture.uv_map, sizeof texture.uv_map);
        f.add(&texture.scale, 3 * sizeof(float));
        f.add(&texture.direction, sizeof texture.direction);
        f.add(&texture.factor, sizeof texture.factor);
        f.add(&texture.color_a, sizeof texture.color_a);
        f.add(&texture.color_b, sizeof texture.color_b);
        const std::uint32_t numbers[] = {texture.kind,
                                         texture.format,
                                         std::uint32_t(texture.width),
                                         std::uint32_t(texture.height),
                                         texture.wrap_u,
                                         texture.wrap_v,
                                         texture.nearest,
                                         texture.uv_set,
                                         texture.mapping,
                                         texture.space,
                                         texture.octaves,
                                         texture.texture_a,
                                         texture.texture_b,
                                         texture.factor_texture,
                                         texture.factor_channel,
                                         texture.first_stop,
                                         texture.stop_count};
        f.add(numbers, sizeof numbers);
    }
    return f.value();
}

std::uint64_t fingerprint_instances(const SceneTables& t)
{
    Fingerprint f;
    f.add(t.shapes), f.add(t.instances), f.add(t.poses), f.add(t.lights), f.add(t.light_cdf);
    f.add(t.light_pictures);
    const EnvironmentRecord& e = t.environment;
    f.add(&e.kind, sizeof e.kind);
    f.add(&e.color, sizeof e.color), f.add(&e.bottom, sizeof e.bottom), f.add(&e.top, sizeof e.top);
    f.add(&e.environment_from_render, sizeof e.environment_from_render);
    return f.value();
}

}  // namespace fathom
