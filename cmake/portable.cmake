# SPDX-License-Identifier: Apache-2.0
# Toolchain of the preset `portable`: compiles for the system in the folder FATHOM_PORTABLE_ROOT, which scripts/portable_root.sh
# makes, so that the program runs there and on later systems. Headers and libraries are the root's; the compiler
# is this machine's.
set(CMAKE_SYSROOT $ENV{FATHOM_PORTABLE_ROOT})
if(NOT CMAKE_SYSROOT)
  message(FATAL_ERROR "FATHOM_PORTABLE_ROOT is not set: scripts/package.sh portable sets it")
endif()
set(CMAKE_C_COMPILER clang-19)
set(CMAKE_CXX_COMPILER clang++-19)
set(CMAKE_LIBRARY_ARCHITECTURE x86_64-linux-gnu)
# Libraries of the root may need functions of its glibc that the stubs lack.
set(CMAKE_EXE_LINKER_FLAGS_INIT -Wl,--allow-shlib-undefined)
# Threads and dlopen are in libraries of their own before glibc 2.34. Linking them everywhere avoids -pthread, which libraries
# would add for some files only, as precompiled headers don't allow.
set(CMAKE_HAVE_LIBC_PTHREAD TRUE)
set(CMAKE_CXX_STANDARD_LIBRARIES_INIT "-lpthread -ldl")
set(CMAKE_FIND_ROOT_PATH_MODE_PROGRAM NEVER)
set(CMAKE_FIND_ROOT_PATH_MODE_LIBRARY ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_INCLUDE ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_PACKAGE ONLY)
set(ENV{PKG_CONFIG_SYSROOT_DIR} ${CMAKE_SYSROOT})
set(ENV{PKG_CONFIG_LIBDIR} ${CMAKE_SYSROOT}/usr/lib/x86_64-linux-gnu/pkgconfig:${CMAKE_SYSROOT}/usr/share/pkgconfig)
