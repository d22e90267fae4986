#pragma once
/// The boundary between the program and the module that knows MPI, libfathom_mpi.so. The program opens it only where it
/// was started as one of several ranks, so nothing else needs MPI.
#include <cstddef>
#include <string>

namespace fathom::mpi {

/// The ranks of a run, and messages between them. No call waits for another rank, but for finish(). To be called by one
/// thread at a time.
class Group {
public:
    Group() = default;
    Group(const Group&) = delete;
    Group& operator=(const Group&) = delete;
    virtual ~Group() = default;

    virtual int rank() const = 0;
    virtual int count() const = 0;
    /// "Open MPI 4.1.4"
    virtual const std::string& library() const = 0;
    /// What has gone wrong since the group was made, in MPI's words; then nothing is sent or received any more.
    virtual const std::string& trouble() const = 0;

    /// Messages of a rank to another arrive in their order. The text is copied.
    virtual void send(int to, const std::string& text) = 0;
    /// Whether all messages have left.
    virtual bool all_sent() = 0;
    /// Whether one has arrived; then that.
    virtual bool receive(int& from, std::string& text) = 0;

    /// Bytes that stay where they are until they have left, or have arrived: is_done() tells. Apart from messages.
    using Transfer = int;
    virtual Transfer start_send(int to, const void* bytes, std::size_t size) = 0;
    virtual Transfer start_receive(int from, void* bytes, std::size_t size) = 0;
    /// Once true, the transfer is forgotten.
    virtual bool is_done(Transfer transfer) = 0;

    /// Waits for all ranks to call it. Nothing may be called afterwards.
    virtual void finish() = 0;
};

inline constexpr const char* module_file = "libfathom_mpi.so";

/// Version of Fathom that the module belongs to: no other is used.
inline constexpr const char* version_symbol = "fathom_mpi_version";
/// Meets the other ranks. nullptr: what went wrong is in `trouble`. The group lives as long as the program.
inline constexpr const char* open_symbol = "fathom_mpi_open";
using Open = Group*(std::string& trouble);

}  // namespace fathom::mpi
