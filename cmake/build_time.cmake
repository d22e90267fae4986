# SPDX-License-Identifier: Apache-2.0
# Precompiled headers: most files took longer to parse common headers than to compile their own code. Every file still
# includes what it uses; a build with FATHOM_PRECOMPILE=OFF (the preset `clang`) shows missing includes.
# GCC rejects a precompiled header if a file defines another macro, so only Clang uses them by default.
set(precompile OFF)
if(CMAKE_CXX_COMPILER_ID MATCHES "Clang")
  set(precompile ON)
endif()
option(FATHOM_PRECOMPILE "Parse common headers once for many files" ${precompile})

# Keeps file times out of a precompiled header and out of the check of its sources.
function(fathom_ignore_precompile_time target)
  if(CMAKE_CXX_COMPILER_ID MATCHES "Clang")
    target_compile_options(${target} PRIVATE "SHELL:-Xclang -fno-pch-timestamp")
  endif()
endfunction()

# fathom_reuse_precompiled(TARGET FROM): the precompiled header of another target that has the same flags.
function(fathom_reuse_precompiled target from)
  if(FATHOM_PRECOMPILE)
    target_precompile_headers(${target} REUSE_FROM ${from})
    fathom_ignore_precompile_time(${target})
  endif()
endfunction()

# fathom_precompile(TARGET [HEADER...]): precompiles the common headers of the standard library and of Fathom, and the
# given ones.
function(fathom_precompile target)
  if(NOT FATHOM_PRECOMPILE)
    return()
  endif()
  target_precompile_headers(${target} PRIVATE
    <algorithm> <array> <cmath> <cstdint> <cstring> <filesystem> <functional> <map> <memory> <optional> <span> <string> <variant>
    <vector> <fmt/format.h> <fathom/description.h> <fathom/error.h> <fathom/load.h> ${ARGN})
  fathom_ignore_precompile_time(${target})
endfunction()

# fathom_unity(TARGET): compiles the target's files ten at a time, so that templates of JSON, formatting and command
# line libraries are instantiated once for all of them. Names in unnamed namespaces must therefore be unique within a
# target. FATHOM_UNITY=OFF compiles each file by itself, which is quicker after a change of one file. A local may have
# the name of something in another file, so only builds of single files warn of shadowing.
option(FATHOM_UNITY "Compile several files of a target as one" ON)
function(fathom_unity target)
  set_target_properties(${target} PROPERTIES UNITY_BUILD ${FATHOM_UNITY} UNITY_BUILD_BATCH_SIZE 10
    UNITY_BUILD_CODE_BEFORE_INCLUDE "#pragma GCC diagnostic ignored \"-Wshadow\"")
endfunction()
