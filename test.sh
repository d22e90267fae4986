#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Builds everything and runs the tests; installs first what that needs. Arguments go to ctest, as in
#   ./test.sh -L quick            only the quick ones
#   ./test.sh -R gltf             only those with this in their name
# The last line says how many passed, failed and were skipped.
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
cd "$here"
# shellcheck source=scripts/setup.sh
source scripts/setup.sh

# What ctest said (in a file) as "N passed, N failed, N skipped".
summary() {
    local total failed skipped
    total=$(sed -n 's/^.* tests\{0,1\} failed out of \([0-9]*\)$/\1/p' "$1" | tail -n 1)
    failed=$(sed -n 's/^.* \([0-9]*\) tests\{0,1\} failed out of [0-9]*$/\1/p' "$1" | tail -n 1)
    skipped=$(grep -c '^[[:space:]]*[0-9]* - .* (Skipped)$' "$1" || true)
    total=${total:-0} failed=${failed:-0}
    echo "$((total - failed - skipped)) passed, $failed failed, $skipped skipped"
}

install_missing "${packages_to_build[@]}" "${packages_to_test[@]}"
build_preset test
log=build/release/ctest.log
result=0
LC_ALL=C ctest --preset test --no-tests=error --parallel "$(nproc)" "$@" 2>&1 | tee "$log" || result=$?
summary "$log"
exit "$result"
