// SPDX-License-Identifier: Apache-2.0
#include "report/reporter.h"

#include <fmt/format.h>
#include <sys/ioctl.h>
#include <sys/resource.h>
#include <unistd.h>
#include <algorithm>
#include <chrono>
#include <fstream>
#include <nlohmann/json.hpp>
#include <system_error>

#include "commands/commands.h"
#include "process/streams.h"
#include "report/cost_sheet.h"
#include "report/difference_report.h"

namespace fathom::cli {

namespace {

/// Columns that a line may fill: all but the last, in which some terminals wrap.
int terminal_columns()
{
    winsize size{};
    if (ioctl(STDERR_FILENO, TIOCGWINSZ, &size) != 0 || size.ws_col == 0) return 79;
    return size.ws_col - 1;
}

std::string duration_text(double seconds)
{
    if (seconds < 10) return fmt::format("{:.1f} s", seconds);
    const auto whole = std::uint64_t(std::min(seconds + 0.5, 1e15));
    if (whole < 60) return fmt::format("{} s", whole);
    if (whole < 3600) return fmt::format("{}:{:02} min", whole / 60, whole % 60);
    return fmt::format("{}:{:02} h", whole / 3600, whole / 60 % 60);
}

/// A progress bar and as much text as fits: the percentage and the remaining time are dropped last.
std::string progress_line(double done, const std::string& rate, const std::string& elapsed, const std::string& left,
                          int columns)
{
    constexpr int min_bar = 8, max_bar = 24, around_bar = 3;
    const std::string percent = fmt::format("{:5.1f} %", done * 100);
    for (const std::string& text :
         {fmt::format("{}  {}samples/s  {} elapsed, {} left", percent, rate, elapsed, left),
          fmt::format("{}  {} elapsed, {} left", percent, elapsed, left), fmt::format("{}  {} left", percent, left)}) {
        const int room = columns - int(text.size()) - around_bar;
        if (room < min_bar) continue;
        const int width = std::min(room, max_bar), full = int(done * width);
        return fmt::format("[{}{}] {}", std::string(std::size_t(full), '#'),
                           std::string(std::size_t(width - full), '.'), text);
    }
    return percent.substr(0, std::size_t(std::max(columns, 0)));
}

}  // namespace

double seconds_since_start()
{
    static const auto start = std::chrono::steady_clock::now();
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

ReportMode default_report_mode()
{
    return isatty(STDERR_FILENO) ? ReportMode::terminal : ReportMode::lines;
}

std::uint64_t peak_memory_bytes()
{
    // getrusage would include the memory of the parent process between fork and exec.
    std::ifstream status("/proc/self/status");
    for (std::string line; std::getline(status, line);)
        if (line.starts_with("VmHWM:")) return std::strtoull(line.c_str() + 6, nullptr, 10) * 1024;
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    return std::uint64_t(usage.ru_maxrss) * 1024;
}

void Reporter::print_event(const nlohmann::json& event)
{
    // File names may hold invalid UTF-8, which JSON does not allow.
    write_stderr(event.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace) + '\n');
}

void Reporter::end_open_line()
{
    if (has_open_line_) write_stderr("\n");
    has_open_line_ = false;
}

bool Reporter::is_quiet() const
{
    return mode_ == ReportMode::quiet || mode_ == ReportMode::silent;
}

void Reporter::forward(ReportHandlers handlers)
{
    mode_ = ReportMode::silent;
    handlers_ = std::move(handlers);
}

void Reporter::note(const std::string& text)
{
    if (mode_ == ReportMode::silent && handlers_.note) handlers_.note(text);
    if (is_quiet()) return;
    if (mode_ == ReportMode::json) return print_event({{"event", "note"}, {"message", text}});
    end_open_line();
    write_stderr(text + '\n');
}

void Reporter::warnings(const Warnings& warnings)
{
    if (mode_ == ReportMode::silent) {
        if (handlers_.warnings) handlers_.warnings(warnings);
        return;
    }
    end_open_line();
    for (const auto& [message, count] : warnings.counts()) {
        if (mode_ == ReportMode::json)
            print_event({{"event", "warning"}, {"message", message}, {"count", count}});
        else
            write_stderr(
                fmt::format("fathom: warning: {}{}\n", message, count > 1 ? fmt::format(" ({} times)", count) : ""));
    }
}

void Reporter::error(const std::string& text)
{
    if (mode_ == ReportMode::silent) {
        if (handlers_.error) handlers_.error(text);
        return;
    }
    end_open_line();
    if (mode_ == ReportMode::json)
        print_event({{"event", "error"}, {"message", text}});
    else
        write_stderr(fmt::format("fathom: {}\n", text));
}

void Reporter::written(const std::string& file)
{
    if (mode_ == ReportMode::json) return print_event({{"event", "written"}, {"file", file}});
    note("wrote " + file);
}

double Reporter::interval_s() const
{
    return mode_ == ReportMode::terminal ? 0.1 : mode_ == ReportMode::json ? 0.5 : 10;
}

Reporter::Phase::Phase(Reporter& reporter, std::string name, std::string text)
    : reporter_(reporter), name_(std::move(name)), text_(std::move(text))
{
    if (reporter.is_quiet()) return;
    try {
        thread_ = std::thread([this] { run(); });
    } catch (const std::system_error&) {
        // Without a thread, the phase is not reported.
    }
}

Reporter::Phase::~Phase()
{
    if (!thread_.joinable()) return;
    {
        const std::lock_guard lock(mutex_);
        end_ = true;
    }
    ended_.notify_one();
    thread_.join();
    if (reporter_.has_open_line_) write_stderr("\r\x1b[K");
    reporter_.has_open_line_ = false;
}

void Reporter::Phase::run()
{
    const double start_s = seconds_since_start();
    const auto interval = std::chrono::duration<double>(std::max(reporter_.interval_s(), 0.3));
    std::unique_lock lock(mutex_);
    while (!ended_.wait_for(lock, interval, [&] { return end_; })) report(seconds_since_start() - start_s);
}

void Reporter::Phase::report(double elapsed_s)
{
    if (reporter_.mode_ == ReportMode::json)
        return reporter_.print_event({{"event", "phase"}, {"phase", name_}, {"elapsed_s", elapsed_s}});
    const std::string time = fmt::format(": {}", duration_text(elapsed_s));
    if (reporter_.mode_ == ReportMode::lines) return write_stderr(text_ + time + '\n');
    const std::size_t room = std::size_t(std::max(terminal_columns() - int(time.size()), 0));
    write_stderr(fmt::format("\r{}{}\x1b[K", text_.substr(0, room), time));
    reporter_.has_open_line_ = true;
}

void Reporter::progress(double done, double elapsed_s, const Progress& progress, bool force)
{
    if (is_quiet()) return;
    const double now_s = seconds_since_start();
    // Without a terminal, short renders print no progress at all.
    if (mode_ == ReportMode::lines && last_s_ < 0) last_s_ = now_s - elapsed_s;
    if (!force && now_s - last_s_ < interval_s()) return;
    if (force && (mode_ == ReportMode::lines || last_samples_ == progress.samples_done)) return;
    last_s_ = now_s;
    last_samples_ = progress.samples_done;
    done = std::clamp(done, 0.0, 1.0);
    const double rate = elapsed_s > 0 ? double(progress.samples_done) / elapsed_s : 0;
    const double remaining_s = done > 0 ? elapsed_s * (1 - done) / done : 0;
    if (mode_ == ReportMode::json)
        return print_event({{"event", "progress"},
                            {"done", done},
                            {"samples_done", progress.samples_done},
                            {"samples_total", progress.samples_total},
                            {"rays", progress.costs.all_rays()},
                            {"samples_per_s", rate},
                            {"elapsed_s", elapsed_s},
                            {"remaining_s", remaining_s}});
    const std::string elapsed = duration_text(elapsed_s), left = duration_text(remaining_s);
    if (mode_ == ReportMode::lines)
        return write_stderr(
            fmt::format("{:5.1f} %  {}samples/s  {} elapsed, {} left\n", done * 100, with_prefix(rate), elapsed, left));
    write_stderr(fmt::format("\r{}\x1b[K", progress_line(done, with_prefix(rate), elapsed, left, terminal_columns())));
    has_open_line_ = true;
}

void Reporter::fireflies(const Film::Fireflies& found, double clamp)
{
    if (mode_ == ReportMode::json)
        return print_event(
            {{"event", "fireflies"}, {"samples", found.samples}, {"noise", found.noise}, {"clamp", clamp}});
    note(
        fmt::format("{:.2g} % of the samples (fireflies) make {:.0f} % of the noise: --denoise, or --clamp-indirect "
                    "{:.2g} (biased), "
                    "would remove them",
                    100 * found.samples, 100 * std::min(found.noise, 1.0), clamp));
}

void Reporter::comparison(const Comparison& comparison)
{
    if (mode_ == ReportMode::json) {
        nlohmann::json event = difference_json(comparison);
        event["event"] = "comparison";
        return print_event(event);
    }
    for (const std::string& line : difference_text(comparison)) note(line);
}

void Reporter::image_error(const ErrorReport& report)
{
    if (mode_ == ReportMode::json) return print_event(error_json(report));
    note(error_text(report));
}

void Reporter::summary(const Summary& s)
{
    const std::uint64_t memory = peak_memory_bytes();
    if (mode_ == ReportMode::json)
        return print_event({{"event", "summary"},
                            {"load_s", s.load_s},
                            {"build_s", s.build_s},
                            {"render_s", s.render_s},
                            {"write_s", s.write_s},
                            {"total_s", seconds_since_start()},
                            {"samples_per_pixel", s.samples_per_pixel},
                            {"rays", s.costs.all_rays()},
                            {"peak_memory_bytes", memory}});
    note(
        fmt::format("load {:.3f} s, build {:.3f} s, render {:.3f} s, write {:.3f} s; {} samples per pixel, {}rays; "
                    "peak memory {:.0f} MB",
                    s.load_s, s.build_s, s.render_s, s.write_s, s.samples_per_pixel,
                    with_prefix(double(s.costs.all_rays())), double(memory) / 1e6));
}

void Reporter::cost_sheet(const Summary& s)
{
    if (mode_ == ReportMode::silent) return;
    if (mode_ == ReportMode::json) return print_event(cost_sheet_json(s.costs, s.render_s));
    end_open_line();
    write_stderr(cli::cost_sheet(s.costs, s.render_s) + '\n');
}

}  // namespace fathom::cli
