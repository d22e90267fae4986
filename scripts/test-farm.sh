#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Tests of farm/: installs validators and runners of schedulers into build/farm and the build's packages, builds, and
# runs the tests.
#   scripts/test-farm.sh
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
# shellcheck source=scripts/setup.sh
source scripts/setup.sh
install_missing "${packages_to_build[@]}" "${packages_to_test[@]}" python3-venv parallel busybox-static strace
if [ ! -x build/farm/bin/python ]; then
    python3 -m venv build/farm
fi
build/farm/bin/python -m pip install --quiet pyyaml==6.* kubernetes-validate==1.37.* openjd-cli==0.8.* botocore==1.44.* \
    opencue-pyoutline==1.37.* 'dask[distributed]==2026.8.*'
build_preset test
exec python3 tests/farm/farm_test.py build/release/bin/fathom build/release/bin/picture_hash build/release
