// SPDX-License-Identifier: Apache-2.0
// Only the C interface of MPI is used: both Open MPI and MPICH have it.
#define OMPI_SKIP_MPICXX 1
#define MPICH_SKIP_MPICXX 1
#include <mpi.h>

#include <deque>
#include <map>
#include <memory>

#include "distributed/mpi/module.h"
#include "fathom/api.h"

namespace {

using fathom::mpi::Group;

constexpr int message_tag = 1, bytes_tag = 2;

/// Name and version of the MPI library, "Open MPI 4.1.4", from a description that may have several lines.
std::string library_name()
{
    char text[MPI_MAX_LIBRARY_VERSION_STRING];
    int length = 0;
    if (MPI_Get_library_version(text, &length) != MPI_SUCCESS) return "MPI";
    const std::string description(text, std::size_t(length));
    std::string line = description.substr(0, description.find_first_of(",\n"));
    // "Open MPI v4.1.4", "MPICH Version:\t4.0.2"
    const std::size_t digit = line.find_first_of("0123456789");
    if (digit == std::string::npos) return line;
    std::string name = line.substr(0, digit);
    for (const char* word : {"v", "Version:"})
        if (const std::size_t at = name.rfind(word); at != std::string::npos) name.erase(at);
    name.erase(name.find_last_not_of(" \t:") + 1);
    return name + ' ' + line.substr(digit);
}

class MpiGroup final : public Group {
public:
    MpiGroup() : library_(library_name())
    {
        check(MPI_Comm_set_errhandler(MPI_COMM_WORLD, MPI_ERRORS_RETURN));
        check(MPI_Comm_rank(MPI_COMM_WORLD, &rank_));
        check(MPI_Comm_size(MPI_COMM_WORLD, &count_));
    }

    int rank() const override { return rank_; }
    int count() const override { return count_; }
    const std::string& library() const override { return library_; }
    const std::string& trouble() const override { return trouble_; }

    void send(int to, const std::string& text) override
    {
        Sent& sent = sent_.emplace_back(Sent{text, MPI_REQUEST_NULL});
        start(MPI_Isend(sent.text.data(), int(sent.text.size()), MPI_BYTE, to, message_tag, MPI_COMM_WORLD,
                        &sent.request));
    }

    bool all_sent() override
    {
        while (!sent_.empty() && is_complete(sent_.front().request)) sent_.pop_front();
        return sent_.empty();
    }

    bool receive(int& from, std::string& text) override
    {
        if (!trouble_.empty()) return false;
        int there = 0, size = 0;
        MPI_Status status;
        if (!check(MPI_Iprobe(MPI_ANY_SOURCE, message_tag, MPI_COMM_WORLD, &there, &status)) || !there) return false;
        check(MPI_Get_count(&status, MPI_BYTE, &size));
        from = status.MPI_SOURCE;
        text.resize(std::size_t(size));
        return check(MPI_Recv(text.data(), size, MPI_BYTE, from, message_tag, MPI_COMM_WORLD, MPI_STATUS_IGNORE));
    }

    Transfer start_send(int to, const void* bytes, std::size_t size) override
    {
        MPI_Request& request = transfers_[next_] = MPI_REQUEST_NULL;
        start(MPI_Isend(bytes, int(size), MPI_BYTE, to, bytes_tag, MPI_COMM_WORLD, &request));
        return next_++;
    }

    Transfer start_receive(int from, void* bytes, std::size_t size) override
    {
        MPI_Request& request = transfers_[next_] = MPI_REQUEST_NULL;
        start(MPI_Irecv(bytes, int(size), MPI_BYTE, from, bytes_tag, MPI_COMM_WORLD, &request));
        return next_++;
    }

    bool is_done(Transfer transfer) override
    {
        const auto found = transfers_.find(transfer);
        if (found == transfers_.end()) return true;
        if (!is_complete(found->second)) return false;
        transfers_.erase(found);
        return true;
    }

    void finish() override
    {
        if (trouble_.empty()) check(MPI_Finalize());
    }

private:
    /// Kept in a deque, whose elements don't move while they are being sent.
    struct Sent {
        std::string text;
        MPI_Request request;
    };

    bool check(int code)
    {
        if (code == MPI_SUCCESS) return true;
        if (!trouble_.empty()) return false;
        char text[MPI_MAX_ERROR_STRING];
        int length = 0;
        MPI_Error_string(code, text, &length);
        trouble_.assign(text, std::size_t(length));
        return false;
    }
    void start(int code) { check(code); }
    bool is_complete(MPI_Request& request)
    {
        int done = 0;
        return trouble_.empty() && check(MPI_Test(&request, &done, MPI_STATUS_IGNORE)) && done;
    }

    std::string library_, trouble_;
    int rank_ = 0, count_ = 1;
    std::deque<Sent> sent_;
    std::map<Transfer, MPI_Request> transfers_;
    Transfer next_ = 0;
};

}  // namespace

extern "C" {

FATHOM_API extern const char* const fathom_mpi_version;
const char* const fathom_mpi_version = FATHOM_VERSION;

FATHOM_API Group* fathom_mpi_open(std::string& trouble)
{
    // Calls come from several threads, but never at the same time.
    int provided = MPI_THREAD_SINGLE;
    if (MPI_Init_thread(nullptr, nullptr, MPI_THREAD_SERIALIZED, &provided) != MPI_SUCCESS) {
        trouble = "MPI could not be initialized";
        return nullptr;
    }
    static MpiGroup group;
    trouble = group.trouble();
    if (trouble.empty() && provided < MPI_THREAD_SERIALIZED)
        trouble = "it was built without support for threads (MPI_THREAD_SERIALIZED)";
    return trouble.empty() ? &group : nullptr;
}

}  // extern "C"
