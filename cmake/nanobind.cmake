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

# Installs packages into the virtual environment, once: a file of this name tells that it was done.
function(fathom_install_packages done)
  if(EXISTS ${FATHOM_PYTHON_VENV}/${done})
    return()
  endif()
  message(STATUS "Installing Python packages for tests: ${ARGN}")
  execute_process(COMMAND ${FATHOM_PYTHON_VENV}/bin/pip install --quiet --disable-pip-version-check ${ARGN}
                  TIMEOUT 300 OUTPUT_QUIET ERROR_QUIET RESULT_VARIABLE failed)
  if(NOT failed)
    file(TOUCH ${FATHOM_PYTHON_VENV}/${done})
  endif()
endfunction()

if(FATHOM_TESTS AND NOT SKBUILD)
  if(NOT EXISTS ${FATHOM_PYTHON_VENV}/bin/pip)
    execute_process(COMMAND ${Python_EXECUTABLE} -m venv ${FATHOM_PYTHON_VENV} OUTPUT_QUIET ERROR_QUIET)
  endif()
  fathom_install_packages(complete nanobind numpy pytest)
  # Tools that read data sets. Their tests are skipped without them.
  fathom_install_packages(dataset-tools embreex pillow pycocotools trimesh)
  fathom_find_nanobind(${FATHOM_PYTHON_VENV}/bin/python)
else()
  fathom_find_nanobind(${Python_EXECUTABLE})
endif()
find_package(nanobind CONFIG QUIET)
if(NOT nanobind_FOUND)
  message(STATUS "nanobind was not found: the Python package is not built (pip install nanobind)")
endif()
