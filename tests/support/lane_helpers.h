// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <random>

#include "math/vec3.h"
#include "sampling/sobol.h"

namespace fathom::test {

inline float first(Float a)
{
    float x[lanes];
    store(x, a);
    return x[0];
}
inline std::uint32_t first(UInt a)
{
    std::uint32_t x[lanes];
    store(x, a);
    return x[0];
}
inline bool first(Mask m)
{
    return mask_bits(m) & 1;
}

/// Independent uniform numbers for each lane; the sequence is the same at each SIMD width.
class Random {
public:
    explicit Random(unsigned seed = 1) : engine_(seed) {}
    Float next()
    {
        float x[lanes];
        for (float& v : x) v = float(engine_() >> 8) * 0x1p-24f;
        return load(x);
    }
    Sample2 next2()
    {
        const Float x = next();
        return {x, next()};
    }

private:
    std::mt19937 engine_;
};

}  // namespace fathom::test
