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

/// A picture at the other ranks: they do what rank 0 says.
class FollowedPicture : public SharedPicture {
public:
    using SharedPicture::SharedPicture;

    int run() override
    {
        ranks_.send(0, "ready", job_.key().text());
        ranks_.wait({"start"});
        render_and_keep();
        ranks_.send(0, "done", report_.bytes());
        try {
            obey();
        } catch (...) {
            if (interrupted()) own_.keep();
            throw;
        }
        return exit_ok;
    }

private:
    /// How long an interrupt may wait for whoever waits for a message.
    static constexpr double look_s = 0.05;

    /// What rank 0 orders when all is rendered.
    void obey()
    {
        while (true) {
            if (interrupted()) {
                own_.keep();
                if (!is_answered_) hear_whether_rank_0_is_there();
            }
            const std::optional<Ranks::Message> order = ranks_.take({"order"}, look_s);
            if (order && !follow(order->body)) return;
        }
    }

    /// Where rank 0 is gone another one tells what there is: soon, as mpirun leaves no more than a second.
    void hear_whether_rank_0_is_there()
    {
        constexpr double answer_s = 0.15;
        const bool answers = ranks_.take({"noted"}, answer_s).has_value();
        if (!answers && ranks_.rank() == 1) say(fmt::format("fathom: rank 0 does not answer: {}\n", own_.kept_text()));
        is_answered_ = true;
    }

    /// Does what rank 0 orders; false after the last order.
    bool follow(const std::string& order)
    {
        if (order == "show" || order == "collect") {
            gather_films(ranks_, own_.film, nullptr, order == "show" ? impatience_s : patience_s);
            return true;
        }
        if (order == "remove") own_.remove();
        return false;
    }

    std::optional<SampleRange> next(double sample_s) override
    {
        ranks_.send(0, "want", fmt::format("{}", sample_s));
        while (!interrupted()) {
            const std::optional<Ranks::Message> message = ranks_.take({"range", "order"}, look_s);
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
        constexpr double tell_s = 0.2;
        own_.keep_now_and_then(own_.film, picture_is_wanted());
        if (interrupted()) return;
        if (seconds_since_start() - told_s_ > tell_s) {
            told_s_ = seconds_since_start();
            ranks_.send(0, "progress", now.bytes());
        }
        while (const auto order = ranks_.take({"order"}, 0)) follow(order->body);
    }

    double told_s_ = 0;
    bool is_answered_ = false;  ///< by rank 0, after an interrupt, or found not to be
};

}  // namespace

int render_over_ranks(const RenderOptions& o, const RenderPlan& plan, const PictureOptions& files, const RenderJob& job,
                      Summary summary, Reporter& reporter)
{
    if (plan.ranks->leads()) return led_picture(o, plan, files, job, summary, reporter)->run();
    return FollowedPicture(o, plan, files, job, summary, reporter).run();
}

}  // namespace fathom::cli
