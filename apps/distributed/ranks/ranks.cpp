// SPDX-License-Identifier: Apache-2.0
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

/// Interval of heartbeats, and the silence after which a rank counts as lost: a machine that swaps may be silent for a
/// while.
constexpr double heartbeat_interval_s = 1, max_silence_s = 60;
/// Polling intervals: while waiting for a message, at rank 0 while rendering, and at other ranks while rendering.
constexpr double waiting_s = 0.0002, leading_s = 0.005, rendering_s = 0.01;

void sleep_s(double seconds)
{
    std::this_thread::sleep_for(std::chrono::duration<double>(seconds));
}

}  // namespace

Ranks::Ranks(const RankEnvironment& environment) : rank_(environment.rank), count_(environment.count)
{
    try {
        group_ = open_mpi_group(environment);
    } catch (const LauncherMismatch& mismatch) {
        if (leads()) throw Error("", "", mismatch.message);
        std::exit(exit_error);
    } catch (const Error& error) {
        if (leads()) throw;
        let_rank0_report_first();
        throw Error("", "", fmt::format("rank {} on {}: {}", rank_, current_place().host, error.what()));
    }
    rank_ = group_->rank();
    places_.assign(std::size_t(count_), {});
    places_[std::size_t(rank_)] = current_place();
    heard_s_.assign(std::size_t(count_), seconds_since_start());
    checked_s_ = seconds_since_start();
    thread_ = std::thread([this] { communicate(); });
}

Ranks::~Ranks()
{
    stop_communication();
}

/// Sends version and place to rank 0, which answers with the number of threads.
void Ranks::exchange_places()
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
            throw RankFailure{
                fmt::format("{} runs version {}, not {}", name(rank), text.substr(0, line), FATHOM_VERSION)};
        const std::lock_guard lock(mutex_);
        places_[std::size_t(rank)] = RankPlace::parse(text.substr(line + 1));
    }
    const std::vector<int> threads = assign_threads(places_);
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
    const int machines = count_machines(places_);
    return fmt::format("{} ranks on {} machine{}, by {}", count_, machines, machines > 1 ? "s" : "", group_->library());
}

