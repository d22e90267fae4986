#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Builds packages of Fathom, as docs/install.md describes them.
#   scripts/package.sh tarball [FOLDER]     fathom-VERSION-linux-x86_64.tar.gz: unpack it anywhere
#   scripts/package.sh deb [FOLDER]         fathom-render_VERSION_amd64.deb and fathom-render-dev_VERSION_amd64.deb
#   scripts/package.sh all [FOLDER]         both
#   scripts/package.sh portable [FOLDER]    the tarball for older systems: glibc 2.28, libstdc++ of GCC 8
# The packages are written to FOLDER, default build/packages. DEBFULLNAME and DEBEMAIL name the maintainer of the
# Debian packages. FATHOM_BUILD names a finished build of the preset to pack instead of building one. The preset is
# `package`, and `portable` for older systems, which takes the libraries of a folder that scripts/portable_root.sh makes:
# FATHOM_PORTABLE_ROOT, default build/portable-root.
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
cd "$here"
# shellcheck source=scripts/setup.sh
source scripts/setup.sh
# shellcheck source=scripts/portable.sh
source scripts/portable.sh

kind=${1:-}
if [[ ! $kind =~ ^(tarball|deb|all|portable)$ ]] || [ $# -gt 2 ]; then
    sed -n '1d; /^# SPDX/d; /^#/!q; s/^# \{0,1\}//p' "scripts/${BASH_SOURCE[0]##*/}" >&2
    exit 2
fi
folder=${2:-build/packages}
mkdir -p "$folder"
folder=$(realpath "$folder")
version=$(sed -n 's/^project(fathom VERSION \([0-9.]*\).*/\1/p' CMakeLists.txt)
maintainer="${DEBFULLNAME:-Fathom maintainers} <${DEBEMAIL:-maintainers@users.noreply.github.com}>"
export SOURCE_DATE_EPOCH=${SOURCE_DATE_EPOCH:-$(git log -1 --format=%ct 2>/dev/null || echo 0)}

# Libraries of the system, which the tarball doesn't bring: the C and C++ runtime, X11, OpenGL and udev of the window,
# and MPI, which must be the cluster's own.
system_libraries='^(linux-vdso|ld-linux.*|lib(c|m|dl|rt|util|pthread|stdc\+\+|gcc_s|X.*|xcb.*|GL.*|bsd|md|udev|mpi.*|open-.*|hwloc|event.*))\.so'

# Copies the licenses of code that is compiled into the program and the libraries.
copy_licenses() {
    local folder=$1 package basis=$build/crates/vendor/basis-universal-sys/vendor/basis_universal
    mkdir -p "$folder"
    for package in libcli11-dev nlohmann-json3-dev libstb-dev libxxhash-dev; do
        cp "$system/usr/share/doc/$package/copyright" "$folder/$package"
    done
    # Functions that the standard library of older systems lacks are linked statically.
    if [ -n "$system" ]; then cp "$system/usr/share/doc/gcc-12-base/copyright" "$folder/libstdc++-12"; fi
    if [ -f "$basis/LICENSE" ]; then
        cp "$basis/LICENSE" "$folder/basis-universal"
        cp "$basis/zstd/LICENSE" "$folder/zstd"
    fi
}

# Copies the libraries that the tree ROOT needs into ROOT/lib, each with the licenses of its Debian package.
bundle_libraries() {
    local root=$1 name file package licenses=$1/share/doc/fathom/licenses
    copy_licenses "$licenses"
    mapfile -t own < <(find "$root/bin" "$root/lib" -type f ! -name "*.cmake")
    needed_libraries "$system" "${own[@]}" | while read -r name file; do
        if [[ $name =~ $system_libraries ]] || [[ $file = "$root"/* ]]; then continue; fi
        install -m 644 "$file" "$root/lib/$name"
        strip --strip-unneeded "$root/lib/$name"
        # shellcheck disable=SC2016  # the loader replaces $ORIGIN
        patchelf --set-rpath '$ORIGIN' "$root/lib/$name"
        # The pattern leaves out the folder, since dpkg may know it as /lib or as /usr/lib.
        package=$(dpkg-query --admindir="$system/var/lib/dpkg" --search "*/$(basename "$(realpath "$file")")" | sed -n '1s/:.*//p')
        cp "$system/usr/share/doc/$package/copyright" "$licenses/$package"
    done
}

# Adds the manual page and completions that the program prints.
add_documents() {
    local program=$1/bin/fathom share=$1/share
    mkdir -p "$share"/man/man1 "$share"/{bash-completion/completions,zsh/vendor-completions,fish/vendor_completions.d}
    "$program" man | gzip --best --no-name >"$share/man/man1/fathom.1.gz"
    "$program" completion bash >"$share/bash-completion/completions/fathom"
    "$program" completion zsh >"$share/zsh/vendor-completions/_fathom"
    "$program" completion fish >"$share/fish/vendor_completions.d/fathom.fish"
}

make_tarball() {
    local name=fathom-$version-linux-x86_64 root=$work/fathom-$version
    cmake --install "$build" --prefix "$root" --strip >/dev/null
    bundle_libraries "$root"
    add_documents "$root"
    tar --create --sort=name --owner=0 --group=0 --numeric-owner --mtime="@$SOURCE_DATE_EPOCH" --directory="$work" \
        "fathom-$version" | gzip --best --no-name >"$folder/$name.tar.gz"
    echo "$folder/$name.tar.gz"
}

# Prints the packages that the given modules or libraries of the tree need, as Debian's Depends field does.
dependencies_of() {
    local tree=$1
    shift
    (cd "$tree" && dpkg-shlibdeps -O --ignore-missing-info -l"$PWD/usr/lib/fathom-render/lib" "$@" 2> >(grep -v warning: >&2)) |
        sed -n 's/^shlibs:Depends=//p'
}

# A dependency list without the packages of another one.
without() {
    local list=$1 others=$2 item result=''
    while IFS= read -r item; do
        if ! grep -qF ", ${item%% *} " <<<", $others "; then result+=${result:+, }$item; fi
    done < <(tr ',' '\n' <<<"$list" | sed 's/^ *//')
    echo "$result"
}

# write_control TREE PACKAGE SECTION FIELDS DESCRIPTION: the control file of a package.
write_control() {
    local tree=$1 package=$2 section=$3 fields=$4 description=$5
    mkdir -p "$tree/DEBIAN"
    {
        printf 'Package: %s\nVersion: %s\nArchitecture: %s\n' "$package" "$version" "$architecture"
        printf 'Maintainer: %s\nSection: %s\nPriority: optional\nInstalled-Size: %s\n' "$maintainer" "$section" "$(du -sk --exclude=DEBIAN "$tree" | cut -f 1)"
        printf '%s\nDescription: %s\n' "$fields" "$description"
    } >"$tree/DEBIAN/control"
}

# Adds copyright and changelog, and builds the package with root as the owner of all files.
build_deb() {
    local tree=$1 package=$2 documents=$1/usr/share/doc/$2
    mkdir -p "$documents"
    {
        printf 'Format: https://www.debian.org/doc/packaging-manuals/copyright-format/1.0/\nUpstream-Name: fathom\n\n'
        printf 'Files: *\nCopyright: 2026 the authors of Fathom\nLicense: Apache-2.0\n'
        printf ' On Debian systems, the full text of the Apache License 2.0 is in\n /usr/share/common-licenses/Apache-2.0.\n'
    } >"$documents/copyright"
    gzip --best --no-name <CHANGELOG.md >"$documents/NEWS.gz"
    {
        printf '%s (%s) unstable; urgency=medium\n\n  * This version; NEWS.gz lists the changes.\n\n' fathom-render "$version"
        printf ' -- %s  %s\n' "$maintainer" "$(LC_ALL=C date --utc --rfc-email --date="@$SOURCE_DATE_EPOCH")"
    } | gzip --best --no-name >"$documents/changelog.gz"
    (cd "$tree" && find usr -type f -print0 | sort -z | xargs -0 md5sum) >"$tree/DEBIAN/md5sums"
    find "$tree" -exec touch --no-dereference --date="@$SOURCE_DATE_EPOCH" {} +
    fakeroot dpkg-deb --build -Zxz "$tree" "$folder/${package}_${version}_$architecture.deb" >/dev/null
    echo "$folder/${package}_${version}_$architecture.deb"
}

# Everything is in /usr/lib/fathom-render but what other programs look for: a link to the program, manual page,
# completions and desktop files.
make_debs() {
    local tree=$work/render dev=$work/dev private=usr/lib/fathom-render architecture depends window
    architecture=$(dpkg --print-architecture)
    mkdir -p "$tree/usr/bin" "$tree/usr/share" "$dev/$private/lib" "$dev/usr/lib/cmake/fathom"
    cmake --install "$build" --prefix "$tree/$private" --strip >/dev/null
    add_documents "$tree/$private"
    mv "$tree/$private/share"/{man,bash-completion,zsh,fish,applications,thumbnailers,mime} "$tree/usr/share"
    mkdir -p "$tree/usr/share/doc/fathom-render"
    mv "$tree/$private/share/doc/fathom"/scene* "$tree/usr/share/doc/fathom-render"
    rm -r "$tree/$private/share"
    copy_licenses "$tree/usr/share/doc/fathom-render/licenses"
    ln -s ../lib/fathom-render/bin/fathom "$tree/usr/bin/fathom"

    mv "$tree/$private/include" "$dev/$private"
    mv "$tree/$private/lib"/{cmake,libfathom.so} "$dev/$private/lib"
    cp "$dev/$private/lib/cmake/fathom/fathom-config-version.cmake" "$dev/usr/lib/cmake/fathom"
    # shellcheck disable=SC2016  # for CMake
    echo 'include("${CMAKE_CURRENT_LIST_DIR}/../../fathom-render/lib/cmake/fathom/fathom-config.cmake")' \
        >"$dev/usr/lib/cmake/fathom/fathom-config.cmake"

    # dpkg-shlibdeps expects these in the folder of a source package.
    mkdir "$tree/debian" "$tree/DEBIAN" && touch "$tree/debian/control"
    depends=$(dependencies_of "$tree" "$private"/bin/fathom "$private"/lib/libfathom.so.0 \
        "$private"/lib/fathom/libfathom_kernel-{base,avx2,avx512}.so)
    window=$(dependencies_of "$tree" "$private"/lib/libfathom_{view,assimp}.so)
    rm -r "$tree/debian"
    write_control "$tree" fathom-render graphics \
        "$(printf 'Depends: %s\nRecommends: %s\nSuggests: libavif15 | libavif16, libopenmpi3 | libopenmpi3t64' \
            "$depends" "$(without "$window" "$depends")")" \
        "path tracer that renders 3D models to physically correct images
 Fathom renders glTF, OBJ, PLY, STL, pbrt and Mitsuba files on the CPU, without
 a display or a GPU. The same command gives the same bits on every machine.
 .
 The recommended packages are for the window (fathom view) and for the formats
 that Assimp reads."
    build_deb "$tree" fathom-render
    write_control "$dev" fathom-render-dev libdevel "Depends: fathom-render (= $version)" \
        "headers and CMake package of the path tracer Fathom
 Programs render scenes by find_package(fathom) and fathom::fathom."
    build_deb "$dev" fathom-render-dev
}

# use_build PRESET SYSTEM: builds the preset, for the system in a folder; the empty word is this machine's.
use_build() {
    build=${FATHOM_BUILD:-build/$1} system=$2
    if [ -z "${FATHOM_BUILD:-}" ]; then build_preset "$1"; fi
}

install_missing "${packages_to_build[@]}" "${packages_to_package[@]}"
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
if [ "$kind" = portable ]; then
    make_portable_root
    use_build portable "$FATHOM_PORTABLE_ROOT"
    make_tarball
    exit
fi
use_build package ''
if [ "$kind" != deb ]; then make_tarball; fi
if [ "$kind" != tarball ]; then make_debs; fi
