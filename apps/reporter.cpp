#include "reporter.h"

#include <fmt/format.h>
#include <sys/resource.h>
#include <unistd.h>
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "commands.h"

namespace fathom::cli {

namespace {

constexpr int bar_width = 24;

std::string duration(double seconds)
{
    if (seconds < 10) return fmt::format("{:.1f} s", seconds);
    const auto whole = std::uint64_t(std::min(seconds + 0.5, 1e15));
    if (whole < 60) return fmt::format("{} s", whole);
    if (whole < 3600) return fmt::format("{}:{:02} min", whole / 60, whole % 60);
    return fmt::format("{}:{:02} h", whole / 3600, whole / 60 % 60);
}

std::string with_unit(double number)
{
    for (const auto& [unit, name] : {std::pair{1e9, "G"}, {1e6, "M"}, {1e3, "k"}})
        if (number >= unit) return fmt::format("{:.2f} {}", number / unit, name);
    return fmt::format("{:.0f} ", number);
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
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    return std::uint64_t(usage.ru_maxrss) * 1024;
}

void Reporter::print(const nlohmann::json& event)
{
    // File names may hold any bytes; JSON may not.
    fmt::print(stderr, "{}\n", event.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace));
}

void Reporter::end_bar()
{
    if (bar_) fmt::print(stderr, "\n");
    bar_ = false;
}

void Reporter::note(const std::string& text)
{
    if (mode_ == ReportMode::quiet) return;
    if (mode_ == ReportMode::json) return print({{"event", "note"}, {"message", text}});
    end_bar();
    fmt::print(stderr, "{}\n", text);
}

void Reporter::warnings(const Warnings& warnings)
{
    end_bar();
    for (const auto& [message, count] : warnings.counts()) {
        if (mode_ == ReportMode::json)
            print({{"event", "warning"}, {"message", message}, {"count", count}});
        else
            fmt::print(stderr, "fathom: warning: {}{}\n", message, count > 1 ? fmt::format(" ({} times)", count) : "");
    }
}

void Reporter::error(const std::string& text)
{
    end_bar();
    if (mode_ == ReportMode::json)
        print({{"event", "error"}, {"message", text}});
    else
        fmt::print(stderr, "fathom: {}\n", text);
}

void Reporter::written(const std::string& file)
{
    if (mode_ == ReportMode::json) return print({{"event", "written"}, {"file", file}});
    note("wrote " + file);
}

void Reporter::progress(double done, double elapsed_s, const Progress& progress, bool force)
{
    if (mode_ == ReportMode::quiet) return;
    const double interval_s = mode_ == ReportMode::terminal ? 0.1 : mode_ == ReportMode::json ? 0.5 : 10;
    const double now_s = seconds_since_start();
    // Without a terminal, the first line comes after the interval too: short renders print none.
    if (mode_ == ReportMode::lines && last_s_ < 0) last_s_ = now_s - elapsed_s;
    if (!force && now_s - last_s_ < interval_s) return;
    if (mode_ == ReportMode::lines && force) return;
    last_s_ = now_s;
    done = std::clamp(done, 0.0, 1.0);
    const double rate = elapsed_s > 0 ? double(progress.samples_done) / elapsed_s : 0;
    const double remaining_s = done > 0 ? elapsed_s * (1 - done) / done : 0;
    if (mode_ == ReportMode::json)
        return print({{"event", "progress"},
                      {"done", done},
                      {"samples_done", progress.samples_done},
                      {"samples_total", progress.samples_total},
                      {"rays", progress.rays},
                      {"samples_per_s", rate},
                      {"elapsed_s", elapsed_s},
                      {"remaining_s", remaining_s}});
    const std::string text = fmt::format("{:5.1f} %  {}samples/s  {} elapsed, {} left", done * 100, with_unit(rate),
                                         duration(elapsed_s), duration(remaining_s));
    if (mode_ == ReportMode::lines) return fmt::print(stderr, "{}\n", text);
    const int full = int(done * bar_width);
    fmt::print(stderr, "\r[{}{}] {}\x1b[K", std::string(full, '#'), std::string(bar_width - full, '.'), text);
    std::fflush(stderr);
    bar_ = true;
}

void Reporter::summary(const Summary& s)
{
    const std::uint64_t memory = peak_memory_bytes();
    if (mode_ == ReportMode::json)
        return print({{"event", "summary"},
                      {"load_s", s.load_s},
                      {"build_s", s.build_s},
                      {"render_s", s.render_s},
                      {"write_s", s.write_s},
                      {"total_s", seconds_since_start()},
                      {"samples_per_pixel", s.samples_per_pixel},
                      {"rays", s.rays},
                      {"peak_memory_bytes", memory}});
    note(
        fmt::format("load {:.3f} s, build {:.3f} s, render {:.3f} s, write {:.3f} s; {} samples a pixel, {}rays; "
                    "peak memory {:.0f} MB",
                    s.load_s, s.build_s, s.render_s, s.write_s, s.samples_per_pixel, with_unit(double(s.rays)),
                    double(memory) / 1e6));
}

}  // namespace fathom::cli