std::string Ranks::advice() const
{
    const IdleCores cores = idle_cores(places_);
    if (cores.idle == 0) return "";
    return fmt::format("{} of {} cores stay idle, since each rank is bound to some: mpirun --bind-to none uses all",
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

void Ranks::set_handler(const std::string& kind, Handler handler)
{
    // No handler is running once both mutexes are held.
    const std::scoped_lock lock(handling_, mutex_);
    if (handler)
        handlers_[kind] = std::move(handler);
    else
        handlers_.erase(kind);
}

std::optional<Ranks::Message> Ranks::receive(const std::vector<std::string>& kinds, double timeout_s)
{
    std::unique_lock lock(mutex_);
    std::optional<Message> found;
    const auto find_message = [&] {
        for (auto message = inbox_.begin(); message != inbox_.end(); ++message) {
            if (message->kind == "bye") throw RunEnded();
            if (std::find(kinds.begin(), kinds.end(), message->kind) == kinds.end()) continue;
            found = std::move(*message);
            inbox_.erase(message);
            return true;
        }
        if (!loss_.empty()) throw RankLost();
        return false;
    };
    if (find_message() || timeout_s <= 0) return found;
    is_waiting_ = true;
    try {
        arrived_.wait_for(lock, std::chrono::duration<double>(timeout_s), find_message);
    } catch (...) {
        is_waiting_ = false;
        throw;
    }
    is_waiting_ = false;
    return found;
}

Ranks::Message Ranks::wait(const std::vector<std::string>& kinds)
{
    constexpr double timeout_s = 3600;
    while (true)
        if (std::optional<Message> message = receive(kinds, timeout_s)) return std::move(*message);
}

std::vector<std::string> Ranks::gather(const std::string& kind)
{
    std::vector<std::string> bodies(static_cast<std::size_t>(count_));
    try {
        for (int i = 1; i < count_; ++i) {
            Message message = wait({kind});
            bodies[std::size_t(message.from)] = std::move(message.body);
        }
    } catch (const RankLost&) {
        throw RankFailure{loss()};
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

void Ranks::set_loss(const std::string& why)
{
    {
        const std::lock_guard lock(mutex_);
        if (loss_.empty()) loss_ = why;
    }
    interrupt_now();
    arrived_.notify_all();
}

void Ranks::abandon(const std::string& why)
{
    is_dead_ = true;
    set_loss(why);
}

/// Handles a message on the communication thread, or puts it into the inbox.
void Ranks::deliver(Message message)
{
    if (message.kind == "sign") return;
    if (message.kind == "failed") return set_loss(fmt::format("{}: {}", name(message.from), message.body));
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

void Ranks::receive_messages()
{
    while (true) {
        Message message;
        {
            const std::lock_guard lock(group_mutex_);
            group_->all_sent();  // frees messages that were sent
            std::string text;
            if (!group_->receive(message.from, text)) break;
            const std::size_t space = text.find(' ');
            message.kind = text.substr(0, space);
            message.body = text.substr(space + 1);
        }
        heard_s_[std::size_t(message.from)] = seconds_since_start();
        deliver(std::move(message));
    }
}

/// Sends heartbeats, and detects ranks that send none.
void Ranks::exchange_heartbeats(double now_s)
{
    if (interrupted() && !interrupt_is_sent_) {
        interrupt_is_sent_ = true;
        if (leads())
            send_to_all("stop");
        else
            send(0, "interrupted");
    }
    // After a pause of this process (SIGSTOP), the silence of others is not their fault.
    if (now_s - checked_s_ > 5 * heartbeat_interval_s) heard_s_.assign(heard_s_.size(), now_s);
    checked_s_ = now_s;
    if (now_s - heartbeat_s_ < heartbeat_interval_s) return;
    heartbeat_s_ = now_s;
    for (int other = 0; other < count_; ++other) {
        if (other == rank_ || (!leads() && other > 0)) continue;
        if (now_s - heard_s_[std::size_t(other)] > max_silence_s && loss().empty())
            abandon(fmt::format("{} has not answered for a minute", name(other)));
        send(other, "sign");
    }
    std::string trouble;
    {
        const std::lock_guard lock(group_mutex_);
        trouble = group_->trouble();
    }
    if (!trouble.empty() && loss().empty()) abandon("MPI: " + trouble);
}

void Ranks::communicate()
{
    double waits_since_s = 0;
    while (!end_) {
        const double now_s = seconds_since_start();
        receive_messages();
        exchange_heartbeats(now_s);
        if (!is_waiting_) waits_since_s = now_s;
        // A long wait polls less and less often.
        const double pause_s = waiting_s + 0.02 * (now_s - waits_since_s);
        sleep_s(is_waiting_ ? std::min(pause_s, leading_s) : leads() ? leading_s : rendering_s);
    }
}

void Ranks::stop_communication()
{
    end_ = true;
    if (thread_.joinable()) thread_.join();
}

int Ranks::finish(int code)
{
    constexpr double max_wait_s = 2;
    stop_communication();
    const double start_s = seconds_since_start();
    const auto all_sent = [&] {
        const std::lock_guard lock(group_mutex_);
        return group_->all_sent();
    };
    while (!all_sent() && seconds_since_start() - start_s < max_wait_s) sleep_s(waiting_s);
    // MPI_Finalize, also at exit, would wait for lost ranks forever.
    if (is_dead_) _exit(code);
    group_->finish();
    return code;
}

/// True once a rank has failed, or each other rank has sent a message, which shows that it has not.
bool Ranks::has_heard_from_all() const
{
    const std::lock_guard lock(mutex_);
    std::set<int> ranks;
    for (const Message& message : inbox_) ranks.insert(message.from);
    return !loss_.empty() || int(ranks.size()) == count_ - 1;
}

/// Ends the run of all ranks after an error, which rank 0 reports.
int Ranks::end_run(int code, const std::string& error, bool is_own, Reporter& reporter)
{
    if (leads()) {
        std::string words = error;
        // An error that another rank has too is reported without a rank.
        if (is_own) {
            constexpr double max_wait_s = 5;
            const double start_s = seconds_since_start();
            while (!has_heard_from_all() && seconds_since_start() - start_s < max_wait_s) sleep_s(0.01);
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
    } catch (const RunEnded&) {
        return finish(exit_ok);
    } catch (const RankLost&) {
        return finish(exit_error);
    }
}

int Ranks::run(const std::function<int()>& work, Reporter& reporter)
{
    if (!leads())
        reporter.forward(
            {.note = {}, .error = [this](const std::string& error) { send(0, "tells", error); }, .warnings = {}});
    try {
        exchange_places();
        int code = work();
        if (!leads()) wait({});
        send_to_all("bye");
        return finish(code);
    } catch (const RunEnded&) {
        return finish(exit_ok);
    } catch (const RankLost&) {
        if (leads()) return end_run(exit_error, loss(), false, reporter);
        if (rank_ == 1) write_stderr(fmt::format("fathom: {}\n", loss()));
        return finish(exit_error);
    } catch (const RankFailure& failure) {
        return end_run(exit_error, failure.message, false, reporter);
    } catch (const UsageError& error) {
        return end_run(exit_usage, error.what(), true, reporter);
    } catch (const std::bad_alloc&) {
        return end_run(exit_error, "there is not enough memory", true, reporter);
    } catch (const std::exception& error) {
        return end_run(exit_error, error.what(), true, reporter);
    }
}

}  // namespace fathom::cli
