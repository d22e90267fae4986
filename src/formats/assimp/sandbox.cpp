// SPDX-License-Identifier: Apache-2.0
#include "formats/assimp/sandbox.h"

#ifdef __linux__
#include <fcntl.h>
#include <linux/audit.h>
#include <linux/filter.h>
#include <linux/seccomp.h>
#include <sys/prctl.h>
#include <sys/syscall.h>

#include <cerrno>
#include <cstddef>
#include <cstdint>
#include <vector>
#endif

namespace fathom {

#if defined(__linux__) && (defined(__x86_64__) || defined(__aarch64__))

namespace {

#ifdef __x86_64__
constexpr std::uint32_t architecture = AUDIT_ARCH_X86_64;
#else
constexpr std::uint32_t architecture = AUDIT_ARCH_AARCH64;
#endif

/// System calls that affect anything outside the process. Some legacy calls exist only on x86-64. The kernel's headers
/// define __NR_openat2, for which glibc before 2.32 has no SYS_ name.
constexpr int refused_calls[] = {
#ifdef __x86_64__
    SYS_creat,          SYS_unlink,       SYS_rename,       SYS_mkdir,
    SYS_rmdir,          SYS_link,         SYS_symlink,      SYS_chmod,
    SYS_chown,          SYS_lchown,       SYS_mknod,        SYS_utime,
    SYS_utimes,         SYS_fork,         SYS_vfork,        SYS_futimesat,
#endif
    SYS_unlinkat,       SYS_renameat2,    SYS_mkdirat,      SYS_linkat,
    SYS_symlinkat,      SYS_fchmod,       SYS_fchmodat,     SYS_fchown,
    SYS_fchownat,       SYS_mknodat,      SYS_utimensat,    SYS_truncate,
    SYS_ftruncate,      SYS_setxattr,     SYS_lsetxattr,    SYS_fsetxattr,
    SYS_removexattr,    SYS_lremovexattr, SYS_fremovexattr, SYS_mount,
    SYS_umount2,        SYS_chroot,       SYS_pivot_root,   SYS_execve,
    SYS_execveat,       SYS_clone3,       SYS_ptrace,       SYS_process_vm_writev,
    SYS_kill,           SYS_socket,       SYS_socketpair,   SYS_bpf,
    SYS_setns,          SYS_unshare,      SYS_keyctl,       SYS_add_key,
    SYS_io_uring_setup, __NR_openat2,     SYS_memfd_create, SYS_renameat,
    SYS_clone};

sock_filter load(std::size_t offset)
{
    return BPF_STMT(BPF_LD | BPF_W | BPF_ABS, std::uint32_t(offset));
}
sock_filter answer(std::uint32_t code)
{
    return BPF_STMT(BPF_RET | BPF_K, code);
}

/// Refuses the call `number` if one of the bits is set in its argument.
void refuse_with_bits(std::vector<sock_filter>& program, int number, std::size_t argument, std::uint32_t bits)
{
    const std::size_t place = offsetof(seccomp_data, args) + argument * sizeof(seccomp_data::args[0]);
    program.push_back(BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, std::uint32_t(number), 0, 4));
    program.push_back(load(place));  // loads the low 32 bits on little-endian machines
    program.push_back(BPF_JUMP(BPF_JMP | BPF_JSET | BPF_K, bits, 0, 1));
    program.push_back(answer(SECCOMP_RET_ERRNO | EACCES));
    program.push_back(answer(SECCOMP_RET_ALLOW));
}

}  // namespace

void enter_sandbox()
{
    constexpr std::uint32_t writing = O_WRONLY | O_RDWR | O_CREAT | O_TRUNC | O_APPEND;
    std::vector<sock_filter> program{
        load(offsetof(seccomp_data, arch)), BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, architecture, 1, 0),
        answer(SECCOMP_RET_ERRNO | EPERM), load(offsetof(seccomp_data, nr)),
        // Higher numbers belong to the x32 ABI.
        BPF_JUMP(BPF_JMP | BPF_JGE | BPF_K, 0x40000000, 0, 1), answer(SECCOMP_RET_ERRNO | EPERM)};
    for (const int call : refused_calls) {
        program.push_back(BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, std::uint32_t(call), 0, 1));
        program.push_back(answer(SECCOMP_RET_ERRNO | EPERM));
    }
    refuse_with_bits(program, SYS_openat, 2, writing);
#ifdef __x86_64__
    refuse_with_bits(program, SYS_open, 1, writing);
#endif
    program.push_back(answer(SECCOMP_RET_ALLOW));
    const sock_fprog filter{static_cast<unsigned short>(program.size()), program.data()};
    // Kernels without seccomp continue unprotected.
    if (prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) == 0) prctl(PR_SET_SECCOMP, SECCOMP_MODE_FILTER, &filter);
}

#else

void enter_sandbox() {}

#endif

}  // namespace fathom
