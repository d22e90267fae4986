#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Tests with a real Open MPI and a real Slurm on one machine: installs them and the build's packages, builds, and runs
# the tests.
#   scripts/test-cluster.sh            about three minutes
#   scripts/test-cluster.sh long       more parts, more faults, time limits: a quarter of an hour
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
# shellcheck source=scripts/setup.sh
source scripts/setup.sh
install_missing "${packages_to_build[@]}" "${packages_to_test[@]}"
build_preset test
programs=(build/release/bin/fathom build/release/bin/picture_hash scenes/cornell-box.json)
python3 tests/apps/distributed/mpi_test.py "${programs[@]}"
exec python3 tests/apps/distributed/slurm_test.py "${programs[@]}" "$@"
