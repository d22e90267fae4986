#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Checks that take too long for every change: sanitizers, clang-tidy, all planted bugs, many damaged files, packages in
# minimal systems (as root).
# docs/testing.md has the latest results.
#   scripts/thorough.sh                 all checks: takes hours
#   scripts/thorough.sh asan tidy       some of asan, tsan, tidy, damaged, fuzz, packages, planted
# The last line counts passed and failed checks.
set -uo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
cd "$here"
# shellcheck source=scripts/setup.sh
source scripts/setup.sh

# Address and undefined-behavior sanitizers over all tests, with asserts, at one lane; except for the window and Slurm,
# whose tests would wait too long for images.
run_asan() {
    build_preset asan && ctest --preset asan --parallel "$(nproc)" --label-exclude "planted|thorough" --exclude-regex '^(window|slurm)$'
}

# Thread sanitizer over everything with threads: jobs, passes, films, image decoding, BVH construction, progress
# display; except for the window.
run_tsan() {
    scripts/tsan_tbb.sh &&
        build_preset tsan film_tests session_tests picture_tests geometry_tests_base fathom fathom_double fake_oidn &&
        ctest --preset tsan --no-tests=error \
            -R '^(Film|Render|TextureDecoding|QuadLoop|Invariance|base\.BvhBuild|command_line)'
}

run_tidy() {
    cmake --preset clang >/dev/null && scripts/tidy.sh build/clang
}

run_damaged() {
    build_preset test && tests/apps/damaged_files_test.py build/release/bin/fathom scenes 1000 2
}

# Three minutes of libFuzzer per reader, with sanitizers; findings are kept in build/fuzz.
run_fuzz() {
    local targets=(fathom-json gltf obj mtl ply stl mitsuba pbrt serialized image ies measured film) target found=0
    build_preset fuzz fuzz_driver "${targets[@]/#/fuzz_}" || return
    for target in "${targets[@]}"; do
        mkdir -p "build/fuzz/corpus/$target"
        build/fuzz/bin/fuzz_driver "$target" seeds "build/fuzz/corpus/$target" || return
        if ! "build/fuzz/bin/fuzz_$target" -max_total_time=180 -rss_limit_mb=2000 -timeout=120 -print_final_stats=1 \
            -artifact_prefix="build/fuzz/$target-" "build/fuzz/corpus/$target" 2>"build/fuzz/$target.log"; then
            say "fuzz $target: see build/fuzz/$target.log"
            found=1
        fi
        sed -n "s/^stat::number_of_executed_units: */fuzz $target: files: /p" "build/fuzz/$target.log"
    done
    return "$found"
}

run_packages() {
    scripts/package_test.sh
}

run_planted() {
    scripts/planted.sh
}

install_missing "${packages_to_build[@]}" "${packages_to_test[@]}" libclang-rt-19-dev clang-tidy-19 dpkg-dev
parts=("$@")
[ ${#parts[@]} -gt 0 ] || parts=(asan tsan tidy damaged fuzz packages planted)
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
