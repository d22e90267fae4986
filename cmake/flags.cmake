# What every target of the project compiles with.
add_library(fathom_flags INTERFACE)
target_compile_options(fathom_flags INTERFACE -Wall -Wextra -Wshadow -Wno-unused-parameter)
# A mask of one lane is a bool: & and | are meant, as they are at the other widths.
if(CMAKE_CXX_COMPILER_ID MATCHES "Clang")
  target_compile_options(fathom_flags INTERFACE -Wno-bitwise-instead-of-logical)
endif()
if(FATHOM_WERROR)
  target_compile_options(fathom_flags INTERFACE -Werror)
endif()
if(FATHOM_SANITIZE)
  # Else every file is compiled before the first linker says so.
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
  # What the sanitizers find ends the program, or libFuzzer would not keep the file.
  target_compile_options(fathom_flags INTERFACE -fsanitize=fuzzer-no-link -fno-sanitize-recover=all)
endif()
target_include_directories(fathom_flags INTERFACE ${PROJECT_SOURCE_DIR}/include ${PROJECT_SOURCE_DIR}/src)

# The same bits on every machine and at every width: a product and a sum become one rounding only where the code says
# fma; no fast-math. errno and traps decide nothing here.
add_library(fathom_float INTERFACE)
target_compile_options(fathom_float INTERFACE -ffp-contract=off -fno-math-errno -fno-trapping-math)

# Instruction sets of the kernel library; the dynamic loader picks one.
set(FATHOM_ISA_FLAGS_base "")
set(FATHOM_ISA_FLAGS_x86-64-v3 -march=x86-64-v3)
# 512-bit registers must be asked for: compilers prefer 256 bits for code that they vectorise by themselves.
set(FATHOM_ISA_FLAGS_x86-64-v4 -march=x86-64-v4 -mprefer-vector-width=512)
# GCC 12 warns of the undefined operands that its own AVX-512 headers pass on purpose.
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  set(FATHOM_KERNEL_FLAGS -Wno-uninitialized -Wno-maybe-uninitialized)
endif()
# Whether a lane type is a pair of registers: twice the independent instructions to hide latency with.
set(FATHOM_ISA_PAIRS_base 0)
set(FATHOM_ISA_PAIRS_x86-64-v3 1)
set(FATHOM_ISA_PAIRS_x86-64-v4 1)
# The same for the tree of src/geometry/bvh/bvh.h, which has 16 lanes wherever there are registers.
set(FATHOM_BVH_PAIRS_base 0)
set(FATHOM_BVH_PAIRS_x86-64-v3 1)
set(FATHOM_BVH_PAIRS_x86-64-v4 0)
# Sanitizers get the base alone: at one lane the same source is ordinary code, which they see through, and they need a
# quarter of an hour to compile the wide kernels.
if(CMAKE_SYSTEM_PROCESSOR MATCHES "x86_64|AMD64" AND NOT FATHOM_SANITIZE)
  set(FATHOM_ALL_ISAS base x86-64-v3 x86-64-v4)
else()
  set(FATHOM_ALL_ISAS base)
endif()
set(FATHOM_ISAS "${FATHOM_ALL_ISAS}" CACHE STRING "Instruction sets of the kernel library; fewer build sooner")
