#include "picture.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <chrono>
#include <cstring>
#include <sstream>

#include "../commands.h"
#include "../interrupt.h"
#include "../sample_plan.h"
#include "../streams.h"
#include "dispatcher.h"
#include "gather_films.h"
#include "own_samples.h"
#include "ranks.h"

namespace fathom::cli {

namespace {

/// How far a rank is, as it tells rank 0.
struct Report {
    std::uint64_t done = 0;  ///< samples of pixels
    RenderCosts costs;

    std::string bytes() const { return {reinterpret_cast<const char*>(this), sizeof *this}; }
    static Report of(const std::string& bytes)
    {
        Report report;
        if (bytes.size() == sizeof report) std::memcpy(&report, bytes.data(), sizeof report);
        return report;
    }
    Report& operator+=(const Report& o)
    {
        done += o.done;
        costs += o.costs;
        return *this;
    }
};
static_assert(std::is_trivially_copyable_v<Report>);

/// What all ranks do alike: render the ranges that they get, and keep what they have.
class SharedPicture {
public:
    SharedPicture(const RenderOptions& o, const RenderPlan& plan, const PictureOptions& files, const RenderJob& job,
                  const Summary& summary, Reporter& reporter)
        : o_(o),
          plan_(plan),
          ranks_(*plan.ranks),
          job_(job),
          own_(o, plan, files, job, summary, reporter),
          start_s_(seconds_since_start())
    {
        const RenderSettings& settings = job.settings();
        const Crop crop = settings.crop.value_or(Crop{0, 0, settings.width, settings.height});
        pixels_ = std::uint64_t(crop.x1 - crop.x0) * std::uint64_t(crop.y1 - crop.y0);
    }
    virtual ~SharedPicture() = default;
    SharedPicture(const SharedPicture&) = delete;
    SharedPicture& operator=(const SharedPicture&) = delete;

protected:
    /// How long another rank may not answer once the run has been interrupted: while it may be rendering, and when it
    /// has said that it is done.
    static constexpr double impatience_s = 0.2, patience_s = 10;

    /// What to render next; sample_s: what a sample of all pixels took last.
    virtual std::optional<SampleRange> next(double sample_s) = 0;
    /// Between passes, `own_.film` being as it is to be told of.
    virtual void after_pass(const Report& now) = 0;

    void render_ranges()
    {
        learn();
        double sample_s = 0;
        while (!interrupted()) {
            const std::optional<SampleRange> range = next(sample_s);
            if (!range) return;
            const double begin_s = seconds_since_start();
            render_range(*range);
            sample_s = (seconds_since_start() - begin_s) / double(range->second - range->first);
        }
    }

    /// Renders, and keeps what there is whatever happens.
    void render_and_keep()
    {
        try {
            render_ranges();
        } catch (...) {
            own_.keep();
            throw;
        }
        if (interrupted() || !o_.checkpoint.empty()) own_.keep();
    }

    const RenderOptions& o_;
    const RenderPlan& plan_;
    Ranks& ranks_;
    const RenderJob& job_;
    OwnSamples own_;
    Report report_;
    double start_s_;
    std::uint64_t pixels_ = 0;

private:
    /// Before the first range: what that takes is to tell how fast this rank is.
    void learn()
    {
        const double begin_s = seconds_since_start();
        render(job_, {0, 0}, own_.film, &interrupted());
        if (job_.settings().guiding && job_.settings().measure)
            report_.costs.seconds[std::size_t(RenderStage::learn)] +=
                (seconds_since_start() - begin_s) * job_.settings().threads;
    }

    void render_range(SampleRange range)
    {
        const Report before = report_;
        render(job_, range, own_.film, &interrupted(), [&](const Progress& p, const Film&) {
            report_ = before;
            report_ += {p.samples_done, p.costs};
            after_pass(report_);
        });
    }
};

class FollowedPicture : public SharedPicture {
public:
    using SharedPicture::SharedPicture;

