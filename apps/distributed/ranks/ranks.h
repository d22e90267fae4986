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

/// The ranks that render together, as one of them sees the others. Rank 0 leads: it alone tells what happens, hands
/// work out and writes pictures.
///
/// A thread of its own takes messages, so that rank 0 answers while it renders, and sends a sign of life now and then:
/// a rank that gives none for a minute is lost, and with it the run.
class Ranks {
public:
    /// Meets the others. Throws Error if there is no module for it, or they don't fit together.
    explicit Ranks(const RankEnvironment& environment);
    Ranks(const Ranks&) = delete;
    Ranks& operator=(const Ranks&) = delete;
    ~Ranks();

    bool leads() const { return rank_ == 0; }
    int rank() const { return rank_; }
    int count() const { return count_; }
    /// This rank's share of the cores that it may run on.
    int threads() const { return threads_; }
    /// "rank 3 on node7"
    std::string name(int rank) const;
    /// Of all ranks, for those who lead: "4 ranks on 2 machines".
    std::string summary() const;
    /// What may be wrong with how they were started; empty: nothing.
    std::string advice() const;

    /// Does the work of this rank; returns the program's exit code. What the work throws ends the run of all, and is
    /// told once.
    int run(const std::function<int()>& work, Reporter& reporter);

    /// Of the kinds, some are for the thread that takes them: each rank tells rank 0 of an interrupt ("interrupted"),
    /// which is answered ("noted") and told to all ("stop").
    struct Message {
        int from;
        std::string kind, body;
    };
    /// Bodies may hold any bytes.
    void send(int to, const std::string& kind, const std::string& body = "");
    void send_to_all(const std::string& kind, const std::string& body = "");
    /// Messages of this kind go to `handler`, on the thread that takes them, which may send others; an empty one ends
    /// that.
    using Handler = std::function<void(int from, const std::string& body)>;
    void handle(const std::string& kind, Handler handler);
    /// The first message of one of these kinds, if it comes within some seconds. Throws what wait() throws.
    std::optional<Message> take(const std::vector<std::string>& kinds, double max_s);
    /// Waits for it. Throws Lost where it can't come any more.
    Message wait(const std::vector<std::string>& kinds);
    /// Of rank 0: a message of each other rank, by rank; its own place is empty. Throws Other with the words of the one
    /// that failed instead.
    std::vector<std::string> gather(const std::string& kind);
    /// What rank 0 says.
    std::string agree(const std::string& own);

    /// A rank that is no longer there, in words; empty: all are.
    std::string loss() const;
    /// Ends the run where another rank is waited for in vain.
    void give_up(const std::string& why);
    /// Bytes, see mpi::Group. Between starting and having them, done() is to be asked again and again.
    mpi::Group::Transfer start_send(int to, const void* bytes, std::size_t size);
    mpi::Group::Transfer start_receive(int from, void* bytes, std::size_t size);
    bool is_done(mpi::Group::Transfer transfer);

    /// The run is over, as another rank has told: to be caught by run().
    struct Ended {};
    /// The run can't go on: loss() says why.
    struct Lost {};
    /// What rank 0 finds wrong with another one, in words.
    struct Other {
        std::string words;
    };

private:
    void meet();
    void take_messages();
    void take(Message message);
    void watch(double now_s);
    void lose(const std::string& why);
    bool all_have_spoken() const;
    void link();
    int finish(int code);
    /// is_own  what is wrong is wrong here, and perhaps at other ranks too
    int end_with(int code, const std::string& error, bool is_own, Reporter& reporter);
    void stop_link();

    mpi::Group* group_ = nullptr;
    int rank_ = 0, count_ = 1, threads_ = 1;
    std::mutex handling_;            ///< held while a handler is at work; taken before the others
    std::mutex group_mutex_;         ///< for calls of group_
    mutable std::mutex mutex_;       ///< for all below
    std::vector<RankPlace> places_;  ///< of each rank, at rank 0; else only its own
    std::condition_variable arrived_;
    std::deque<Message> inbox_;
    std::map<std::string, Handler> handlers_;
    std::string loss_;
    std::atomic<bool> is_dead_ = false;  ///< who is lost will not take part in the end
    std::vector<double> heard_s_;        ///< when each rank gave a sign of life
    double signed_s_ = 0, looked_s_ = 0;
    bool interrupt_is_told_ = false;
    std::atomic<bool> waits_ = false, end_ = false;
    std::thread thread_;
};

}  // namespace fathom::cli
