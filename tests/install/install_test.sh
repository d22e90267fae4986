#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# install_test.sh BUILD SOURCE COMPILER GENERATOR [SANITIZERS]: installs, moves the installed tree, and uses it there: runs the
# program, and builds each folder of examples with find_package(fathom) and the library's sanitizers.
set -euo pipefail
build=$1 source=$2 compiler=$3 generator=$4 sanitizers=${5:-}
place=$(mktemp -d)
trap 'rm -rf "$place"' EXIT

expect() {
    local what=$1
    shift
    "$@" || {
        echo "FAILED: $what"
        exit 1
    }
}
# Checks for a PNG signature and a plausible file size.
is_png() { [ "$(head -c 4 "$1" | tail -c 3)" = PNG ] && [ "$(stat -c %s "$1")" -gt 5000 ]; }
lanes_of() { "$1" version | grep -i simd; }

cmake --install "$build" --prefix "$place/first" >"$place/install.log"
mv "$place/first" "$place/moved here"
prefix="$place/moved here"
expect "the schema is installed" test -f "$prefix/share/doc/fathom/scene.schema.json"

# The installed libraries are used instead of those in the build folder.
libraries=$(ldd "$prefix/bin/fathom")
expect "no library is missing" test -z "$(grep 'not found' <<<"$libraries")"
expect "libfathom comes from the moved folder" grep -q "libfathom.so.0 => $prefix/bin/../lib" <<<"$libraries"
expect "nothing comes from the build folder" test -z "$(grep -F "$build/" <<<"$libraries")"
expect "the same kernel is selected as in the build folder" \
    test "$(lanes_of "$prefix/bin/fathom")" = "$(lanes_of "$build/bin/fathom")"
kernel_folder=$prefix/lib/fathom
# Nothing of the build folder may replace a missing kernel.
mkdir "$place/kernels"
mv "$kernel_folder"/libfathom_kernel-* "$place/kernels"
expect "kernels come from the moved folder only" test "$("$prefix/bin/fathom" version 2>&1 | grep -c "is missing in $kernel_folder")" = 1
mv "$place/kernels/libfathom_kernel-base.so" "$kernel_folder"
if grep -qw avx2 /proc/cpuinfo && [ -z "$sanitizers" ]; then
    message="is missing in $kernel_folder: the kernel is one lane wide, and slow"
    "$prefix/bin/fathom" render "$source/scenes/cornell-box.json" --size 8x8 --spp 1 -o "$place/narrow.png" 2>"$place/narrow.log"
    expect "a narrow kernel on a processor with AVX2 is warned of in one line" test "$(grep -c "$message" "$place/narrow.log")" = 1
    expect "fathom version says why" grep -q "^kernel: base (.* is missing in $kernel_folder)" <<<"$("$prefix/bin/fathom" version)"
fi
find "$place/kernels" -type f -exec mv {} "$kernel_folder" \;

cd "$place"
"$prefix/bin/fathom" render "$source/scenes/cornell-box.json" --size 64x48 --spp 4 --quiet -o box.png
expect "the installed program renders" is_png box.png
for module in assimp view mpi; do
    if [ -f "$build/lib/libfathom_$module.so" ]; then
        expect "the module $module lies beside the library" test -f "$prefix/lib/libfathom_$module.so"
    fi
done

# A program that uses the library must not need its dependencies (TBB, OpenEXR and others), so CMake finds none here.
build_example() {
    cmake -G "$generator" -S "$source/examples/$1" -B "$1" -DCMAKE_CXX_COMPILER="$compiler" -DCMAKE_BUILD_TYPE=Release \
        -DCMAKE_CXX_FLAGS="${sanitizers:+-fsanitize=$sanitizers}" -DCMAKE_PREFIX_PATH="$prefix" >configure.log || { cat configure.log && exit 1; }
    cmake --build "$1" >build.log || { cat build.log && exit 1; }
}
examples=(animation first_image merge_films scene_from_arrays)
expect "this test runs each folder of examples" \
    test "$(cd "$source/examples" && printf '%s ' */)" = "$(printf '%s/ ' "${examples[@]}")"
for example in "${examples[@]}"; do build_example "$example"; done

expect "first_image runs" ./first_image/first_image first.png
expect "first_image writes an image" is_png first.png
expect "scene_from_arrays runs" ./scene_from_arrays/scene_from_arrays arrays.png
expect "scene_from_arrays writes an image" is_png arrays.png
expect "animation runs" ./animation/animation 2 frame- >animation.log
expect "animation writes each frame" is_png frame-00.png
expect "animation writes each frame" is_png frame-01.png
expect "animation compiles the whole scene for its first frame only" test "$(grep -c 'whole scene' animation.log)" = 1
expect "the frames differ" test "$(cksum <frame-00.png)" != "$(cksum <frame-01.png)"
expect "merge_films makes the bits of one run" ./merge_films/merge_films "$source/scenes/cornell-box.json" .
expect "merge_films writes an image" is_png merged.png
echo "installed, moved, used"