    int run()
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

    void after_pass(const Report& now) override
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

class LedPicture : public SharedPicture {
public:
    LedPicture(const RenderOptions& o, const RenderPlan& plan, const PictureOptions& files, const RenderJob& job,
               Summary& summary, Reporter& reporter)
        : SharedPicture(o, plan, files, job, summary, reporter),
          summary_(summary),
          reporter_(reporter),
          pictures_(o, plan, files, reporter),
          reports_(std::size_t(ranks_.count()))
    {
    }
    ~LedPicture() override
    {
        for (const char* kind : {"want", "progress", "done"}) ranks_.handle(kind, {});
    }

    int run()
    {
        check_that_all_render_the_same();
        begin();
        try {
            render_and_keep();
            wait_until_done();
        } catch (const Ranks::Lost&) {
            own_.keep();
            tell_kept();
            wait_for_the_rest();
            throw;
        }
        return finish();
    }

private:
    void check_that_all_render_the_same()
    {
        const std::vector<std::string> keys = ranks_.gather("ready");
        for (int rank = 1; rank < ranks_.count(); ++rank) {
            const std::string difference = FilmKey::parse(keys[std::size_t(rank)]).difference(job_.key());
            if (!difference.empty())
                throw Ranks::Other{
                    fmt::format("{} would render another picture than rank 0: {}", ranks_.name(rank), difference)};
        }
    }

    /// Lets work be handed out, to the others by the thread that takes messages.
    void begin()
    {
        const std::vector<SampleRange> todo = missing_samples(own_.film.samples(), plan_.range);
        total_ = pixels_ * count_of(todo);
        dispatcher_.emplace(todo, ranks_.count(), o_.time_s, own_.film.samples().empty());
        ranks_.handle("want", [this](int rank, const std::string& sample_s) {
            double seconds = 0;
            std::from_chars(sample_s.data(), sample_s.data() + sample_s.size(), seconds);
            const std::optional<SampleRange> range = hand_out(rank, seconds);
            ranks_.send(rank, "range", range ? text_of({*range}) : "");
        });
        ranks_.handle("progress", [this](int rank, const std::string& bytes) { take_report(rank, bytes); });
        ranks_.handle("done", [this](int rank, const std::string& bytes) {
            take_report(rank, bytes);
            ++done_;
        });
        ranks_.send_to_all("start");
    }

    std::optional<SampleRange> hand_out(int rank, double sample_s)
    {
        if (interrupted()) return {};
        const std::lock_guard lock(mutex_);
        return dispatcher_->next(rank, sample_s, seconds_since_start());
    }

    void take_report(int rank, const std::string& bytes)
    {
        const std::lock_guard lock(mutex_);
        reports_[std::size_t(rank)] = Report::of(bytes);
    }

    std::optional<SampleRange> next(double sample_s) override { return hand_out(0, sample_s); }

    Report all_reports(const Report& own)
    {
        const std::lock_guard lock(mutex_);
        Report all = own;
        for (const Report& report : reports_) all += report;
        return all;
    }

    void tell_progress(const Report& own, bool force = false)
    {
        const Report all = all_reports(own);
        const double now_s = seconds_since_start();
        const double fraction =
            o_.time_s ? now_s / *o_.time_s : double(all.done) / double(std::max<std::uint64_t>(total_, 1));
        reporter_.progress(fraction, now_s - start_s_, {all.done, o_.time_s ? 0 : total_, all.costs},
                           force && !o_.time_s);
    }

    /// What others could not do, as to write what they have.
    void tell_errors()
    {
        if (interrupted()) return;
        while (const std::optional<Ranks::Message> error = ranks_.take({"tells"}, 0))
            reporter_.error(fmt::format("{}: {}", ranks_.name(error->from), error->body));
    }

