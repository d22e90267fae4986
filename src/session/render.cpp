#include "fathom/render.h"

namespace fathom {

bool render(const Scene&, const RenderSettings&, SampleRange, Film&, const std::atomic<bool>*,
            const std::function<void(const Progress&, const Film&)>&)
{
    return true;
}
Color render_sample(const Scene&, const RenderSettings&, int, int, std::uint64_t) { return {}; }
int simd_width() { return 1; }
const char* simd_name() { return "base"; }

}  // namespace fathom
