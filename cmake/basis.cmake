# SPDX-License-Identifier: Apache-2.0
# Basis Universal's transcoder, for KTX2 images (docs/formats.md). Debian and Ubuntu don't package it; cargo fetches its
# sources as a crate, with a checksum. Without cargo or network, Fathom is built without KTX2.
set(FATHOM_BASIS_VERSION 0.3.1)
set(FATHOM_BASIS_SOURCES "" CACHE PATH "Sources of Basis Universal; empty: fetched by cargo")
set(basis_sources ${FATHOM_BASIS_SOURCES})
if(NOT basis_sources)
  set(crates ${CMAKE_BINARY_DIR}/crates)
  set(basis_sources ${crates}/vendor/basis-universal-sys/vendor/basis_universal)
  find_program(FATHOM_CARGO cargo DOC "Fetches Basis Universal")
  if(FATHOM_CARGO AND NOT EXISTS ${basis_sources}/transcoder/basisu_transcoder.cpp)
    file(WRITE ${crates}/lib.rs "")
    file(WRITE ${crates}/Cargo.toml
         "[package]\nname = \"crates\"\nversion = \"0.0.0\"\n[lib]\npath = \"lib.rs\"\n"
         "[dependencies]\nbasis-universal-sys = \"=${FATHOM_BASIS_VERSION}\"\n[workspace]\n")
    message(STATUS "Fetching Basis Universal")
    execute_process(COMMAND ${FATHOM_CARGO} vendor --quiet vendor WORKING_DIRECTORY ${crates} TIMEOUT 120
                    OUTPUT_QUIET ERROR_QUIET RESULT_VARIABLE ignored)
  endif()
endif()
if(NOT EXISTS ${basis_sources}/transcoder/basisu_transcoder.cpp)
  message(STATUS "Basis Universal is not there: pictures in KTX2 can't be read")
  return()
endif()

enable_language(C)
add_library(fathom_basis STATIC ${basis_sources}/transcoder/basisu_transcoder.cpp ${basis_sources}/zstd/zstddeclib.c)
target_include_directories(fathom_basis SYSTEM PUBLIC ${basis_sources}/transcoder)
target_compile_definitions(fathom_basis PUBLIC BASISD_SUPPORT_KTX2=1 BASISD_SUPPORT_KTX2_ZSTD=1)
# Only uncompressed pixels are needed: no tables of other texture formats.
foreach(format DXT1 DXT5A BC7 BC7_MODE5 PVRTC1 PVRTC2 ETC2_EAC_A8 ETC2_EAC_RG11 ATC ASTC FXT1)
  target_compile_definitions(fathom_basis PUBLIC BASISD_SUPPORT_${format}=0)
endforeach()
# Its asserts fail on damaged files, for which its functions return errors.
target_compile_definitions(fathom_basis PRIVATE NDEBUG)
target_compile_options(fathom_basis PRIVATE -w -fno-strict-aliasing)
