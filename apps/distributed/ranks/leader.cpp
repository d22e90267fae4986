#include "distributed/ranks/leader.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <charconv>
#include <chrono>
#include <mutex>
#include <thread>

#include "commands/commands.h"
#include "distributed/ranks/dispatcher.h"
#include "distributed/ranks/gather_films.h"
#include "options/arguments.h"
#include "options/sample_plan.h"
#include "process/interrupt.h"
#include "render/image_writer.h"

namespace fathom::cli {

namespace {

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

    int run() override
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
        reports_[std::size_t(rank)] = RankReport::of(bytes);
    }

    std::optional<SampleRange> next(double sample_s) override { return hand_out(0, sample_s); }

    RankReport all_reports(const RankReport& own)
    {
        const std::lock_guard lock(mutex_);
        RankReport all = own;
        for (const RankReport& report : reports_) all += report;
        return all;
    }

    void tell_progress(const RankReport& own, bool force = false)
    {
        const RankReport all = all_reports(own);
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

    void after_pass(const RankReport& now) override
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
    std::vector<RankReport> reports_;
    std::atomic<int> done_ = 0;
    std::uint64_t total_ = 0;
    bool kept_is_told_ = false;
};

}  // namespace

std::unique_ptr<SharedPicture> led_picture(const RenderOptions& o, const RenderPlan& plan, const PictureOptions& files,
                                           const RenderJob& job, Summary& summary, Reporter& reporter)
{
    return std::make_unique<LedPicture>(o, plan, files, job, summary, reporter);
}

}  // namespace fathom::cli
