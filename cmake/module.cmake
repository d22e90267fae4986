# SPDX-License-Identifier: Apache-2.0
# fathom_module(TARGET SOURCES file... LINKS library...): a plugin next to libfathom, which the program opens when
# needed. Its version must equal the program's.
function(fathom_module target)
  cmake_parse_arguments(MODULE "" "" "SOURCES;LINKS" ${ARGN})
  add_library(${target} MODULE ${MODULE_SOURCES})
  target_link_libraries(${target} PRIVATE fathom_flags ${MODULE_LINKS})
  target_compile_definitions(${target} PRIVATE FATHOM_VERSION="${PROJECT_VERSION}")
  install(TARGETS ${target} LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR})
endfunction()
