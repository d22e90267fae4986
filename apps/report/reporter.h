#pragma once
#include <condition_variable>
#include <functional>
#include <mutex>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <thread>

#include "fathom/load.h"
#include "fathom/render.h"

namespace fathom::cli {

/// How a command tells on stderr what it does.
enum class ReportMode {
    quiet,     ///< only warnings
    terminal,  ///< a bar
    lines,     ///< a line now and then
    json,      ///< an object a line
    silent,    ///< nothing: another process tells it
};

struct Summary {
    double load_s = 0, build_s = 0, render_s = 0, write_s = 0;
    std::uint64_t samples_per_pixel = 0;
    RenderCosts costs;
};

class Reporter {
public:
    explicit Reporter(ReportMode mode) : mode_(mode) {}

    ReportMode mode() const { return mode_; }
    /// From here on errors are handed over, and nothing else is told.
    void hand_over(std::function<void(const std::string&)> take_error);
    void note(const std::string& text);
    void warnings(const Warnings& warnings);
    void error(const std::string& text);
    void written(const std::string& file);
    void summary(const Summary& summary);
    /// Where the time of rendering went.
    void cost_sheet(const Summary& summary);
    /// clamp  a limit on indirect light that would hide them
    void fireflies(const Film::Fireflies& fireflies, double clamp);

    /// While it lives, a phase whose end can't be foreseen is told every now and then, if it takes long. Nothing else
    /// is told meanwhile.
    class Phase {
    public:
        /// name  "load"; text  "reading scene.json"
        Phase(Reporter& reporter, std::string name, std::string text);
        Phase(const Phase&) = delete;
        Phase& operator=(const Phase&) = delete;
        ~Phase();

    private:
        void tell(double elapsed_s);
        void run();

        Reporter& reporter_;
        std::string name_, text_;
        std::mutex mutex_;
        std::condition_variable ended_;
        bool end_ = false;
        std::thread thread_;
    };

    /// done  0 to 1; the rest is told from it
    /// force  now, however short ago the last was
    void progress(double done, double elapsed_s, const Progress& progress, bool force = false);

private:
    void print(const nlohmann::json& event);
    void end_bar();
    bool is_quiet() const;
    double interval_s() const;

    ReportMode mode_;
    std::function<void(const std::string&)> take_error_;
    double last_s_ = -1e9;
    std::uint64_t last_samples_ = 0;  ///< of the last line of progress
    bool bar_ = false;                ///< the cursor stands behind a bar
};

/// terminal or lines, as stderr is.
ReportMode default_report_mode();
/// Largest memory that the program has had.
std::uint64_t peak_memory_bytes();

}  // namespace fathom::cli
