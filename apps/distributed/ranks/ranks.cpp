#include "distributed/ranks/ranks.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <new>
#include <set>

#include "commands/commands.h"
#include "distributed/mpi/mpi_group.h"
#include "fathom/error.h"
#include "process/interrupt.h"
#include "process/streams.h"

namespace fathom::cli {

namespace {

/// Signs of life are given so often, and missed so long before a rank counts as lost. A machine that is short of memory
/// may be silent for some while.
constexpr double sign_s = 1, longest_silence_s = 60;
/// How often messages are looked for: by whoever waits for one, by who answers while rendering, by who only renders.
constexpr double waiting_s = 0.0002, leading_s = 0.005, rendering_s = 0.01;

void sleep_s(double seconds)
{
    std::this_thread::sleep_for(std::chrono::duration<double>(seconds));
}

}  // namespace

Ranks::Ranks(const RankEnvironment& environment) : rank_(environment.rank), count_(environment.count)
{
    try {
        group_ = open_group(environment);
    } catch (const OtherLauncher& other) {
        if (leads()) throw Error("", "", other.words);
        std::exit(exit_error);
    } catch (const Error& error) {
        if (leads()) throw;
        leave_the_word_to_rank_0();
        throw Error("", "", fmt::format("rank {} on {}: {}", rank_, place_here().host, error.what()));
    }
    rank_ = group_->rank();
    places_.assign(std::size_t(count_), {});
    places_[std::size_t(rank_)] = place_here();
    heard_s_.assign(std::size_t(count_), seconds_since_start());
    looked_s_ = seconds_since_start();
    thread_ = std::thread([this] { link(); });
}

Ranks::~Ranks()
{
    stop_link();
}

/// Tells rank 0 who this is, and learns what to do with it.
void Ranks::meet()
{
    if (!leads()) {
        send(0, "here", fmt::format("{}\n{}", FATHOM_VERSION, places_[std::size_t(rank_)].text()));
        threads_ = std::stoi(wait({"threads"}).body);
        return;
    }
    const std::vector<std::string> texts = gather("here");
    for (int rank = 1; rank < count_; ++rank) {
        const std::string& text = texts[std::size_t(rank)];
        const std::size_t line = text.find('\n');
        {
            const std::lock_guard lock(mutex_);
            places_[std::size_t(rank)].host = text.substr(line + 1, text.find('\n', line + 1) - line - 1);
        }
        if (text.substr(0, line) != FATHOM_VERSION)
            throw Other{fmt::format("{} runs version {}, not {}", name(rank), text.substr(0, line), FATHOM_VERSION)};
        const std::lock_guard lock(mutex_);
        places_[std::size_t(rank)] = RankPlace::parse(text.substr(line + 1));
    }
    const std::vector<int> threads = shared_threads(places_);
    threads_ = threads[0];
    for (int rank = 1; rank < count_; ++rank) send(rank, "threads", fmt::format("{}", threads[std::size_t(rank)]));
}

std::string Ranks::name(int rank) const
{
    const std::lock_guard lock(mutex_);
    const std::string& host = places_[std::size_t(rank)].host;
    return host.empty() ? fmt::format("rank {}", rank) : fmt::format("rank {} on {}", rank, host);
}

std::string Ranks::summary() const
{
    const int machines = machines_of(places_);
    return fmt::format("{} ranks on {} machine{}, by {}", count_, machines, machines > 1 ? "s" : "", group_->library());
}

std::string Ranks::advice() const
{
    const IdleCores cores = idle_cores(places_);
    if (cores.idle == 0) return "";
    return fmt::format("{} of {} cores are left idle, as each rank is bound to some: mpirun --bind-to none uses all",
                       cores.idle, cores.all);
}

void Ranks::send(int to, const std::string& kind, const std::string& body)
{
    const std::lock_guard lock(group_mutex_);
    group_->send(to, kind + ' ' + body);
}

void Ranks::send_to_all(const std::string& kind, const std::string& body)
{
    for (int rank = 0; rank < count_; ++rank)
        if (rank != rank_) send(rank, kind, body);
}

void Ranks::handle(const std::string& kind, Handler handler)
{
    // None of them is at work afterwards.
    const std::scoped_lock lock(handling_, mutex_);
    if (handler)
        handlers_[kind] = std::move(handler);
    else
        handlers_.erase(kind);
}

std::optional<Ranks::Message> Ranks::take(const std::vector<std::string>& kinds, double max_s)
{
    std::unique_lock lock(mutex_);
    std::optional<Message> found;
    const auto look = [&] {
        for (auto message = inbox_.begin(); message != inbox_.end(); ++message) {
            if (message->kind == "bye") throw Ended();
            if (std::find(kinds.begin(), kinds.end(), message->kind) == kinds.end()) continue;
            found = std::move(*message);
            inbox_.erase(message);
            return true;
        }
        if (!loss_.empty()) throw Lost();
        return false;
    };
    if (look() || max_s <= 0) return found;
    waits_ = true;
    try {
        arrived_.wait_for(lock, std::chrono::duration<double>(max_s), look);
    } catch (...) {
        waits_ = false;
        throw;
    }
    waits_ = false;
    return found;
}

Ranks::Message Ranks::wait(const std::vector<std::string>& kinds)
{
    constexpr double long_s = 3600;
    while (true)
        if (std::optional<Message> message = take(kinds, long_s)) return std::move(*message);
}

std::vector<std::string> Ranks::gather(const std::string& kind)
{
    std::vector<std::string> bodies(static_cast<std::size_t>(count_));
    try {
        for (int i = 1; i < count_; ++i) {
            Message message = wait({kind});
            bodies[std::size_t(message.from)] = std::move(message.body);
        }
    } catch (const Lost&) {
        throw Other{loss()};
    }
    return bodies;
}

std::string Ranks::agree(const std::string& own)
{
    if (!leads()) return wait({"agreed"}).body;
    send_to_all("agreed", own);
    return own;
}

std::string Ranks::loss() const
{
    const std::lock_guard lock(mutex_);
    return loss_;
}

mpi::Group::Transfer Ranks::start_send(int to, const void* bytes, std::size_t size)
{
    const std::lock_guard lock(group_mutex_);
    return group_->start_send(to, bytes, size);
}

mpi::Group::Transfer Ranks::start_receive(int from, void* bytes, std::size_t size)
{
    const std::lock_guard lock(group_mutex_);
    return group_->start_receive(from, bytes, size);
}

bool Ranks::is_done(mpi::Group::Transfer transfer)
{
    const std::lock_guard lock(group_mutex_);
    return group_->is_done(transfer);
}

void Ranks::lose(const std::string& why)
{
    {
        const std::lock_guard lock(mutex_);
        if (loss_.empty()) loss_ = why;
    }
    interrupt_now();
    arrived_.notify_all();
}

void Ranks::give_up(const std::string& why)
{
    is_dead_ = true;
    lose(why);
}

/// A message that has arrived, on the thread that takes them.
void Ranks::take(Message message)
{
    if (message.kind == "sign") return;
    if (message.kind == "failed") return lose(fmt::format("{}: {}", name(message.from), message.body));
    if (message.kind == "stop") return interrupt_now();
    if (message.kind == "interrupted") {
        interrupt_now();
        return send(message.from, "noted");
    }
    Handler handler;
    const std::lock_guard handling(handling_);
    {
        const std::lock_guard lock(mutex_);
        const auto found = handlers_.find(message.kind);
        if (found == handlers_.end()) {
            inbox_.push_back(std::move(message));
            arrived_.notify_all();
            return;
        }
        handler = found->second;
    }
    handler(message.from, message.body);
}

void Ranks::take_messages()
{
    while (true) {
        Message message;
        {
            const std::lock_guard lock(group_mutex_);
            group_->all_sent();  // forgets those that have left
            std::string text;
            if (!group_->receive(message.from, text)) break;
            const std::size_t space = text.find(' ');
            message.kind = text.substr(0, space);
            message.body = text.substr(space + 1);
        }
        heard_s_[std::size_t(message.from)] = seconds_since_start();
        take(std::move(message));
    }
}

/// Signs of life, and who gives none.
void Ranks::watch(double now_s)
{
    if (interrupted() && !interrupt_is_told_) {
        interrupt_is_told_ = true;
        if (leads())
            send_to_all("stop");
        else
            send(0, "interrupted");
    }
    // Whoever was stopped himself has heard of nobody.
    if (now_s - looked_s_ > 5 * sign_s) heard_s_.assign(heard_s_.size(), now_s);
    looked_s_ = now_s;
    if (now_s - signed_s_ < sign_s) return;
    signed_s_ = now_s;
    for (int other = 0; other < count_; ++other) {
        if (other == rank_ || (!leads() && other > 0)) continue;
        if (now_s - heard_s_[std::size_t(other)] > longest_silence_s && loss().empty())
            give_up(fmt::format("{} has not answered for a minute", name(other)));
        send(other, "sign");
    }
    std::string trouble;
    {
        const std::lock_guard lock(group_mutex_);
        trouble = group_->trouble();
    }
    if (!trouble.empty() && loss().empty()) give_up("MPI: " + trouble);
}

void Ranks::link()
{
    double waits_since_s = 0;
    while (!end_) {
        const double now_s = seconds_since_start();
        take_messages();
        watch(now_s);
        if (!waits_) waits_since_s = now_s;
        // Who waits for long does so with less haste.
        const double patience_s = waiting_s + 0.02 * (now_s - waits_since_s);
        sleep_s(waits_ ? std::min(patience_s, leading_s) : leads() ? leading_s : rendering_s);
    }
}

void Ranks::stop_link()
{
    end_ = true;
    if (thread_.joinable()) thread_.join();
}

int Ranks::finish(int code)
{
    constexpr double longest_s = 2;
    stop_link();
    const double start_s = seconds_since_start();
    const auto all_sent = [&] {
        const std::lock_guard lock(group_mutex_);
        return group_->all_sent();
    };
    while (!all_sent() && seconds_since_start() - start_s < longest_s) sleep_s(waiting_s);
    // MPI would wait for those who are not there, now or when the program ends.
    if (is_dead_) _exit(code);
    group_->finish();
    return code;
}

/// True once a rank has failed, or each other rank has sent something that shows that it has not.
bool Ranks::all_have_spoken() const
{
    const std::lock_guard lock(mutex_);
    std::set<int> ranks;
    for (const Message& message : inbox_) ranks.insert(message.from);
    return !loss_.empty() || int(ranks.size()) == count_ - 1;
}

/// Ends the run of all after an error; rank 0 tells it.
int Ranks::end_with(int code, const std::string& error, bool is_own, Reporter& reporter)
{
    if (leads()) {
        std::string words = error;
        // What is wrong at all ranks is told without a name.
        if (is_own) {
            constexpr double longest_s = 5;
            const double start_s = seconds_since_start();
            while (!all_have_spoken() && seconds_since_start() - start_s < longest_s) sleep_s(0.01);
            const std::string& other = loss();
            const bool same = other.size() > error.size() && other.ends_with(": " + error);
            if (!same) words = fmt::format("{}: {}", name(0), error);
        }
        reporter.error(words);
        send_to_all("bye");
        return finish(code);
    }
    send(0, "failed", error);
    try {
        while (true) wait({});
    } catch (const Ended&) {
        return finish(exit_ok);
    } catch (const Lost&) {
        return finish(exit_error);
    }
}

int Ranks::run(const std::function<int()>& work, Reporter& reporter)
{
    if (!leads()) reporter.hand_over([this](const std::string& error) { send(0, "tells", error); });
    try {
        meet();
        int code = work();
        if (!leads()) wait({});
        send_to_all("bye");
        return finish(code);
    } catch (const Ended&) {
        return finish(exit_ok);
    } catch (const Lost&) {
        if (leads()) return end_with(exit_error, loss(), false, reporter);
        if (rank_ == 1) say(fmt::format("fathom: {}\n", loss()));
        return finish(exit_error);
    } catch (const Other& other) {
        return end_with(exit_error, other.words, false, reporter);
    } catch (const UsageError& error) {
        return end_with(exit_usage, error.what(), true, reporter);
    } catch (const std::bad_alloc&) {
        return end_with(exit_error, "there is not enough memory", true, reporter);
    } catch (const std::exception& error) {
        return end_with(exit_error, error.what(), true, reporter);
    }
}

}  // namespace fathom::cli
