#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Mutation testing of a change: alters the changed lines one place at a time and lists the mutants that no test detects
# (docs/testing.md).
#   scripts/mutate.sh --base main             mutates lines that differ from main: 20 random mutants
#   scripts/mutate.sh --base main --list      only lists the mutants
#   scripts/mutate.sh --max 100 src/film      100 mutants of the last commit, in one folder
set -euo pipefail
exec python3 "$(dirname "${BASH_SOURCE[0]}")/../tests/planted/mutate.py" "$@"