    void after_pass(const Report& now) override
    {
        tell_errors();
        tell_progress(now);
        const bool is_wanted = picture_is_wanted();
        own_.keep_now_and_then(own_.film, is_wanted);
        if (is_wanted && !interrupted()) show();
    }

    /// Writes the picture so far, of all ranks.
    void show()
    {
        std::optional<Film> all;
        try {
            all.emplace(job_);
            all->merge(own_.film);
        } catch (const std::bad_alloc&) {
            reporter_.error("there is not enough memory for a picture in between");
            return;
        }
        ranks_.send_to_all("order", "show");
        gather_films(ranks_, own_.film, &*all, impatience_s);
        pictures_.write(*all, summary_);
    }

    bool all_done(int lost = 0) const { return done_ >= ranks_.count() - 1 - lost; }
    static void pause() { std::this_thread::sleep_for(std::chrono::milliseconds(1)); }

    /// Waits until the others have rendered, and kept, what they had. Throws Ranks::Lost.
    void wait_until_done()
    {
        constexpr double at_once_s = 0.3;
        double interrupted_s = 0;
        while (!all_done()) {
            pause();
            if (!ranks_.loss().empty()) throw Ranks::Lost();
            if (!interrupted()) {
                tell_errors();
                tell_progress(report_);
                if (picture_is_wanted()) show();
                continue;
            }
            own_.keep();
            if (interrupted_s == 0) interrupted_s = seconds_since_start();
            // mpirun leaves no more than a second to those who are to tell what became of a rank that died.
            if (seconds_since_start() - interrupted_s > at_once_s) tell_kept();
        }
        tell_progress(report_, !interrupted());
    }

    /// Once one is lost.
    void wait_for_the_rest()
    {
        constexpr double longest_s = 20;
        const double start_s = seconds_since_start();
        while (!all_done(1) && seconds_since_start() - start_s < longest_s) pause();
    }

    void tell_kept()
    {
        if (!kept_is_told_) reporter_.error(own_.kept_text());
        kept_is_told_ = true;
    }

    int finish()
    {
        summary_.render_s = seconds_since_start() - start_s_;
        summary_.costs = all_reports(report_).costs;
        ranks_.send_to_all("order", "collect");
        gather_films(ranks_, own_.film, &own_.film, patience_s);
        const bool cut_short =
            interrupted() && (o_.time_s || !missing_samples(own_.film.samples(), plan_.range).empty());
        summary_.samples_per_pixel = own_.film.samples_per_pixel();
        if (cut_short && own_.film.samples().empty()) {
            reporter_.error("interrupted before the first pass was done: no picture is written");
            return exit_interrupted;
        }
        const double write_start_s = seconds_since_start();
        const bool all_kept = own_.keep_all();
        const bool all_written = pictures_.write(own_.film, summary_);
        const bool remove = o_.checkpoint.empty() ? !kept_is_told_ : all_kept;
        ranks_.send_to_all("order", remove ? "remove" : "leave");
        if (remove) own_.remove();
        summary_.write_s = seconds_since_start() - write_start_s;
        pictures_.tell(own_.film, summary_, cut_short);
        if (!all_written) return exit_error;
        return cut_short ? exit_interrupted : exit_ok;
    }

    Summary& summary_;
    Reporter& reporter_;
    PictureWriter pictures_;
    std::mutex mutex_;  ///< for the next two
    std::optional<Dispatcher> dispatcher_;
    std::vector<Report> reports_;
    std::atomic<int> done_ = 0;
    std::uint64_t total_ = 0;
    bool kept_is_told_ = false;
};

}  // namespace

int render_over_ranks(const RenderOptions& o, const RenderPlan& plan, const PictureOptions& files, const RenderJob& job,
                      Summary summary, Reporter& reporter)
{
    if (!plan.ranks->leads()) return FollowedPicture(o, plan, files, job, summary, reporter).run();
    return LedPicture(o, plan, files, job, summary, reporter).run();
}

}  // namespace fathom::cli
