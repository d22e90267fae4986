// SPDX-License-Identifier: Apache-2.0
#include "media/compile/media.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "fathom/error.h"
#include "materials/compile/inputs.h"
#include "scene/scattering.h"

namespace fathom {

namespace {

std::uint32_t number_of(Compiler& c, MediumRecord medium, const Material& m)
{
    medium.ior = medium.is_index_matched ? 1 : m.ior;
    medium.priority = std::uint32_t(std::clamp(m.interior.priority, -1000, 1000) + 1001);
    std::vector<MediumRecord>& media = c.tables.media;
    const auto known = std::find(media.begin() + 1, media.end(), medium);
    if (known == media.end() && media.size() == MediaTables::max_media)
        throw Error(c.scene.file, "", fmt::format("the scene has more than {} different media", media.size() - 1));
    const auto number = std::uint32_t(known - media.begin());
    if (known == media.end()) media.push_back(medium);
    return number;
}

}  // namespace

std::uint32_t volume_medium(Compiler& c, const Material& m, bool is_index_matched)
{
    MediumRecord medium;
    medium.is_index_matched = is_index_matched;
    const Rgb color = spectrum(m.interior.attenuation_color), scatter = spectrum(m.interior.scatter);
    if (m.interior.attenuation_distance > 0) {
        const double distance = m.interior.attenuation_distance * c.space.scale;
        double sigma_a[channels], least = 0;
        for (std::size_t i = 0; i < channels; ++i) {
            sigma_a[i] = -std::log(std::max(double(color[i]), 1e-6)) - double(scatter[i]);
            least = std::min(least, sigma_a[i]);
        }
        // If scattering exceeds extinction in a channel, absorption is raised equally in all channels, as OpenPBR
        // specifies.
        for (std::size_t i = 0; i < channels; ++i) {
            medium.scattering[i] = float(double(scatter[i]) / distance);
            medium.extinction[i] = float((sigma_a[i] - least + double(scatter[i])) / distance);
        }
        if (std::max({scatter[0], scatter[1], scatter[2]}) > 0) {
            medium.anisotropy = m.interior.scatter_anisotropy;
            medium.counts = m.interior.scatter_bounces && !is_index_matched;
        }
    }
    return number_of(c, medium, m);
}

std::uint32_t subsurface_medium(Compiler& c, const Material& m)
{
    MediumRecord medium;
    medium.anisotropy = m.subsurface.scatter_anisotropy;
    medium.is_textured =
        m.subsurface.color.texture >= 0 || m.subsurface.radius.texture >= 0 || m.subsurface.radius_scale.texture >= 0;
    const Rgb color = spectrum(m.subsurface.color.value), scale = spectrum(m.subsurface.radius_scale.value);
    for (std::size_t i = 0; i < channels; ++i) {
        const double free_path = double(m.subsurface.radius.value) * double(scale[i]) * c.space.scale;
        medium.extinction[i] = float(1 / std::max(free_path, double(min_mean_free_path)));
        medium.scattering[i] =
            float(double(medium.extinction[i]) * single_scattering_albedo(double(color[i]), double(medium.anisotropy)));
    }
    return number_of(c, medium, m);
}

}  // namespace fathom
