// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Interface between the program and its MPI module, libfathom_mpi.so. The program opens the module only when started
/// as one of several ranks, so that it runs without MPI otherwise.
#include <cstddef>
#include <string>

namespace fathom::mpi {

/// The ranks of a run, and messages between them. Only finish() waits for other ranks. Calls must not be concurrent.
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
    /// MPI's message of the first error; empty without one. After an error, nothing is sent or received.
    virtual const std::string& trouble() const = 0;

    /// Messages between two ranks arrive in order. The text is copied.
    virtual void send(int to, const std::string& text) = 0;
    /// Whether all messages have been sent.
    virtual bool all_sent() = 0;
    /// Whether a message has arrived; if so, it is stored.
    virtual bool receive(int& from, std::string& text) = 0;

    /// Transfers of bytes, independent of messages. The buffer must stay in place until is_done().
    using Transfer = int;
    virtual Transfer start_send(int to, const void* bytes, std::size_t size) = 0;
    virtual Transfer start_receive(int from, void* bytes, std::size_t size) = 0;
    /// Polls a transfer. Once true, its number is no longer valid.
    virtual bool is_done(Transfer transfer) = 0;

    /// Waits until all ranks have called it. No other call may follow.
    virtual void finish() = 0;
};

inline constexpr const char* module_file = "libfathom_mpi.so";

/// Symbol with the version of Fathom that the module belongs to; a module of another version is refused.
inline constexpr const char* version_symbol = "fathom_mpi_version";
/// Symbol of the function that joins the other ranks. It returns nullptr and an error in `trouble` on failure. The
/// group lives as long as the program.
inline constexpr const char* open_symbol = "fathom_mpi_open";
using Open = Group*(std::string& trouble);

}  // namespace fathom::mpi
