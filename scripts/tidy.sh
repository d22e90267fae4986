#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Runs clang-tidy over all sources with the checks of .clang-tidy; any finding is a failure.
#   scripts/tidy.sh [FOLDER [NAME]]    FOLDER: a build with compile_commands.json (default build/clang)
#                                      NAME: only files with that in their path
# Lane code is checked once, with the base instruction set.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
folder=${1:-build/clang} name=${2:-}
tidy=${CLANG_TIDY:-clang-tidy-19}
if ! command -v "$tidy" >/dev/null; then
    echo "skipped: $tidy is not installed"
    exit 77
fi
[ -f "$folder/compile_commands.json" ] || { echo "there is no $folder/compile_commands.json: configure it first"; exit 1; }

# Findings in third-party headers are dropped with their notes: the static analyzer reports them even if .clang-tidy
# excludes headers.
finding='^(.*:[0-9]+:[0-9]+: )?(warning|error): '
ours() {
    awk -v project="$PWD/" -v finding="$finding" '
        /^[0-9]+ warnings?( and [0-9]+ errors?)? (generated|treated as errors?)|^Suppressed|^Use -header-filter/ { next }
        $0 ~ finding { ours = $0 !~ /^\// || index($0, project) == 1 }
        ours'
}

# Makes a compilation database of the first compile command of each project file.
base=$(mktemp -d)
trap 'rm -r "$base"' EXIT
python3 - "$folder" "$base" "$PWD" "$name" >"$base/files" <<'PYTHON'
import json, os, sys

folder, base, project, name = sys.argv[1:]
first = {}
for entry in json.load(open(os.path.join(folder, "compile_commands.json"))):
    path = os.path.relpath(os.path.join(entry["directory"], entry["file"]), project)
    if path.split(os.sep)[0] in ("src", "apps", "tests", "bench", "examples") and name in path:
        first.setdefault(path, entry)
json.dump(list(first.values()), open(os.path.join(base, "compile_commands.json"), "w"))
print("\n".join(sorted(first)))
PYTHON
files=$(grep -c . "$base/files") || { echo "no file has $name in its path"; exit 1; }
echo "$files files"
xargs -a "$base/files" -n 1 -P "${FATHOM_JOBS:-$(nproc)}" "$tidy" -p "$base" --quiet --warnings-as-errors='*' 2>&1 |
    ours >"$base/said" || true
cat "$base/said"
findings=$(grep -c -E "$finding" "$base/said" || true)
echo "$findings findings"
[ "$findings" -eq 0 ]
