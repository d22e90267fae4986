// SPDX-License-Identifier: Apache-2.0
#include "kernel/library/selection.h"

#include <gtest/gtest.h>

#include "fathom/error.h"

namespace fathom {
namespace {

constexpr std::size_t base = 0, avx2 = 1, avx512 = 2;
constexpr std::array<bool, 3> all{true, true, true};

std::string error_of(std::size_t supported, const std::string& requested, const std::array<bool, 3>& installed)
{
    try {
        select_kernel(supported, requested, installed, "/lib/fathom");
    } catch (const Error& error) {
        return error.what();
    }
    return "";
}

TEST(KernelSelection, TakesTheBestSupportedKernel)
{
    const char* const names[] = {"base", "avx2", "avx512"};
    for (std::size_t supported : {base, avx2, avx512})
        EXPECT_EQ(select_kernel(supported, "", all, "").name, names[supported]);
}

TEST(KernelSelection, FallsBackToTheNextInstalledKernel)
{
    const KernelChoice choice = select_kernel(avx512, "", {true, true, false}, "/lib/fathom");
    EXPECT_EQ(choice.name, "avx2");
    EXPECT_EQ(choice.reason, "libfathom_kernel-avx512.so is missing in /lib/fathom");
    EXPECT_EQ(choice.warning, "");
}

TEST(KernelSelection, WarnsIfAProcessorWithAvx2GetsOneLane)
{
    const KernelChoice choice = select_kernel(avx2, "", {true, false, false}, "/lib/fathom");
    EXPECT_EQ(choice.name, "base");
    EXPECT_EQ(choice.warning,
              "libfathom_kernel-avx2.so is missing in /lib/fathom: the kernel is one lane wide, and slow");
    EXPECT_EQ(select_kernel(base, "", all, "").warning,
              "this machine supports neither AVX2 nor AVX-512: the kernel is one lane wide, and slow");
}

TEST(KernelSelection, ObeysARequestWithoutAWarning)
{
    const KernelChoice choice = select_kernel(avx512, "base", all, "");
    EXPECT_EQ(choice.name, "base");
    EXPECT_EQ(choice.reason, "FATHOM_KERNEL requests it");
    EXPECT_EQ(choice.warning, "");
}

TEST(KernelSelection, RefusesRequestsThatCanNotBeMet)
{
    EXPECT_EQ(error_of(avx512, "neon", all), "FATHOM_KERNEL: expected avx512, avx2 or base, found 'neon'");
    EXPECT_EQ(error_of(avx2, "avx512", all), "FATHOM_KERNEL=avx512: this machine does not support AVX-512 (x86-64-v4)");
    EXPECT_EQ(error_of(avx2, "avx2", {true, false, false}),
              "the kernel library libfathom_kernel-avx2.so is missing in /lib/fathom");
    EXPECT_EQ(error_of(base, "", {false, true, true}),
              "the kernel library libfathom_kernel-base.so is missing in /lib/fathom");
}

TEST(KernelSelection, SupportedLevelIsThatOfTheProcessorsFlags)
{
    const auto has = [](const char* isa) { return kernel_levels[supported_kernel_level()].name == std::string(isa); };
    const bool wide = __builtin_cpu_supports("avx512vl") && __builtin_cpu_supports("avx512bw");
    EXPECT_TRUE(has(wide ? "avx512" : __builtin_cpu_supports("avx2") ? "avx2" : "base"));
}

}  // namespace
}  // namespace fathom
