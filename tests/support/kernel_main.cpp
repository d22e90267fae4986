// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdio>
#include <cstring>

namespace {

bool runs_here(const char* isa)
{
#if defined(__x86_64__)
    if (!std::strcmp(isa, "x86-64-v3")) return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
    if (!std::strcmp(isa, "x86-64-v4"))
        return __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
               __builtin_cpu_supports("avx512bw") && __builtin_cpu_supports("avx512vl");
#endif
    return !std::strcmp(isa, "base");
}

/// Skips the test on machines without the instruction set. It runs before all other code, because even initializers are
/// compiled for the instruction set. glibc passes the arguments to constructors.
[[gnu::constructor(101)]] void skip_where_it_cannot_run(int argc, char** argv)
{
#if defined(__x86_64__)
    __builtin_cpu_init();
#endif
    for (int i = 1; i < argc; ++i)
        if (!std::strncmp(argv[i], "--isa=", 6) && !runs_here(argv[i] + 6)) {
            std::printf("skipped: this machine has no %s\n", argv[i] + 6);
            std::fflush(stdout);
            _exit(77);
        }
}

}  // namespace

int main(int argc, char** argv)
{
    testing::InitGoogleTest(&argc, argv);
    return RUN_ALL_TESTS();
}
