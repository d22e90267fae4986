# SPDX-License-Identifier: Apache-2.0
# nanobind, which binds C++ to Python. Distributions package it rarely; it is a Python package. If the interpreter lacks
# it, a virtual environment in the build folder gets it, together with what the tests of the Python package need.
function(fathom_find_nanobind python)
  execute_process(COMMAND ${python} -m nanobind --cmake_dir OUTPUT_VARIABLE folder ERROR_QUIET
                  OUTPUT_STRIP_TRAILING_WHITESPACE RESULT_VARIABLE failed)
  if(NOT failed)
    set(nanobind_DIR ${folder} CACHE PATH "CMake files of nanobind" FORCE)
  endif()
endfunction()

if(FATHOM_TESTS AND NOT SKBUILD)
  if(NOT EXISTS ${FATHOM_PYTHON_VENV}/complete)
    message(STATUS "Making a virtual environment for the Python package")
    execute_process(COMMAND ${Python_EXECUTABLE} -m venv ${FATHOM_PYTHON_VENV} OUTPUT_QUIET ERROR_QUIET)
    execute_process(COMMAND ${FATHOM_PYTHON_VENV}/bin/pip install --quiet --disable-pip-version-check nanobind numpy
                            pytest TIMEOUT 300 OUTPUT_QUIET ERROR_QUIET RESULT_VARIABLE failed)
    if(NOT failed)
      file(TOUCH ${FATHOM_PYTHON_VENV}/complete)
    endif()
  endif()
  fathom_find_nanobind(${FATHOM_PYTHON_VENV}/bin/python)
else()
  fathom_find_nanobind(${Python_EXECUTABLE})
endif()
find_package(nanobind CONFIG QUIET)
if(NOT nanobind_FOUND)
  message(STATUS "nanobind was not found: the Python package is not built (pip install nanobind)")
endif()
