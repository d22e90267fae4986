// SPDX-License-Identifier: Apache-2.0
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

class Leader : public RankRender {
public:
    Leader(const RenderPlan& plan, const ImageOptions& files, const RenderJob& job, Summary& summary,
           Reporter& reporter)
        : RankRender(plan, files, job, summary, reporter),
          summary_(summary),
          reporter_(reporter),
          images_(plan, files, reporter),
          reports_(std::size_t(ranks_.count()))
    {
        images_.add_ground_truth(job);
    }
    ~Leader() override
    {
        for (const char* kind : {"want", "progress", "done"}) ranks_.set_handler(kind, {});
    }

    int run() override
    {
        check_same_render();
        start_dispatching();
        try {
            render_and_save();
            wait_until_done();
        } catch (const Ranks::RankLost&) {
            own_.save();
            report_saved();
            wait_for_survivors();
            throw;
        }
        return finish();
    }

private:
    void check_same_render()
    {
        const std::vector<std::string> keys = ranks_.gather("ready");
        for (int rank = 1; rank < ranks_.count(); ++rank) {
            const std::string difference = FilmKey::parse(keys[std::size_t(rank)]).difference(job_.key());
            if (!difference.empty())
                throw Ranks::RankFailure{
                    fmt::format("{} would render another image than rank 0: {}", ranks_.name(rank), difference)};
        }
    }

    /// Starts handing out ranges; the communication thread answers the other ranks.
    void start_dispatching()
    {
        const std::vector<SampleRange> todo = missing_samples(own_.film.samples(), plan_.samples.range);
        total_ = pixels_ * count_samples(todo);
        dispatcher_.emplace(todo, ranks_.count(), plan_.samples.time_s, own_.film.samples().empty());
        ranks_.set_handler("want", [this](int rank, const std::string& sample_s) {
            double seconds = 0;
            std::from_chars(sample_s.data(), sample_s.data() + sample_s.size(), seconds);
            const std::optional<SampleRange> range = hand_out(rank, seconds);
            ranks_.send(rank, "range", range ? sample_ranges_text({*range}) : "");
        });
        ranks_.set_handler("progress", [this](int rank, const std::string& bytes) { store_report(rank, bytes); });
        ranks_.set_handler("done", [this](int rank, const std::string& bytes) {
            store_report(rank, bytes);
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

    void store_report(int rank, const std::string& bytes)
    {
        const std::lock_guard lock(mutex_);
        reports_[std::size_t(rank)] = RankReport::from_bytes(bytes);
    }

    std::optional<SampleRange> next_range(double sample_s) override { return hand_out(0, sample_s); }

    RankReport all_reports(const RankReport& own)
    {
        const std::lock_guard lock(mutex_);
        RankReport all = own;
        for (const RankReport& report : reports_) all += report;
        return all;
    }

    void report_progress(const RankReport& own, bool force = false)
    {
        const RankReport all = all_reports(own);
        const double now_s = seconds_since_start();
        const double fraction = plan_.samples.time_s ? now_s / *plan_.samples.time_s
                                                     : double(all.done) / double(std::max<std::uint64_t>(total_, 1));
        reporter_.progress(fraction, now_s - start_s_, {all.done, plan_.samples.time_s ? 0 : total_, all.costs},
                           force && !plan_.samples.time_s);
    }

    /// Reports errors of other ranks, such as files that they can't write.
    void report_rank_errors()
    {
        if (interrupted()) return;
        while (const std::optional<Ranks::Message> error = ranks_.receive({"tells"}, 0))
            reporter_.error(fmt::format("{}: {}", ranks_.name(error->from), error->body));
    }

    void after_pass(const RankReport& now) override
    {
        report_rank_errors();
        report_progress(now);
        const bool is_requested = image_is_requested();
        own_.save_if_due(own_.film, is_requested);
        if (is_requested && !interrupted()) write_preview();
    }

    /// Writes the image so far, merged from all ranks.
    void write_preview()
    {
        std::optional<Film> all;
        try {
            all.emplace(job_);
            all->merge(own_.film);
        } catch (const std::bad_alloc&) {
            reporter_.error("there is not enough memory to write the image so far");
            return;
        }
        ranks_.send_to_all("order", "show");
        gather_films(ranks_, own_.film, &*all, impatience_s);
        images_.write(*all, summary_);
    }

    bool all_done(int lost = 0) const { return done_ >= ranks_.count() - 1 - lost; }
    static void pause() { std::this_thread::sleep_for(std::chrono::milliseconds(1)); }

    /// Waits until the other ranks have rendered and saved their samples. Throws Ranks::RankLost.
    void wait_until_done()
    {
        constexpr double grace_s = 0.3;
        double interrupted_s = 0;
        while (!all_done()) {
            pause();
            if (!ranks_.loss().empty()) throw Ranks::RankLost();
            if (!interrupted()) {
                report_rank_errors();
                report_progress(report_);
                if (image_is_requested()) write_preview();
                continue;
            }
            own_.save();
            if (interrupted_s == 0) interrupted_s = seconds_since_start();
            // After the death of a rank, mpirun ends the others within a second, so the report can't wait.
            if (seconds_since_start() - interrupted_s > grace_s) report_saved();
        }
        report_progress(report_, !interrupted());
    }

    /// Waits for the remaining ranks after one is lost.
    void wait_for_survivors()
    {
        constexpr double max_wait_s = 20;
        const double start_s = seconds_since_start();
        while (!all_done(1) && seconds_since_start() - start_s < max_wait_s) pause();
    }

    void report_saved()
    {
        if (!saved_is_reported_) reporter_.error(own_.resume_hint());
        saved_is_reported_ = true;
    }

    int finish()
    {
        summary_.render_s = seconds_since_start() - start_s_;
        summary_.costs = all_reports(report_).costs;
        ranks_.send_to_all("order", "collect");
        gather_films(ranks_, own_.film, &own_.film, patience_s);
        const bool was_interrupted =
            interrupted() &&
            (plan_.samples.time_s || !missing_samples(own_.film.samples(), plan_.samples.range).empty());
        summary_.samples_per_pixel = own_.film.samples_per_pixel();
        if (was_interrupted && own_.film.samples().empty()) {
            reporter_.error("interrupted before the first pass was done: no image is written");
            return exit_interrupted;
        }
        const double write_start_s = seconds_since_start();
        const bool all_saved = own_.save_merged();
        const bool all_written = images_.write(own_.film, summary_);
        const bool remove = plan_.checkpoint.file.empty() ? !saved_is_reported_ : all_saved;
        ranks_.send_to_all("order", remove ? "remove" : "leave");
        if (remove) own_.remove();
        summary_.write_s = seconds_since_start() - write_start_s;
        images_.report_result(own_.film, summary_, was_interrupted, {ErrorWatch(plan_.samples.error)});
        if (!all_written) return exit_error;
        return was_interrupted ? exit_interrupted : exit_ok;
    }

    Summary& summary_;
    Reporter& reporter_;
    ImageWriter images_;
    std::mutex mutex_;  ///< guards dispatcher_ and reports_
    std::optional<Dispatcher> dispatcher_;
    std::vector<RankReport> reports_;
    std::atomic<int> done_ = 0;
    std::uint64_t total_ = 0;
    bool saved_is_reported_ = false;
};

}  // namespace

std::unique_ptr<RankRender> make_leader(const RenderPlan& plan, const ImageOptions& files, const RenderJob& job,
                                        Summary& summary, Reporter& reporter)
{
    return std::make_unique<Leader>(plan, files, job, summary, reporter);
}

}  // namespace fathom::cli
