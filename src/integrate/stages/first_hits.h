// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "integrate/stages/solid_boundary.h"
#include "kernel/kernel.h"

namespace fathom {
inline namespace FATHOM_LANES {

/// Auxiliary layers (albedo, normal, depth, position, ids, alpha) from the first hits of camera paths.
class FirstHits {
public:
    FirstHits(const LaneScene& scene, const CameraRecord& camera, const AovPlaces& places, TileSums& sums)
        : scene_(scene), surfaces_(scene), materials_(scene), camera_(camera), places_(places), sums_(sums)
    {
    }

    bool wanted() const { return places_.any(); }

    /// Adds the hits of the lanes `hits`, except open boundaries, which camera rays pass. media: stack of the paths;
    /// pixel: position in the job; reversed_index: see SampleKey.
    [[gnu::noinline]] void add(const SurfaceHit& hit, const MediumStack& media, UInt pixel, UInt reversed_index,
                               Mask hits)
    {
        if (none(hits)) return;
        if (!places_.need_surfaces() && !scene_.has(Feature::open_media)) return cover(pixel, hits);
        Surface s = surfaces_.read(hit, hits);
        if (scene_.has(Feature::open_media)) {
            const Mask inside = dot(hit.d, s.ng) >= Float(0);
            const Mask skips_interface = solid_boundary(materials_, s.material, media, inside, hits).skips_interface;
            hits &= !classify_interface(scene_, materials_, s.material, skips_interface, hits).open;
            if (none(hits)) return;
        }
        // Reading the material bends the normal, too.
        const bool needs_material = places_.albedo >= 0 || places_.normal >= 0;
        const Spectrum albedo = needs_material ? albedo_of(s, hits) : Spectrum(Float(0));
        const Vec3 n = flip_sign(s.ns, -dot(hit.d, s.ng));
        const Vec3 forward(Float(camera_.forward[0]), Float(camera_.forward[1]), Float(camera_.forward[2]));
        const Float depth = camera_.spherical ? hit.t : dot(s.p - hit.o, forward);
        const Vec3 world = surfaces_.in_world(s.p);
        const UInt object = surfaces_.object_of(hit, s.shape, hits);
        const Float values[] = {albedo.c[0],
                                albedo.c[1 % channels],
                                albedo.c[2 % channels],
                                n.x,
                                n.y,
                                n.z,
                                depth * Float(float(1 / scene_.tables.render_scale)),
                                world.x,
                                world.y,
                                world.z};
        put(values, pixel, hits, object, s.material, reversed_index);
    }

    /// Marks pixels as covered whose path was scattered by a medium before any surface.
    void add_scattered(UInt pixels, Mask m)
    {
        if (any(m)) cover(pixels, m);
    }

private:
    /// Adds hits to the coverage of their pixels.
    void cover(UInt pixels, Mask m)
    {
        if (places_.alpha < 0) return;
        std::uint32_t pixel[lanes];
        store(pixel, pixels);
        for_each_active(m, [&](int lane) { sums_.add_first_hit(pixel[lane], places_.alpha, 1); });
    }
    /// Base color of the surface, blended with the subsurface color by its share.
    Spectrum albedo_of(Surface& s, Mask hits) const
    {
        MaterialPoint point;
        materials_.read(s, hits, hits, point);
        if (!scene_.has(Feature::scattering_media)) return point.base_color;
        const Mask layered = hits & materials_.features(s.material, hits).has(MaterialFeature::subsurface);
        if (none(layered)) return point.base_color;
        LayersPoint layers;
        LayersReader(materials_.tables(), s, materials_.layers(s.material, layered), layered).read(layers);
        const Float share = select(layered, (Float(1) - layers.transmission) * layers.subsurface, Float(0));
        Spectrum albedo;
        for (int k = 0; k < channels; ++k)
            albedo.c[k] =
                select(share > Float(0),
                       fma(share, layers.subsurface_color.c[k] - point.base_color.c[k], point.base_color.c[k]),
                       point.base_color.c[k]);
        return albedo;
    }
    void put(const Float* values, UInt pixels, Mask hits, UInt object, UInt material, UInt reversed_index)
    {
        constexpr int value_count = 10;
        float value[value_count][lanes];
        std::uint32_t pixel[lanes], ids[3][lanes];
        for (int v = 0; v < value_count; ++v) store(value[v], values[v]);
        store(pixel, pixels);
        store(ids[0], reverse_bits(reversed_index)), store(ids[1], object), store(ids[2], material);
        for_each_active(hits, [&](int lane) {
            const std::uint32_t at = pixel[lane];
            const auto put_numbers = [&](int place, int first, int n) {
                for (int k = 0; place >= 0 && k < n; ++k) sums_.add_first_hit(at, place + k, value[first + k][lane]);
            };
            put_numbers(places_.albedo, 0, 3), put_numbers(places_.normal, 3, 3);
            put_numbers(places_.depth, 6, 1), put_numbers(places_.position, 7, 3);
            if (places_.alpha >= 0) sums_.add_first_hit(at, places_.alpha, 1);
            if (places_.hits >= 0) sums_.add_first_hit(at, places_.hits, 1);
            if (places_.ids >= 0) sums_.set_ids(at, places_.ids, ids[0][lane], ids[1][lane], ids[2][lane]);
        });
    }

    const LaneScene& scene_;
    const SurfaceReader surfaces_;
    const MaterialReader materials_;
    const CameraRecord& camera_;
    const AovPlaces& places_;
    TileSums& sums_;
};

}  // namespace FATHOM_LANES
}  // namespace fathom
