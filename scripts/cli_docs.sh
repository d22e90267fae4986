#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Writes docs/cli.md from the tables of --help. See tests/apps/cli_markdown.cpp.
#   scripts/cli_docs.sh [BUILD]     BUILD: a build with tests, default build/release
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
build=${1:-build/release}
cmake --build "$build" --target cli_markdown
"$build/bin/cli_markdown" > docs/cli.md
echo "wrote docs/cli.md"
