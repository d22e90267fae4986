#include "render/checkpoint.h"

#include <fmt/format.h>
#include <set>
#include <utility>
#include <vector>

#include "commands/commands.h"
#include "fathom/error.h"
#include "fathom/scene_parts.h"
#include "options/image_options.h"
#include "options/sample_plan.h"

namespace fathom::cli {

namespace fs = std::filesystem;

fs::path previous_of(const fs::path& file)
{
    return file.parent_path() / (file.stem().string() + ".previous" + file.extension().string());
}

fs::path rank_file(const fs::path& checkpoint, int rank)
{
    return checkpoint.parent_path() /
           fmt::format("{}.rank{}{}", checkpoint.stem().string(), rank, checkpoint.extension().string());
}

void remove_states(const fs::path& file)
{
    std::error_code ignored;
    fs::remove(file, ignored);
    fs::remove(previous_of(file), ignored);
}

namespace {

/// The files of ranks beside a checkpoint, sorted; of those that have only the state before, the name that they had.
std::vector<fs::path> rank_files_of(const fs::path& checkpoint)
{
    std::set<fs::path> files;
    const std::string start = checkpoint.stem().string() + ".rank", previous = ".previous";
    const fs::path folder = checkpoint.parent_path().empty() ? "." : checkpoint.parent_path();
    std::error_code error;
    for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error)) {
        const fs::path name = entry->path().filename();
        if (name.extension() != checkpoint.extension()) continue;
        std::string number = name.stem().string();
        if (!number.starts_with(start)) continue;
        number.erase(0, start.size());
        if (number.ends_with(previous)) number.erase(number.size() - previous.size());
        if (number.empty() || number.find_first_not_of("0123456789") != std::string::npos) continue;
        files.insert(checkpoint.parent_path() / (start + number + checkpoint.extension().string()));
    }
    return {files.begin(), files.end()};
}

}  // namespace

Checkpoint::Checkpoint(fs::path file, double every_s, Reporter& reporter)
    : file_(std::move(file)), every_s_(every_s), next_s_(seconds_since_start() + every_s), reporter_(reporter)
{
}

Checkpoint::~Checkpoint()
{
    if (!thread_.joinable()) return;
    {
        const std::lock_guard lock(mutex_);
        end_ = true;
    }
    changed_.notify_all();
    thread_.join();
}

namespace {

/// What is not damaged, but not to be gone on from.
struct Refusal {
    std::string words;
};

/// A state that is there; one whose very beginning is damaged has only its error.
struct State {
    fs::path file;
    std::optional<FilmFile> film;
    std::string error;

    std::uint64_t samples() const { return film ? count_of(film->samples()) : 0; }
};

/// The states that are there, the newer one first: a kill between two renamings may leave it under the name of the
/// other.
std::vector<State> states_of(const fs::path& file)
{
    std::vector<State> states;
    for (const fs::path& candidate : {file, previous_of(file)}) {
        std::error_code error;
        if (!fs::exists(candidate, error)) continue;
        State& state = states.emplace_back(State{candidate, {}, {}});
        try {
            state.film.emplace(candidate);
        } catch (const Error& damage) {
            state.error = damage.what();
        }
    }
    if (states.size() == 2 && states[0].film && states[1].samples() > states[0].samples())
        std::swap(states[0], states[1]);
    return states;
}

/// In what a job differs from the one that a state is of; empty where it doesn't.
std::string difference(const FilmKey& job, const FilmFile& state, const std::string& parts)
{
    constexpr std::size_t scene_digits = 16;  // of the key's; the others are of the camera
    std::vector<std::string> words;
    const std::string &now = job.scene, &before = state.key().scene;
    if (now.substr(0, scene_digits) != before.substr(0, scene_digits)) {
        const auto found = state.attributes().find(parts_attribute);
        const std::string changed =
            found == state.attributes().end() ? "" : scene_parts_difference(found->second, parts);
        words.push_back(!changed.empty() ? changed : "shapes, places, or what is in a picture's file");
    } else if (now != before) {
        words.emplace_back("the camera");
    }
    FilmKey settings = job;
    settings.scene = before;
    if (const std::string others = settings.difference(state.key()); !others.empty()) words.push_back(others);
    return fmt::format("{}", fmt::join(words, "; "));
}

void check_belongs(const State& state, const FilmKey& job, const std::string& parts, SampleRange wanted)
{
    if (const std::string words = difference(job, *state.film, parts); !words.empty())
        throw Refusal{
            fmt::format("{}: it is of another render, which differs in: {}; render as before, or name another file",
                        state.file.string(), words)};
    for (const SampleRange& range : state.film->samples())
        if (range.first < wanted.first || range.second > wanted.second)
            throw Refusal{
                fmt::format("{}: it has samples {}, and {}:{} are asked for: ask for more, or name another file",
                            state.file.string(), text_of(state.film->samples()), wanted.first, wanted.second)};
}

bool overlap(const std::vector<SampleRange>& a, const std::vector<SampleRange>& b)
{
    for (const SampleRange& r : a)
        for (const SampleRange& s : b)
            if (r.first < s.second && s.first < r.second) return true;
    return false;
}

}  // namespace

