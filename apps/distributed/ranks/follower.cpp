// SPDX-License-Identifier: Apache-2.0
#include "distributed/ranks/follower.h"

#include <fmt/format.h>

#include "commands/commands.h"
#include "distributed/ranks/gather_films.h"
#include "distributed/ranks/leader.h"
#include "options/arguments.h"
#include "process/interrupt.h"
#include "process/streams.h"

namespace fathom::cli {

namespace {

/// An image at the other ranks, which follow the orders of rank 0.
class Follower : public RankRender {
public:
    using RankRender::RankRender;

    int run() override
    {
        ranks_.send(0, "ready", job_.key().text());
        ranks_.wait({"start"});
        render_and_save();
        ranks_.send(0, "done", report_.to_bytes());
        try {
            follow_orders();
        } catch (...) {
            if (interrupted()) own_.save();
            throw;
        }
        return exit_ok;
    }

private:
    /// Timeout of waiting for a message, so that interrupts are noticed.
    static constexpr double timeout_s = 0.05;

    /// Follows orders until rank 0 gives the last one.
    void follow_orders()
    {
        while (true) {
            if (interrupted()) {
                own_.save();
                if (!has_asked_rank0_) check_that_rank0_answers();
            }
            const std::optional<Ranks::Message> order = ranks_.receive({"order"}, timeout_s);
            if (order && !follow(order->body)) return;
        }
    }

    /// Rank 1 reports the saved samples if rank 0 is gone. It does so soon, since mpirun ends all ranks within a
    /// second.
    void check_that_rank0_answers()
    {
        constexpr double answer_s = 0.15;
        const bool answers = ranks_.receive({"noted"}, answer_s).has_value();
        if (!answers && ranks_.rank() == 1)
            write_stderr(fmt::format("fathom: rank 0 does not answer: {}\n", own_.resume_hint()));
        has_asked_rank0_ = true;
    }

    /// Follows one order; false if it was the last.
    bool follow(const std::string& order)
    {
        if (order == "show" || order == "collect") {
            gather_films(ranks_, own_.film, nullptr, order == "show" ? impatience_s : patience_s);
            return true;
        }
        if (order == "remove") own_.remove();
        return false;
    }

    std::optional<SampleRange> next_range(double sample_s) override
    {
        ranks_.send(0, "want", fmt::format("{}", sample_s));
        while (!interrupted()) {
            const std::optional<Ranks::Message> message = ranks_.receive({"range", "order"}, timeout_s);
            if (!message) continue;
            if (message->kind == "order") {
                follow(message->body);
                continue;
            }
            if (message->body.empty()) return {};
            return parse_sample_range(message->body);
        }
        return {};
    }

    void after_pass(const RankReport& now) override
    {
        constexpr double report_interval_s = 0.2;
        own_.save_if_due(own_.film, image_is_requested());
        if (interrupted()) return;
        if (seconds_since_start() - reported_s_ > report_interval_s) {
            reported_s_ = seconds_since_start();
            ranks_.send(0, "progress", now.to_bytes());
        }
        while (const auto order = ranks_.receive({"order"}, 0)) follow(order->body);
    }

    double reported_s_ = 0;
    bool has_asked_rank0_ = false;  ///< whether rank 0 was asked after an interrupt
};

}  // namespace

int render_over_ranks(const RenderPlan& plan, const ImageOptions& files, const RenderJob& job, Summary summary,
                      Reporter& reporter)
{
    if (plan.ranks->leads()) return make_leader(plan, files, job, summary, reporter)->run();
    return Follower(plan, files, job, summary, reporter).run();
}

}  // namespace fathom::cli
