#!/usr/bin/env bash
# What takes too long for each change: sanitizers, clang-tidy, all planted bugs, many damaged files. docs/testing.md tells
# the last result.
#   scripts/thorough.sh                 all of it: hours
#   scripts/thorough.sh asan tidy       some of it: asan, tsan, tidy, damaged, planted
# The last line says how many parts passed and failed.
set -uo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
cd "$here"
# shellcheck source=scripts/setup.sh
source scripts/setup.sh

# Address and undefined-behaviour sanitizers over everything, with asserts, at one lane.
run_asan() {
    build_preset asan && ctest --preset asan --parallel "$(nproc)" --label-exclude "planted|thorough"
}

# Thread sanitizer over what has threads: jobs, passes, films and the build of the tree.
run_tsan() {
    build_preset tsan &&
        TSAN_OPTIONS="suppressions=$here/scripts/tsan.supp" ctest --preset tsan -R '^(Film|FilmKey|RenderPass|RenderJob|TextureDecoding|QuadLoop|base\.BvhBuild)'
}

run_tidy() {
    cmake --preset clang >/dev/null && scripts/tidy.sh build/clang
}

run_damaged() {
    build_preset test && tests/apps/damaged_files_test.py build/test/bin/fathom scenes 1000 2
}

run_planted() {
    scripts/planted.sh
}

install_missing "${packages_to_build[@]}" "${packages_to_test[@]}" libclang-rt-19-dev clang-tidy-19
parts=("$@")
[ ${#parts[@]} -gt 0 ] || parts=(asan tsan tidy damaged planted)
passed=0 failed=0
results=()
for part in "${parts[@]}"; do
    say "thorough: $part"
    begin=$SECONDS
    if "run_$part"; then
        passed=$((passed + 1)) result=passed
    else
        failed=$((failed + 1)) result=FAILED
    fi
    results+=("$part: $result in $((SECONDS - begin)) s")
done
printf '%s\n' "${results[@]}"
echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
