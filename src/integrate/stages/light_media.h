// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "integrate/stages/camera_media.h"
#include "lights/sample/emission.h"

namespace fathom {
inline namespace FATHOM_LANES {

/// Media in which light paths start: those around each light. They are found when light tracing first needs them.
class LightMedia {
public:
    LightMedia(const LaneScene& scene, const LightEmitter& emitter, float time) : scene_(scene)
    {
        if (!scene.has(Feature::media_stacks)) return;
        const std::lock_guard lock(scene.light_media_mutex);
        if (scene.light_media.empty()) find(emitter, time);
    }

    /// The stack at the start of paths from these lights.
    MediumStack at(UInt light, Mask m) const
    {
        if (!scene_.has(Feature::media_stacks)) return {};
        const std::uint32_t* const words = scene_.light_media.data();
        return {gather(words, light << 1, m), gather(words + 1, light << 1, m)};
    }

private:
    void find(const LightEmitter& emitter, float time) const
    {
        for (std::uint32_t light = 0; light < scene_.tables.lights.size(); ++light) {
            const Sample2 middle{Float(0.5f), Float(0.5f)};
            const LightEmitter::Emission e =
                emitter.emit_from({UInt(no_index), UInt(light)}, middle, middle, Float(time), first_lanes(1));
            float x[lanes], y[lanes], z[lanes];
            store(x, e.o.x), store(y, e.o.y), store(z, e.o.z);
            const float point[] = {x[0], y[0], z[0]};
            const MediumStack media = emitter.is_infinite(light) ? MediumStack() : media_at(scene_, point, time);
            std::uint32_t low[lanes], high[lanes];
            store(low, media.low()), store(high, media.high());
            scene_.light_media.push_back(low[0]), scene_.light_media.push_back(high[0]);
        }
    }

    const LaneScene& scene_;
};

}  // namespace FATHOM_LANES
}  // namespace fathom
