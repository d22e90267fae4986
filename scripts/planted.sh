#!/usr/bin/env bash
# Plants bugs in a copy of the sources and tells which of them the tests see (docs/testing.md).
#   scripts/planted.sh                       all of tests/planted/rules: hours
#   scripts/planted.sh --sample 4            some of them, chosen by the commit, or by --seed S
#   scripts/planted.sh --only light film-x   one rule, or those of a module
#   scripts/planted.sh --check               only whether every rule still fits the sources: a second
set -euo pipefail
exec python3 "$(dirname "${BASH_SOURCE[0]}")/../tests/planted/planted.py" "$@"
