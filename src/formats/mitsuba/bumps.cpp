// SPDX-License-Identifier: Apache-2.0
/// Bump and normal maps.
#include <fmt/format.h>

#include <utility>

#include "fathom/error.h"
#include "formats/mitsuba/reader.h"

namespace fathom::mitsuba {

template <class Bend>
Material Reader::bend_parts(Material mixture, const Bend& bend)
{
    for (int* part : {&mixture.mixture.material_a, &mixture.mixture.material_b})
        *part = add_material(bend(scene_.materials[std::size_t(*part)]));
    return mixture;
}

Material Reader::bumped(Material m, const FloatInput& height)
{
    if (m.kind == MaterialKind::mix || m.kind == MaterialKind::two_sided)
        return bend_parts(std::move(m), [&](const Material& part) { return bumped(part, height); });
    m.bump = height;
    return m;
}

Material Reader::normal_mapped(Material m, int map)
{
    if (m.kind == MaterialKind::mix || m.kind == MaterialKind::two_sided)
        return bend_parts(std::move(m), [&](const Material& part) { return normal_mapped(part, map); });
    m.normal_map.texture = map;
    m.map_tangents = false;
    return m;
}

bool Reader::has_normal_perturbation(const Material& m) const
{
    if (m.kind != MaterialKind::mix && m.kind != MaterialKind::two_sided)
        return m.normal_map.texture >= 0 || m.bump.texture >= 0;
    return has_normal_perturbation(scene_.materials[std::size_t(m.mixture.material_a)]) ||
           has_normal_perturbation(scene_.materials[std::size_t(m.mixture.material_b)]);
}

/// Adapts a bump or normal map to the back of a 'twosided' surface. Mitsuba mirrors directions at the surface, and with
/// them the perturbed normals; Fathom flips normals, so the tangential part of the map changes sign.
Material Reader::bumps_for_back_side(Material m)
{
    if (m.kind == MaterialKind::mix || m.kind == MaterialKind::two_sided)
        return bend_parts(std::move(m), [&](const Material& part) { return bumps_for_back_side(part); });
    m.normal_map.scale = -m.normal_map.scale;
    m.bump.value = -m.bump.value;
    return m;
}

Material Reader::bumps(Object& bsdf)
{
    const Material nested = read_nested(bsdf);
    const std::vector<const Element*> maps = bsdf.children("texture");
    if (maps.empty()) bsdf.element().fail(fmt::format("{} needs a texture", bsdf.title()));
    const float scale = float(bsdf.number("scale", 1));
    const int map = texture(*maps[0], true);
    if (bsdf.type() == "bumpmap") return bumped(nested, {scale, map, luminance_channel});
    const Texture& picture = scene_.textures[std::size_t(map)];
    if (picture.kind != TextureKind::image) {
        report(bsdf.element(), "a normal map that is not a bitmap is not supported and is ignored");
        return nested;
    }
    if (picture.color_space == ColorSpace::srgb)
        report(*maps[0],
               "8- and 16-bit normals are decoded from sRGB, as in Mitsuba: most normal maps need 'raw' to be true");
    bsdf.ignore({"flip_invalid_normals", "use_shadowing_function"});
    return normal_mapped(nested, map);
}

}  // namespace fathom::mitsuba
