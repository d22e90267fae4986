#!/usr/bin/env bash
# Mutation testing of a change: alters the changed lines one place at a time and lists what no test sees (docs/testing.md).
#   scripts/mutate.sh --base main             lines that differ from main: 20 alterations at random
#   scripts/mutate.sh --base main --list      only shows them
#   scripts/mutate.sh --max 100 src/film      100, of the last commit, in one folder
set -euo pipefail
exec python3 "$(dirname "${BASH_SOURCE[0]}")/../tests/planted/mutate.py" "$@"
