// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <atomic>
#include <condition_variable>
#include <deque>
#include <functional>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "distributed/mpi/module.h"
#include "distributed/ranks/environment.h"
#include "distributed/ranks/machines.h"
#include "report/reporter.h"

namespace fathom::cli {

/// The ranks that render one image together, seen from one of them. Rank 0 leads: it reports, hands out work and writes
/// images.
///
/// A communication thread receives messages, so that rank 0 answers while it renders, and sends heartbeats: a rank that
/// sends none for a minute is lost, and the run fails.
class Ranks {
public:
    /// Opens the MPI module and joins the others. Throws Error if the module is missing or of another MPI.
    explicit Ranks(const RankEnvironment& environment);
    Ranks(const Ranks&) = delete;
    Ranks& operator=(const Ranks&) = delete;
    ~Ranks();

    bool leads() const { return rank_ == 0; }
    int rank() const { return rank_; }
    int count() const { return count_; }
    /// Number of threads for this rank: its share of the cores that it may use.
    int threads() const { return threads_; }
    /// "rank 3 on node7"
    std::string name(int rank) const;
    /// At rank 0: "4 ranks on 2 machines, by Open MPI 4.1.4".
    std::string summary() const;
    /// At rank 0: a hint if the launcher leaves cores idle; else empty.
    std::string advice() const;

    /// Runs the work of this rank; returns the exit code. An exception of the work ends the run of all ranks and is
    /// reported once.
    int run(const std::function<int()>& work, Reporter& reporter);

    /// The communication thread handles some kinds itself: a rank reports an interrupt to rank 0 ("interrupted"), which
    /// answers ("noted") and tells all others ("stop").
    struct Message {
        int from;
        std::string kind, body;
    };
    /// The body may hold any bytes.
    void send(int to, const std::string& kind, const std::string& body = "");
    void send_to_all(const std::string& kind, const std::string& body = "");
    /// Passes messages of this kind to `handler`, on the communication thread; an empty handler stops that. A handler
    /// may send messages.
    using Handler = std::function<void(int from, const std::string& body)>;
    void set_handler(const std::string& kind, Handler handler);
    /// The first message of one of these kinds, if it arrives in time. Throws RunEnded and RankLost.
    std::optional<Message> receive(const std::vector<std::string>& kinds, double timeout_s);
    /// Like receive(), without a timeout.
    Message wait(const std::vector<std::string>& kinds);
    /// At rank 0: bodies of one message from each other rank, indexed by rank; its own is empty. Throws RankFailure if
    /// a rank fails.
    std::vector<std::string> gather(const std::string& kind);
    /// Returns the value that rank 0 passes, at all ranks.
    std::string agree(const std::string& own);

    /// The rank that was lost and the reason, as a sentence; empty if none was lost.
    std::string loss() const;
    /// Ends the run because another rank does not answer.
    void abandon(const std::string& why);
    /// Transfers of bytes, see mpi::Group. is_done() must be polled.
    mpi::Group::Transfer start_send(int to, const void* bytes, std::size_t size);
    mpi::Group::Transfer start_receive(int from, void* bytes, std::size_t size);
    bool is_done(mpi::Group::Transfer transfer);

    /// Rank 0 has ended the run; caught by run().
    struct RunEnded {};
    /// The run can't go on; loss() says why.
    struct RankLost {};
    /// An error that rank 0 found at another rank.
    struct RankFailure {
        std::string message;
    };

private:
    void exchange_places();
    void receive_messages();
    void deliver(Message message);
    void exchange_heartbeats(double now_s);
    void set_loss(const std::string& why);
    bool has_heard_from_all() const;
    void communicate();
    int finish(int code);
    /// is_own  the error occurred at this rank, and perhaps at others too
    int end_run(int code, const std::string& error, bool is_own, Reporter& reporter);
    void stop_communication();

    mpi::Group* group_ = nullptr;
    int rank_ = 0, count_ = 1, threads_ = 1;
    std::mutex handling_;            ///< held while a handler runs; locked before the other mutexes
    std::mutex group_mutex_;         ///< guards group_
    mutable std::mutex mutex_;       ///< guards the members below
    std::vector<RankPlace> places_;  ///< of all ranks at rank 0; elsewhere only its own
    std::condition_variable arrived_;
    std::deque<Message> inbox_;
    std::map<std::string, Handler> handlers_;
    std::string loss_;
    std::atomic<bool> is_dead_ = false;  ///< a lost rank can't take part in MPI's finalization
    std::vector<double> heard_s_;        ///< when each rank last sent something
    double heartbeat_s_ = 0, checked_s_ = 0;
    bool interrupt_is_sent_ = false;
    std::atomic<bool> is_waiting_ = false, end_ = false;
    std::thread thread_;
};

}  // namespace fathom::cli