Film Checkpoint::open(const RenderJob& job, SampleRange wanted, const std::string& parts)
{
    rank_files_ = rank_files_of(file_);
    opened_ = file_;
    Film film = open_own(job, wanted, parts);
    const std::uint64_t own = film.samples_per_pixel();
    for (const fs::path& file : rank_files_) add_rank_file(file, film, wanted, parts);
    const std::uint64_t samples = film.samples_per_pixel();
    if (samples == 0) return film;
    const std::string total = wanted.second < max_samples ? fmt::format(" of {}", wanted.second - wanted.first) : "";
    const std::string beside = samples > own ? fmt::format(" and what {} rank{} left beside it", rank_files_.size(),
                                                           rank_files_.size() > 1 ? "s" : "")
                                             : "";
    reporter_.note(fmt::format("going on from {}{} samples in {}{}", samples, total, opened_.string(), beside));
    return film;
}

void Checkpoint::add_rank_file(const fs::path& file, Film& film, SampleRange wanted, const std::string& parts)
{
    std::string damage;
    for (const State& state : states_of(file)) {
        try {
            if (!state.film) throw Error("", "", state.error);
            check_belongs(state, film.key(), parts, wanted);
            // A run that ended between writing them into the checkpoint and removing them.
            if (overlap(state.film->samples(), film.samples())) return;
            film.merge(state.film->read());
            return;
        } catch (const Refusal& refusal) {
            throw Error("", "", refusal.words);
        } catch (const Error& error) {
            damage = error.what();
        }
    }
    reporter_.error(damage + ": its samples are rendered anew");
}

Film Checkpoint::open_own(const RenderJob& job, SampleRange wanted, const std::string& parts)
{
    std::vector<std::string> damaged;
    for (const State& state : states_of(file_)) {
        try {
            if (!state.film) throw Error("", "", state.error);
            check_belongs(state, job.key(), parts, wanted);
            Film film = state.film->read();
            for (const std::string& error : damaged) reporter_.error(error + ": the state before is taken");
            opened_ = state.file;
            return film;
        } catch (const Refusal& refusal) {
            throw Error("", "", refusal.words);
        } catch (const Error& error) {
            damaged.emplace_back(error.what());
        }
    }
    if (!damaged.empty())
        throw Error("", "", damaged.front() + ": no render can go on from it; remove it to begin anew");
    return Film(job);
}

bool Checkpoint::is_due()
{
    if (seconds_since_start() < next_s_) return false;
    const std::lock_guard lock(mutex_);
    return !to_write_;
}

void Checkpoint::write(const Film& film, bool alpha, const std::map<std::string, std::string>& attributes)
{
    finish();
    next_s_ = seconds_since_start() + every_s_;
    try {
        Image picture = film.picture(alpha);
        picture.attributes = attributes;
        WriteOptions half;
        half.exr_half = true;
        snapshot_.take(film, picture, half);
        if (!thread_.joinable()) thread_ = std::thread([this] { run(); });
    } catch (const std::exception& error) {
        failure_ = error.what();
        tell_outcome();
        return;
    }
    {
        const std::lock_guard lock(mutex_);
        to_write_ = true;
    }
    changed_.notify_all();
}

bool Checkpoint::finish()
{
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [&] { return !to_write_; });
    tell_outcome();
    return failure_.empty();
}

void Checkpoint::tell_outcome()
{
    if (failure_.empty() == told_failure_.empty()) return;
    if (failure_.empty())
        reporter_.note(fmt::format("the checkpoint {} is written again", file_.string()));
    else
        reporter_.error(fmt::format("{}: the render goes on, and tries again", failure_));
    told_failure_ = failure_;
}

void Checkpoint::run()
{
    std::unique_lock lock(mutex_);
    while (true) {
        changed_.wait(lock, [&] { return to_write_ || end_; });
        if (!to_write_) return;
        lock.unlock();
        std::string failure;
        try {
            snapshot_.write(file_, previous_of(file_));
            for (const fs::path& file : rank_files_) remove_states(file);
            rank_files_.clear();
        } catch (const std::exception& error) {
            failure = error.what();
        }
        lock.lock();
        failure_ = failure;
        to_write_ = false;
        changed_.notify_all();
    }
}

}  // namespace fathom::cli
