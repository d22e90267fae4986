#include <gtest/gtest.h>

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

}  // namespace

int main(int argc, char** argv)
{
    for (int i = 1; i < argc; ++i)
        if (!std::strncmp(argv[i], "--isa=", 6) && !runs_here(argv[i] + 6)) {
            std::printf("skipped: this machine has no %s\n", argv[i] + 6);
            return 77;
        }
    testing::InitGoogleTest(&argc, argv);
    return RUN_ALL_TESTS();
}
