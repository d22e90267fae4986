#pragma once
#include <algorithm>
#include <vector>

#include "guiding/guidance.h"
#include "integrate/pool.h"

namespace fathom::inline FATHOM_LANES {

/// Notes the directions that paths take from surfaces, and what comes back along them.
class PathRecorder {
public:
    /// to: where records go when all paths have ended; nullptr: nothing is noted. paths: how many there will be,
    /// numbered from 0 on.
    PathRecorder(GuidingRecords* to, std::size_t paths) : to_(to)
    {
        if (!to_) return;
        turns_.resize(paths * most_turns);
        to_->radiance.resize(paths);
    }
    bool is_on() const { return to_ != nullptr; }

    /// Paths that have met `bounce` surfaces before leave p, whose normal is n, along wi.
    ///
    /// number: of each path. throughput: from there on. pdf: of having sampled wi.
    void turn(UInt number, UInt bounce, const Vec3& p, const Vec3& n, const Vec3& wi, Float pdf,
              const Spectrum& throughput, Mask m)
    {
        const Float factor = abs(dot(n, wi)) / (pdf * mean(throughput));
        m &= less(bounce, UInt(most_turns)) & (factor > Float(0)) & (factor < Float(1e30f));
        const UInt side = guiding_side(n);
        float x[lanes], y[lanes], z[lanes], factors[lanes];
        store(x, p.x), store(y, p.y), store(z, p.z), store(factors, factor);
        std::uint32_t at[lanes], sides[lanes], bins[lanes];
        store(at, number * UInt(most_turns) + bounce), store(sides, side), store(bins, guiding_bin(side, wi));
        for_each_active(m, [&](int i) {
            Turn& turn = turns_[at[i]];
            turn.record = {{x[i], y[i], z[i]}, std::uint16_t(sides[i]), std::uint16_t(bins[i]), 0};
            turn.factor = factors[i];
        });
    }
    /// Notes what the pool's paths have brought before they see what lies along their last directions.
    void arrive(const PathPool& paths, std::size_t active)
    {
        for (std::size_t i = 0; i < active; ++i) {
            const std::uint32_t bounce = paths.state[i] & PathPool::bounce_mask;
            if (bounce > 0 && bounce <= most_turns)
                turns_[first_turn(paths, i) + bounce - 1].before = radiance(paths, i);
        }
    }
    /// A path has ended.
    void end(const PathPool& paths, std::size_t i)
    {
        const float all = radiance(paths, i);
        to_->radiance[paths.number[i]] = all;
        Turn* const turns = &turns_[first_turn(paths, i)];
        for (Turn* turn = turns; turn < turns + most_turns; ++turn) {
            if (!(turn->factor > 0)) continue;
            const float back = std::max(all - turn->before, 0.f);
            turn->record.value = turn->factor * back;
        }
    }
    /// Hands all records over, path by path.
    void finish()
    {
        if (!to_) return;
        for (const Turn& turn : turns_)
            if (turn.factor > 0) to_->turns.push_back(turn.record);
    }

private:
    static constexpr std::uint32_t most_turns = 8;
    struct Turn {
        GuidingRecord record;
        float factor = 0;  ///< of radiance in the record's value; 0: there was no such turn
        float before = 0;  ///< radiance of the path up to its next surface
    };
    static std::size_t first_turn(const PathPool& paths, std::size_t i)
    {
        return std::size_t(paths.number[i]) * most_turns;
    }
    static float radiance(const PathPool& paths, std::size_t i)
    {
        float sum = 0;
        for (int k = 0; k < channels; ++k) sum += paths.radiance.c[k][i];
        return sum * (1.f / channels);
    }

    GuidingRecords* to_;
    std::vector<Turn> turns_;
};

}  // namespace fathom::inline FATHOM_LANES
