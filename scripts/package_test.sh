#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Runs the commands of docs/install.md for the tarball, the Debian packages, the container and the wheel in minimal
# systems, and checks the packages. (scripts/bare_machine_test.sh does so for the sources.)
#   scripts/package_test.sh [FOLDER]     FOLDER: packages of scripts/package.sh and wheels; default: makes them
# FATHOM_ROOT names a folder with a minimal Debian 12 to copy instead of making one by debootstrap, FATHOM_OLD_ROOT one
# with Debian 11. FATHOM_PORTABLE=1: the tarball is one for older systems (scripts/package.sh portable).
# Needs root, debootstrap and a source of Debian packages (the first one of this machine's apt); takes some minutes. There
# is no container engine: scripts/containerfile.sh executes the steps of the Containerfile.
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
cd "$here"
# shellcheck source=scripts/setup.sh
source scripts/setup.sh
install_missing debootstrap lintian
work=$(mktemp -d)
chmod 755 "$work"
cleanup() {
    local root
    for root in "$work"/*/proc; do umount "$root" 2>/dev/null || true; done
    # Never deletes through a mount that still exists.
    if ! grep -q " $work/" /proc/mounts; then rm -rf --one-file-system "$work"; fi
}
trap cleanup EXIT
packages=${1:-$work/packages}
if [ $# -eq 0 ]; then
    scripts/package.sh all "$packages"
    scripts/wheel.sh --output "$packages" /usr/bin/python3
fi
packages=$(realpath "$packages")
# The folder that a tarball is unpacked to.
unpacked=fathom-$(sed -n 's/^project(fathom VERSION \([0-9.]*\).*/\1/p' CMakeLists.txt)
failures=0

# check TEXT COMMAND...: prints whether the command succeeds.
check() {
    local text=$1
    shift
    if "$@" >"$work/check.log" 2>&1; then
        echo "ok      $text"
    else
        echo "FAILED  $text"
        sed 's/^/        /' "$work/check.log"
        failures=$((failures + 1))
    fi
}

# Prints the commands of a section of docs/install.md, which are indented.
commands_of() {
    awk -v heading="## $1" '/^## / { inside = $0 == heading } inside && /^    / { print substr($0, 5) }' docs/install.md
}

# new_root NAME [SUITE]: a copy of a minimal system, which is made once; with a folder /try in it.
new_root() {
    local root=$work/$1 suite=${2:-bookworm} minimal mirror
    minimal=${FATHOM_ROOT:-$work/bookworm}
    if [ "$suite" != bookworm ]; then minimal=${FATHOM_OLD_ROOT:-$work/$suite}; fi
    if [ ! -d "$minimal" ]; then
        # shellcheck disable=SC2016  # $(REPO_URI) is for apt-get
        mirror=$(apt-get indextargets --format '$(REPO_URI)' 'Created-By: Packages' | grep -E '/debian/?$' | head -n 1)
        debootstrap --variant=minbase "$suite" "$minimal" "$mirror" >"$work/debootstrap.log" || fail "debootstrap (see $work/debootstrap.log)"
    fi
    cp -a "$minimal" "$root"
    cp /etc/resolv.conf "$root/etc/resolv.conf"
    # pip trusts the certificates that this machine trusts.
    cp --dereference /etc/ssl/certs/ca-certificates.crt "$root/etc"
    mount -t proc proc "$root/proc"
    mkdir "$root/try"
    cp "$work/model.glb" "$root/try"
}

# inside ROOT: runs the commands of standard input in a root's folder /try; stops at the first that fails.
inside() {
    chroot "$work/$1" /usr/bin/env -i PATH=/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin HOME=/root LC_ALL=C \
        DEBIAN_FRONTEND=noninteractive PIP_CERT=/etc/ca-certificates.crt bash -ec 'cd /try; source /dev/stdin'
}

is_png() { [ "$(head -c 4 "$1" | tail -c 3)" = PNG ] && [ "$(stat -c %s "$1")" -gt 5000 ]; }

is_small() { [ "$(stat -c %s "$1")" -le "$2" ]; }

is_version_at_most() { [ "$(printf '%s\n' "$@" | sort -V | head -n 1)" = "$1" ]; }

# needed_version FOLDER NAMESPACE: the newest version of a library (GLIBC, GLIBCXX) that any file of an unpacked tarball needs.
needed_version() {
    find "$1/bin" "$1/lib" -type f \( -name fathom -o -name '*.so*' \) -exec objdump -T {} + 2>/dev/null | grep -oE "\<$2_[0-9.]+" | sed 's/.*_//' | sort -Vu | tail -n 1
}

test_tarball() {
    local tarball
    tarball=$(echo "$packages"/fathom-*-linux-x86_64.tar.gz)
    echo "        $(basename "$tarball"): $(stat -c %s "$tarball") bytes"
    check "the tarball has at most 15 MB" is_small "$tarball" 15000000
    new_root tarball
    cp "$tarball" "$work/tarball/try"
    check "the tarball's commands of docs/install.md work" inside tarball < <(commands_of Tarball)
    check "the tarball's program wrote an image" is_png "$work/tarball/try/model.png"
    cp "$work/tarball/try/model.png" "$work/model-12.png"
    check "the unpacked folder can be moved" inside tarball <<<"mv $unpacked '/opt/other name'; rm model.png
        '/opt/other name/bin/fathom' render model.glb --size 99x77 --spp 4; test -s model.png"
    cp "$work/tarball/try/model.png" "$work/small-12.png"
    check "no library is missing" inside tarball <<<'! ldd "/opt/other name/bin/fathom" "/opt/other name"/lib/libfathom.so.0 | grep "not found"'
    check "the fastest kernel is used" inside tarball <<<'"/opt/other name/bin/fathom" version | grep "^kernel: .*the best that this machine supports"'
    check "a missing library of the window is one error" inside tarball <<<'"/opt/other name/bin/fathom" view model.glb 2>&1 | grep "can.t be loaded: lib.*No such file"'
    tar xzf "$tarball" -C "$work"
    if [ -n "${FATHOM_PORTABLE:-}" ]; then
        test_old_system "$tarball"
    else
        check "glibc 2.35 is enough (needed: $(needed_version "$work/$unpacked" GLIBC))" test "$(needed_version "$work/$unpacked" GLIBC)" = 2.35
    fi
}

# Checks the versions that a tarball for older systems needs, and runs it in Debian 11.
test_old_system() {
    local glibc libstdcxx
    glibc=$(needed_version "$work/$unpacked" GLIBC) libstdcxx=$(needed_version "$work/$unpacked" GLIBCXX)
    check "glibc 2.28 is enough (needed: $glibc)" is_version_at_most "$glibc" 2.28
    check "the libstdc++ of GCC 8 is enough (needed: $libstdcxx)" is_version_at_most "$libstdcxx" 3.4.25
    new_root old bullseye
    cp "$1" "$work/old/try"
    check "the tarball's commands of docs/install.md work in Debian 11" inside old < <(commands_of Tarball)
    check "the tarball's program wrote an image in Debian 11" is_png "$work/old/try/model.png"
    check "the images of Debian 11 and 12 are equal" cmp "$work/old/try/model.png" "$work/model-12.png"
    test_formats_in_old_system
}

# Renders files of other formats in Debian 11 and on this machine: the images are equal.
test_formats_in_old_system() {
    local file files=(pyramid.obj pyramid.off) draco=../shared/scenes/gltf/Duck/glTF-Draco
    printf '%s\n' 'v -1 0 -1' 'v 1 0 -1' 'v 0 0 1' 'v 0 1 0' 'f 1 2 3' 'f 1 4 2' 'f 2 4 3' 'f 3 4 1' >"$work/pyramid.obj"
    # Assimp reads OFF.
    printf '%s\n' OFF '4 4 6' '-1 0 -1' '1 0 -1' '0 0 1' '0 1 0' '3 0 1 2' '3 0 3 1' '3 1 3 2' '3 2 3 0' >"$work/pyramid.off"
    if [ -e "$draco" ]; then
        cp --no-preserve=mode "$draco"/* "$work"
        cp --no-preserve=mode "$draco"/* "$work/old/try"
        files+=(Duck.gltf)
    else
        echo "skipped a file that Draco compressed: there is no $draco"
    fi
    for file in "${files[@]}"; do
        cp "$work/$file" "$work/old/try"
        check "Debian 11 renders $file" inside old <<<"$unpacked/bin/fathom render $file --size 99x77 --spp 4 -o $file.png"
        check "this machine renders $file" "$work/$unpacked/bin/fathom" render "$work/$file" --size 99x77 --spp 4 -o "$work/$file.png"
        check "the images of $file are equal" cmp "$work/old/try/$file.png" "$work/$file.png"
    done
}

# Runs the thumbnailer's command as a file manager does, and checks image and time.
test_thumbnailer() {
    local command
    command=$(sed -n 's/^Exec=//p' "$work/deb/usr/share/thumbnailers/fathom.thumbnailer")
    command=${command//%s/256} command=${command//%i//try/large.ply} command=${command//%o//tmp/thumbnail}
    cp "$work/large.ply" "$work/deb/try"
    local begin time ms=1000000
    for _ in 1 2 3 4 5; do  # the first reads libraries from the disk; on a busy machine, the quickest counts
        begin=${EPOCHREALTIME/./}
        inside deb <<<"$command"
        time=$(((${EPOCHREALTIME/./} - begin) / 1000))
        if [ "$time" -lt "$ms" ]; then ms=$time; fi
    done
    echo "thumbnail of $(stat -c %s "$work/large.ply") bytes: $ms ms"
    is_png "$work/deb/tmp/thumbnail" && [ "$ms" -le 1000 ]
}

# Compiles an example against both packages, unpacked in a folder.
test_dev() {
    for package in "$packages"/*.deb; do dpkg-deb -x "$package" "$work/dev"; done
    cmake -S examples/first_image -B "$work/example" -DCMAKE_PREFIX_PATH="$work/dev/usr" && cmake --build "$work/example" &&
        "$work/example/first_image" "$work/first.png"
}

test_debs() {
    local lint
    lint=$(lintian --no-tag-display-limit --fail-on none "$packages"/*.deb)
    check "lintian reports no errors" test -z "$(grep '^E:' <<<"$lint")"
    grep '^[EW]:' <<<"$lint" | sed 's/^/        /' || true
    new_root deb
    cp "$packages"/*.deb "$work/deb/try"
    check "the Debian packages' commands of docs/install.md work" inside deb < <(commands_of "Debian package" | sed 's/install --yes/& --no-install-recommends/')
    check "the package's program wrote an image" is_png "$work/deb/try/model.png"
    check "the manual page is installed" inside deb <<<'zcat /usr/share/man/man1/fathom.1.gz | grep -q "fathom render"'
    check "a thumbnail of 256 pixels takes at most a second" test_thumbnailer
    sed 's/^/        /' "$work/check.log"
    check "a program finds the library by CMake" test_dev
    check "the package can be removed" inside deb <<<'apt-get remove --yes fathom-render; ! command -v fathom; ! test -e /usr/lib/fathom-render/lib'
}

# Executes the Containerfile's steps, then the command that docs/install.md has after the image's name.
test_container() {
    new_root container
    mkdir -m 777 "$work/container/work"
    cp "$work/model.glb" "$work/container/work"
    check "the container's command of docs/install.md works" container_command
    check "the container's program wrote an image as an unprivileged user" test "$(cd "$work/container/work" && stat -c %u model.png)" = 10001
}
container_command() {
    local words
    read -ra words < <(commands_of Container | sed -n 's/^podman run .* fathom //p')
    [ "${words[0]}" = render ] && scripts/containerfile.sh farm/container/Containerfile "$packages" "$work/container" "${words[@]}"
}

# Installs the wheel in a virtual environment of a system without a compiler, as docs/install.md does, and renders.
test_wheel() {
    local wheel
    # Debian 12 has Python 3.11.
    wheel=$(find "$packages" -name 'fathom_render-*-cp311-*.whl')
    echo "        $(basename "$wheel"): $(stat -c %s "$wheel") bytes"
    new_root wheel
    mkdir -p "$work/wheel/try/build/wheels"
    cp "$wheel" "$work/wheel/try/build/wheels"
    check "the wheel's system has Python" inside wheel <<<'apt-get update; apt-get install --yes --no-install-recommends python3-venv; python3 -m venv /venv'
    check "the wheel's command of docs/install.md works" inside wheel < <(echo 'source /venv/bin/activate'; commands_of Wheel | grep '^pip install build')
    # The program of the tarball, which package.sh built, and the wheel's, from the shell and from Python, write the same bits.
    check "the wheel's program renders" inside wheel <<<'/venv/bin/fathom render model.glb --size 99x77 --spp 4 -o command.png'
    check "Python renders with the wheel" inside wheel <<<'/venv/bin/python -c "import fathom; fathom.render(\"model.glb\", size=(99, 77), spp=4).save(\"python.png\")"; cmp command.png python.png'
    check "the wheel's image is the tarball's" cmp "$work/wheel/try/command.png" "$work/small-12.png"
    check "there is no compiler" inside wheel <<<'! command -v cc c++ gcc g++ clang'
}

tar xzf "$packages"/fathom-*-linux-x86_64.tar.gz -C "$work"
program=$work/$unpacked/bin/fathom
# A model with a camera and a light of its own, whose image of default size and samples takes half a minute of one core.
cat >"$work/model.json" <<'JSON'
{"fathom": 1, "materials": {"red": {"kind": "diffuse", "color": [0.8, 0.1, 0.1]}},
 "camera": {"position": [3, 2, 4], "look_at": [0, 0, 0]},
 "scene": [{"material": "red", "box": {"min": [-1, -1, -1], "max": [1, 1, 1]}}],
 "lights": {"lamp": {"kind": "point", "position": [2, 4, 3], "intensity": 300}}}
JSON
"$program" convert "$work/model.json" "$work/model.glb" >/dev/null 2>&1
# A binary PLY of 10 MB: a grid of 500 x 500 vertices, rounded to a bump.
python3 - "$work/large.ply" <<'PYTHON'
import math, struct, sys
n = 512
with open(sys.argv[1], "wb") as file:
    file.write(f"ply\nformat binary_little_endian 1.0\nelement vertex {n * n}\nproperty float x\nproperty float y\nproperty float z\n"
               f"element face {2 * (n - 1) ** 2}\nproperty list uchar int vertex_indices\nend_header\n".encode())
    for i in range(n * n):
        x, y = i % n / n - 0.5, i // n / n - 0.5
        file.write(struct.pack("<3f", x, 0.3 * math.cos(20 * math.hypot(x, y)), y))
    for i in range((n - 1) ** 2):
        a = i // (n - 1) * n + i % (n - 1)
        file.write(struct.pack("<B3iB3i", 3, a, a + n, a + 1, 3, a + 1, a + n, a + n + 1))
PYTHON
rm -r "$work/$unpacked"
test_tarball
test_debs
test_container
test_wheel
[ "$failures" -eq 0 ] || fail "package_test: $failures failed"
echo "packages: passed"
