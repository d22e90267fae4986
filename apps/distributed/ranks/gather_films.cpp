// SPDX-License-Identifier: Apache-2.0
#include "distributed/ranks/gather_films.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <thread>

#include "commands/commands.h"
#include "film/film_words.h"
#include "options/arguments.h"
#include "options/sample_plan.h"
#include "process/interrupt.h"

namespace fathom::cli {

namespace {

using Transfer = mpi::Group::Transfer;
using Words = std::vector<std::uint32_t>;

constexpr std::size_t piece_bytes = std::size_t(1) << 20;
constexpr Transfer none = -1;

/// Sample ranges and invalid samples of a film, sent before its words.
std::string header_of(const Film& film)
{
    std::string text = fmt::format("{}\n{}", sample_ranges_text(film.samples()), film.invalid_samples());
    if (const auto invalid = film.invalid_sample())
        text += fmt::format("\n{} {} {}", invalid->x, invalid->y, invalid->sample);
    return text;
}

/// Adds another rank's header: its samples count as present from here on.
void merge_header(Film& into, const std::string& header)
{
    const std::vector<std::string> lines = split(header, '\n');
    std::vector<SampleRange> samples;
    if (!lines.at(0).empty())
        for (const std::string& range : split(lines[0], ',')) samples.push_back(parse_sample_range(range));
    std::optional<Film::SampleLocation> invalid;
    if (lines.size() > 2) {
        const std::vector<std::string> parts = split(lines[2], ' ');
        invalid = Film::SampleLocation{std::stoi(parts.at(0)), std::stoi(parts.at(1)), std::stoull(parts.at(2))};
    }
    begin_merge(into, into.key(), samples, std::stoull(lines.at(1)), invalid);
}

/// A rank that sends the sums of its subtree here, two pieces at a time.
struct ChildRank {
    int rank;
    std::array<Words, 2> pieces;
    std::array<Transfer, 2> transfers;
};

/// One node of the tree: receives pieces from up to two children, adds its own, and sends them to its parent.
class TreeNode {
public:
    TreeNode(Ranks& ranks, const Film& own, Film* into, double patience_s)
        : ranks_(ranks),
          own_(own),
          into_(into),
          patience_s_(patience_s),
          pixels_(std::size_t(own.width()) * std::size_t(own.height())),
          words_(std::size_t(words_per_pixel(own))),
          step_(std::max<std::size_t>(1, piece_bytes / (words_ * sizeof(std::uint32_t)))),
          count_((pixels_ + step_ - 1) / step_)
    {
        for (const int rank : {2 * ranks.rank() + 1, 2 * ranks.rank() + 2})
            if (rank < ranks.count()) children_.push_back({rank, {}, {none, none}});
    }

    void run()
    {
        for (std::size_t piece = 0; piece < std::min(ahead, count_); ++piece) receive(piece);
        for (std::size_t piece = 0; piece < count_; ++piece) {
            for (const ChildRank& child : children_) wait(child.transfers[piece % ahead]);
            if (into_)
                merge(piece);
            else
                pass_on(piece);
            if (piece + ahead < count_) receive(piece + ahead);
        }
        for (const Transfer transfer : sent_) wait(transfer);
    }

private:
    static constexpr std::size_t ahead = 2;

    std::size_t pixels_of(std::size_t piece) const { return std::min(step_, pixels_ - piece * step_); }
    std::size_t bytes_of(std::size_t piece) const { return pixels_of(piece) * words_ * sizeof(std::uint32_t); }

    void receive(std::size_t piece)
    {
        for (ChildRank& child : children_) {
            Words& words = child.pieces[piece % ahead];
            words.resize(step_ * words_);
            child.transfers[piece % ahead] = ranks_.start_receive(child.rank, words.data(), bytes_of(piece));
        }
    }

    void merge(std::size_t piece)
    {
        for (const ChildRank& child : children_)
            merge_words(*into_, piece * step_, child.pieces[piece % ahead].data(), pixels_of(piece));
    }

    void pass_on(std::size_t piece)
    {
        Transfer& transfer = sent_[piece % ahead];
        wait(transfer);
        const std::uint32_t* words = film_words(own_) + piece * step_ * words_;
        if (!children_.empty()) {
            Words& sum = sums_[piece % ahead];
            sum.assign(words, words + pixels_of(piece) * words_);
            for (const ChildRank& child : children_)
                add_words(own_, child.pieces[piece % ahead].data(), sum.data(), pixels_of(piece));
            words = sum.data();
        }
        transfer = ranks_.start_send((ranks_.rank() - 1) / 2, words, bytes_of(piece));
    }

    /// Polls ever less often, since the other rank may still be rendering.
    void wait(Transfer transfer)
    {
        constexpr double min_pause_s = 20e-6, max_pause_s = 2e-3;
        if (transfer == none) return;
        const double start_s = seconds_since_start();
        double pause_s = min_pause_s;
        while (!ranks_.is_done(transfer)) {
            if (!ranks_.loss().empty()) throw Ranks::RankLost();
            if (!interrupted()) interrupted_s_ = seconds_since_start();
            if (seconds_since_start() - std::max(start_s, interrupted_s_) > patience_s_)
                ranks_.abandon("another rank does not answer");
            std::this_thread::sleep_for(std::chrono::duration<double>(pause_s));
            pause_s = std::min(max_pause_s, pause_s * 1.5);
        }
    }

    Ranks& ranks_;
    const Film& own_;
    Film* const into_;
    double patience_s_, interrupted_s_ = 0;
    std::size_t pixels_, words_, step_, count_;
    std::vector<ChildRank> children_;
    std::array<Words, ahead> sums_;
    std::array<Transfer, ahead> sent_{none, none};
};

}  // namespace

void gather_films(Ranks& ranks, const Film& own, Film* into, double patience_s)
{
    if (into)
        for (int i = 1; i < ranks.count(); ++i) merge_header(*into, ranks.wait({"film"}).body);
    else
        ranks.send(0, "film", header_of(own));
    TreeNode(ranks, own, into, patience_s).run();
}

}  // namespace fathom::cli
