#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Plants bugs in a copy of the sources and reports which of them the tests detect (docs/testing.md).
#   scripts/planted.sh                       all rules of tests/planted/rules: takes hours
#   scripts/planted.sh --sample 4            a sample, selected by the commit or by --seed S
#   scripts/planted.sh --only light film-x   single rules, or those of a module
#   scripts/planted.sh --check               only checks that every rule fits the sources: a second
set -euo pipefail
exec python3 "$(dirname "${BASH_SOURCE[0]}")/../tests/planted/planted.py" "$@"
