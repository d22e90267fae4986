#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Formats all sources by .clang-format.
#   scripts/format.sh             formats in place
#   scripts/format.sh --check     changes nothing; lists the files that need formatting and fails if there are any
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
format=${CLANG_FORMAT:-clang-format-19}
if ! command -v "$format" >/dev/null; then
    echo "skipped: $format is not installed"
    exit 77
fi
mapfile -t files < <(find include src apps python/src tests bench examples -name '*.h' -o -name '*.cpp' | sort)
if [ "${1:-}" != --check ]; then
    exec "$format" -i "${files[@]}"
fi
if ! "$format" --dry-run -Werror --ferror-limit=1 "${files[@]}" 2>/dev/null; then
    for file in "${files[@]}"; do
        "$format" --dry-run -Werror --ferror-limit=1 "$file" 2>/dev/null || echo "$file: scripts/format.sh would change it"
    done
    exit 1
fi
echo "${#files[@]} files are as .clang-format says"
