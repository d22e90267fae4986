# SPDX-License-Identifier: Apache-2.0
# The compiler flags of all targets of the project.
add_library(fathom_flags INTERFACE)
target_compile_options(fathom_flags INTERFACE -Wall -Wextra -Wshadow -Wno-unused-parameter)
# With one lane a mask is a bool: & and
# are intended, as for wider masks.
if(CMAKE_CXX_COMPILER_ID MATCHES "Clang")
  target_compile_options(fathom_flags INTERFACE -Wno-bitwise-instead-of-logical)
endif()
if(FATHOM_WERROR)
  target_compile_options(fathom_flags INTERFACE -Werror)
endif()
if(FATHOM_SANITIZE)
  # Checks that sanitizers link, which would otherwise fail only after everything is compiled.
  include(CheckCXXSourceCompiles)
  set(CMAKE_REQUIRED_FLAGS -fsanitize=${FATHOM_SANITIZE})
  check_cxx_source_compiles("int main() {}" FATHOM_SANITIZER_LINKS)
  unset(CMAKE_REQUIRED_FLAGS)
  if(NOT FATHOM_SANITIZER_LINKS)
    message(FATAL_ERROR "-fsanitize=${FATHOM_SANITIZE} doesn't link. Clang 19 needs the package libclang-rt-19-dev; "
                        "or take GCC: -DCMAKE_CXX_COMPILER=g++")
  endif()
  target_compile_options(fathom_flags INTERFACE -fsanitize=${FATHOM_SANITIZE} -fno-omit-frame-pointer -g1)
  target_link_options(fathom_flags INTERFACE -fsanitize=${FATHOM_SANITIZE})
endif()
if(FATHOM_FUZZ)
  include(CheckCXXSourceCompiles)
  set(CMAKE_REQUIRED_FLAGS -fsanitize=fuzzer-no-link)
  check_cxx_source_compiles("int main() {}" FATHOM_FUZZER_COMPILES)
  unset(CMAKE_REQUIRED_FLAGS)
  if(NOT FATHOM_FUZZER_COMPILES)
    message(FATAL_ERROR "-fsanitize=fuzzer is not there: FATHOM_FUZZ needs Clang with its libraries (libclang-rt-19-dev)")
  endif()
  # Errors found by sanitizers end the program: otherwise libFuzzer would not keep the input.
  target_compile_options(fathom_flags INTERFACE -fsanitize=fuzzer-no-link -fno-sanitize-recover=all)
endif()
target_include_directories(fathom_flags INTERFACE ${PROJECT_SOURCE_DIR}/include ${PROJECT_SOURCE_DIR}/src)

# Results are equal on all machines and at all SIMD widths: no fast-math, and multiplication and addition are fused only
# where the code calls fma. errno and floating-point traps are not used.
add_library(fathom_float INTERFACE)
target_compile_options(fathom_float INTERFACE -ffp-contract=off -fno-math-errno -fno-trapping-math)

# Instruction sets of the kernel libraries, one of which libfathom opens.
set(FATHOM_ISA_FLAGS_base "")
set(FATHOM_ISA_FLAGS_x86-64-v3 -march=x86-64-v3)
# Compilers prefer 256-bit registers for code that they vectorize, unless 512 bits are requested.
set(FATHOM_ISA_FLAGS_x86-64-v4 -march=x86-64-v4 -mprefer-vector-width=512)
# GCC 12 warns of undefined operands that its own AVX-512 headers pass on purpose.
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  set(FATHOM_KERNEL_FLAGS -Wno-uninitialized -Wno-maybe-uninitialized)
endif()
# Whether a lane type is a pair of registers, which doubles the independent instructions and hides latency.
set(FATHOM_ISA_PAIRS_base 0)
set(FATHOM_ISA_PAIRS_x86-64-v3 1)
set(FATHOM_ISA_PAIRS_x86-64-v4 1)
# Register pairs for src/geometry/bvh/bvh.h, which uses 16 lanes on every instruction set with SIMD registers.
set(FATHOM_BVH_PAIRS_base 0)
set(FATHOM_BVH_PAIRS_x86-64-v3 1)
set(FATHOM_BVH_PAIRS_x86-64-v4 0)
# Sanitizer builds have the base instruction set only: with one lane the source is scalar code, which sanitizers analyze
# well. Wide kernels would take a quarter of an hour to compile with them.
if(CMAKE_SYSTEM_PROCESSOR MATCHES "x86_64|AMD64" AND NOT FATHOM_SANITIZE)
  set(FATHOM_ALL_ISAS base x86-64-v3 x86-64-v4)
else()
  set(FATHOM_ALL_ISAS base)
endif()
set(FATHOM_ISAS "${FATHOM_ALL_ISAS}" CACHE STRING "Instruction sets of the kernel library; fewer build sooner")
# FATHOM_HOST_ISAS: those of FATHOM_ISAS that this machine can run.
include(CheckCXXSourceRuns)
set(FATHOM_HOST_ISAS)
foreach(isa IN LISTS FATHOM_ISAS)
  string(MAKE_C_IDENTIFIER ${isa} name)
  if(NOT isa STREQUAL base)
    check_cxx_source_runs("int main() { return __builtin_cpu_supports(\"${isa}\") ? 0 : 1; }" FATHOM_RUNS_${name})
  endif()
  if(isa STREQUAL base OR FATHOM_RUNS_${name})
    list(APPEND FATHOM_HOST_ISAS ${isa})
  endif()
endforeach()
