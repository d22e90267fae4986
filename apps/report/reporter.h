// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <condition_variable>
#include <functional>
#include <mutex>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <thread>

#include "fathom/load.h"
#include "fathom/render.h"
#include "report/error_report.h"

namespace fathom::cli {

struct Comparison;

/// How a command reports to stderr.
enum class ReportMode {
    quiet,     ///< only warnings
    terminal,  ///< a progress bar
    lines,     ///< a line every ten seconds
    json,      ///< one object per line
    silent,    ///< nothing: another process reports
};

/// Times and counts of a render.
struct Summary {
    double load_s = 0, build_s = 0, render_s = 0, write_s = 0;
    std::uint64_t samples_per_pixel = 0;
    RenderCosts costs;
};

/// Receivers of reports that are not printed. An empty one drops its reports.
struct ReportHandlers {
    std::function<void(const std::string&)> note, error;
    std::function<void(const Warnings&)> warnings;
};

/// Prints progress, notes, warnings, errors and summaries to stderr.
class Reporter {
public:
    explicit Reporter(ReportMode mode) : mode_(mode) {}

    ReportMode mode() const { return mode_; }
    /// From here on, reports go to `handlers`, and nothing is printed.
    void forward(ReportHandlers handlers);
    void note(const std::string& text);
    void warnings(const Warnings& warnings);
    void error(const std::string& text);
    void written(const std::string& file);
    void summary(const Summary& summary);
    /// Reports where the rendering time went.
    void cost_sheet(const Summary& summary);
    void image_error(const ErrorReport& report);
    void comparison(const Comparison& comparison);
    /// clamp  value of --clamp-indirect that would remove the fireflies
    void fireflies(const Film::Fireflies& fireflies, double clamp);

    /// Reports a phase of unknown duration at intervals, during its lifetime. Nothing else may be reported meanwhile.
    class Phase {
    public:
        /// name  "load"; text  "reading scene.json"
        Phase(Reporter& reporter, std::string name, std::string text);
        Phase(const Phase&) = delete;
        Phase& operator=(const Phase&) = delete;
        ~Phase();

    private:
        void report(double elapsed_s);
        void run();

        Reporter& reporter_;
        std::string name_, text_;
        std::mutex mutex_;
        std::condition_variable ended_;
        bool end_ = false;
        std::thread thread_;
    };

    /// done   fraction from 0 to 1, from which the remaining time is estimated
    /// force  reports even if the last report was a moment ago
    void progress(double done, double elapsed_s, const Progress& progress, bool force = false);

private:
    void print_event(const nlohmann::json& event);
    void end_open_line();
    bool is_quiet() const;
    double interval_s() const;

    ReportMode mode_;
    ReportHandlers handlers_;  ///< used in mode silent
    double last_s_ = -1e9;
    std::uint64_t last_samples_ = 0;  ///< samples of the last progress report
    bool has_open_line_ = false;      ///< the cursor is behind a progress bar
};

/// ReportMode::terminal if stderr is one, else ReportMode::lines.
ReportMode default_report_mode();
/// Peak resident memory of the process.
std::uint64_t peak_memory_bytes();

}  // namespace fathom::cli
