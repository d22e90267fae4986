#!/usr/bin/env bash
# install_test.sh BUILD SOURCE COMPILER GENERATOR [SANITIZERS]: installs, moves the installed tree elsewhere, and uses it from
# there: the program, and examples/first_picture built with find_package(fathom), and with the library's sanitizers.
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
# A PNG's first bytes, and more than a few of them.
is_png() { [ "$(head -c 4 "$1" | tail -c 3)" = PNG ] && [ "$(stat -c %s "$1")" -gt 5000 ]; }
lanes_of() { "$1" version | grep -i simd; }

cmake --install "$build" --prefix "$place/first" >"$place/install.log"
mv "$place/first" "$place/moved here"
prefix="$place/moved here"
expect "the schema is installed" test -f "$prefix/share/doc/fathom/scene.schema.json"

# The installed libraries, not those of the build folder.
libraries=$(ldd "$prefix/bin/fathom")
expect "no library is missing" test -z "$(grep 'not found' <<<"$libraries")"
expect "the kernel library comes from the moved folder" \
    grep -q "libfathom_kernel.so.0 => $prefix/bin/../lib" <<<"$libraries"
expect "nothing comes from the build folder" test -z "$(grep -F "$build/" <<<"$libraries")"
expect "the loader picks the same kernel as in the build folder" \
    test "$(lanes_of "$prefix/bin/fathom")" = "$(lanes_of "$build/bin/fathom")"

cd "$place"
"$prefix/bin/fathom" render "$source/scenes/cornell-box.json" --size 64x48 --spp 4 --quiet -o box.png
expect "the installed program renders" is_png box.png
for module in assimp view mpi; do
    if [ -f "$build/lib/libfathom_$module.so" ]; then
        expect "the module $module lies beside the library" test -f "$prefix/lib/libfathom_$module.so"
    fi
done

# TBB, OpenEXR and the others are no business of who uses the library: none is looked for here.
cmake -G "$generator" -S "$source/examples/first_picture" -B example -DCMAKE_CXX_COMPILER="$compiler" -DCMAKE_BUILD_TYPE=Release \
    -DCMAKE_CXX_FLAGS="${sanitizers:+-fsanitize=$sanitizers}" -DCMAKE_PREFIX_PATH="$prefix" >configure.log || { cat configure.log && exit 1; }
cmake --build example >build.log || { cat build.log && exit 1; }
expect "the example renders" ./example/first_picture picture.png
expect "the example wrote a picture" is_png picture.png
echo "installed, moved, used"
