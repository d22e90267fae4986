// SPDX-License-Identifier: Apache-2.0
#include "render/checkpoint.h"

#include <fmt/format.h>
#include <set>
#include <utility>
#include <vector>

#include "commands/commands.h"
#include "fathom/error.h"
#include "fathom/scene_digest.h"
#include "options/image_options.h"
#include "options/sample_plan.h"

namespace fathom::cli {

namespace fs = std::filesystem;

namespace {

constexpr double default_every_s = 60;

}  // namespace

fs::path previous_file(const fs::path& file)
{
    return file.parent_path() / (file.stem().string() + ".previous" + file.extension().string());
}

fs::path rank_file(const fs::path& checkpoint, int rank)
{
    return checkpoint.parent_path() /
           fmt::format("{}.rank{}{}", checkpoint.stem().string(), rank, checkpoint.extension().string());
}

void remove_generations(const fs::path& file)
{
    std::error_code ignored;
    fs::remove(file, ignored);
    fs::remove(previous_file(file), ignored);
}

namespace {

/// Files of ranks beside a checkpoint, sorted. A rank that has only a previous generation is listed too.
std::vector<fs::path> find_rank_files(const fs::path& checkpoint)
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

Checkpoint::Checkpoint(const CheckpointOptions& options, Reporter& reporter)
    : file_(options.file),
      every_s_(options.every_s.value_or(default_every_s)),
      next_s_(seconds_since_start() + every_s_),
      reporter_(reporter)
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

/// The file is intact, but belongs to another render.
struct Mismatch {
    std::string words;
};

/// One generation of a checkpoint; if it can't be opened, it has only the error.
struct Generation {
    fs::path file;
    std::optional<FilmFile> film;
    std::string error;

    std::uint64_t samples() const { return film ? count_samples(film->samples()) : 0; }
};

/// The existing generations, the newer one first: a kill between two renamings may leave it under the other's name.
std::vector<Generation> open_generations(const fs::path& file)
{
    std::vector<Generation> generations;
    for (const fs::path& candidate : {file, previous_file(file)}) {
        std::error_code error;
        if (!fs::exists(candidate, error)) continue;
        Generation& generation = generations.emplace_back(Generation{candidate, {}, {}});
        try {
            generation.film.emplace(candidate);
        } catch (const Error& damage) {
            generation.error = damage.what();
        }
    }
    if (generations.size() == 2 && generations[0].film && generations[1].samples() > generations[0].samples())
        std::swap(generations[0], generations[1]);
    return generations;
}

/// How a job differs from the one that a checkpoint belongs to, in words; empty if it doesn't.
std::string difference(const FilmKey& job, const FilmFile& generation, const std::string& parts)
{
    constexpr std::size_t scene_digits = 16;  // the key's first digits; the others are the camera's
    std::vector<std::string> words;
    const std::string &now = job.scene, &before = generation.key().scene;
    if (now.substr(0, scene_digits) != before.substr(0, scene_digits)) {
        const auto found = generation.attributes().find(parts_attribute);
        const std::string changed =
            found == generation.attributes().end() ? "" : scene_digest_difference(found->second, parts);
        words.push_back(!changed.empty() ? changed : "shapes, placement, or the contents of an image file");
    } else if (now != before) {
        words.emplace_back("the camera");
    }
    FilmKey settings = job;
    settings.scene = before;
    if (const std::string others = settings.difference(generation.key()); !others.empty()) words.push_back(others);
    return fmt::format("{}", fmt::join(words, "; "));
}

void check_belongs(const Generation& generation, const FilmKey& job, const std::string& parts, SampleRange wanted)
{
    if (const std::string words = difference(job, *generation.film, parts); !words.empty())
        throw Mismatch{
            fmt::format("{}: belongs to another render, which differs in: {}; render as before, or name another file",
                        generation.file.string(), words)};
    for (const SampleRange& range : generation.film->samples())
        if (range.first < wanted.first || range.second > wanted.second)
            throw Mismatch{fmt::format(
                "{}: has samples {}, but {}:{} are asked for: ask for more, or name another file",
                generation.file.string(), sample_ranges_text(generation.film->samples()), wanted.first, wanted.second)};
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
    rank_files_ = find_rank_files(file_);
    opened_ = file_;
    Film film = open_own(job, wanted, parts);
    const std::uint64_t own = film.samples_per_pixel();
    for (const fs::path& file : rank_files_) add_rank_file(file, film, wanted, parts);
    const std::uint64_t samples = film.samples_per_pixel();
    if (samples == 0) return film;
    const std::string total = wanted.second < max_samples ? fmt::format(" of {}", wanted.second - wanted.first) : "";
    const std::string beside = samples > own ? fmt::format(" and in files of {} rank{} beside it", rank_files_.size(),
                                                           rank_files_.size() > 1 ? "s" : "")
                                             : "";
    reporter_.note(fmt::format("continuing from {}{} samples in {}{}", samples, total, opened_.string(), beside));
    return film;
}

void Checkpoint::add_rank_file(const fs::path& file, Film& film, SampleRange wanted, const std::string& parts)
{
    std::string damage;
    for (const Generation& generation : open_generations(file)) {
        try {
            if (!generation.film) throw Error("", "", generation.error);
            check_belongs(generation, film.key(), parts, wanted);
            // An earlier run ended after it merged this file and before it removed it.
            if (overlap(generation.film->samples(), film.samples())) return;
            film.merge(generation.film->read());
            return;
        } catch (const Mismatch& mismatch) {
            throw Error("", "", mismatch.words);
        } catch (const Error& error) {
            damage = error.what();
        }
    }
    reporter_.error(damage + ": its samples are rendered again");
}

Film Checkpoint::open_own(const RenderJob& job, SampleRange wanted, const std::string& parts)
{
    std::vector<std::string> damaged;
    for (const Generation& generation : open_generations(file_)) {
        try {
            if (!generation.film) throw Error("", "", generation.error);
            check_belongs(generation, job.key(), parts, wanted);
            Film film = generation.film->read();
            for (const std::string& error : damaged) reporter_.error(error + ": the previous checkpoint is used");
            opened_ = generation.file;
            return film;
        } catch (const Mismatch& mismatch) {
            throw Error("", "", mismatch.words);
        } catch (const Error& error) {
            damaged.emplace_back(error.what());
        }
    }
    if (!damaged.empty())
        throw Error("", "", damaged.front() + ": no render can continue from it; remove it to start again");
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
        Image image = film.beauty(alpha);
        image.attributes = attributes;
        WriteOptions half;
        half.exr_half = true;
        snapshot_.take(film, image, half);
        if (!thread_.joinable()) thread_ = std::thread([this] { write_in_background(); });
    } catch (const std::exception& error) {
        failure_ = error.what();
        report_outcome();
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
    report_outcome();
    return failure_.empty();
}

void Checkpoint::report_outcome()
{
    if (failure_.empty() == reported_failure_.empty()) return;
    if (failure_.empty())
        reporter_.note(fmt::format("the checkpoint {} can be written again", file_.string()));
    else
        reporter_.error(fmt::format("{}: the render continues and will try again", failure_));
    reported_failure_ = failure_;
}

void Checkpoint::write_in_background()
{
    std::unique_lock lock(mutex_);
    while (true) {
        changed_.wait(lock, [&] { return to_write_ || end_; });
        if (!to_write_) return;
        lock.unlock();
        std::string failure;
        try {
            snapshot_.write(file_, previous_file(file_));
            for (const fs::path& file : rank_files_) remove_generations(file);
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
