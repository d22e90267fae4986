// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <string>

#include "fathom/render.h"

/// Selection of one of the kernel libraries.
namespace fathom {

/// A kernel library and the level of the x86-64 instruction set that it is compiled for.
struct KernelLevel {
    const char* name;         ///< value of FATHOM_KERNEL
    const char* file;         ///< file name of the library
    const char* requirement;  ///< what the processor must support
};

/// All kernels, the slowest first.
inline constexpr std::array<KernelLevel, 3> kernel_levels{{
    {"base", "libfathom_kernel-base.so", "nothing"},
    {"avx2", "libfathom_kernel-avx2.so", "AVX2 (x86-64-v3)"},
    {"avx512", "libfathom_kernel-avx512.so", "AVX-512 (x86-64-v4)"},
}};

/// Index in kernel_levels of the best level that the processor and the operating system support.
std::size_t supported_kernel_level();

/// Selects a kernel: the requested one, otherwise the best that is supported and installed. Throws Error for an
/// unknown, unsupported or missing kernel.
///
/// supported  result of supported_kernel_level()
/// requested  value of FATHOM_KERNEL; empty: none
/// installed  which files of kernel_levels exist
/// folder     where they were looked for, for messages
KernelChoice select_kernel(std::size_t supported, const std::string& requested,
                           const std::array<bool, kernel_levels.size()>& installed, const std::string& folder);

}  // namespace fathom
