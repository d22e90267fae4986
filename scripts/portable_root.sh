#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Makes the folder with headers and libraries for packages that run on older systems (cmake/portable.cmake): Debian 11,
# with libraries of Debian 12, which are compiled there. Programs that are linked there need glibc 2.28 and the libstdc++ of
# GCC 8, or later.
#   scripts/portable_root.sh ROOT
# Needs root, debootstrap and a source of Debian packages (the first one of this machine's apt).
set -euo pipefail
if [ $# -ne 1 ]; then
    sed -n '1d; /^# SPDX/d; /^#/!q; s/^# \{0,1\}//p' "$0" >&2
    exit 2
fi
cd "$(dirname "${BASH_SOURCE[0]}")/.."
# shellcheck source=scripts/setup.sh
source scripts/setup.sh
install_missing debootstrap
root=$1
jobs=${FATHOM_JOBS:-$(build_jobs)}
# shellcheck disable=SC2016  # $(REPO_URI) is for apt-get
mirror=$(apt-get indextargets --format '$(REPO_URI)' 'Created-By: Packages' | grep -E '/debian/?$' | head -n 1)
mirror=${mirror%/}

# inside COMMAND...: runs a command in the root.
inside() {
    chroot "$root" /usr/bin/env -i PATH=/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin HOME=/root LC_ALL=C \
        DEBIAN_FRONTEND=noninteractive "$@"
}

# debootstrap deletes what is in proc, or makes a link to this machine's, so it runs before.
mount_proc() {
    if [ -L "$root/proc" ]; then rm "$root/proc"; fi
    mkdir -p "$root/proc"
    mountpoint -q "$root/proc" || mount -t proc proc "$root/proc"
    trap 'umount "$root/proc"' EXIT
}

make_system() {
    if [ ! -x "$root/usr/bin/apt-get" ]; then
        debootstrap --variant=minbase bullseye "$root" "$mirror" >/dev/null || fail "debootstrap failed (see $root/debootstrap/debootstrap.log)"
    fi
    mount_proc
    cp /etc/resolv.conf "$root/etc/resolv.conf"
    # Only single packages and sources are fetched from Debian 12.
    printf 'deb %s bullseye main\ndeb %s-security bullseye-security main\ndeb %s bookworm main\ndeb-src %s bookworm main\n' \
        "$mirror" "$mirror" "$mirror" "$mirror" >"$root/etc/apt/sources.list"
    printf 'Package: *\nPin: release n=bookworm\nPin-Priority: 1\n' >"$root/etc/apt/preferences.d/bookworm"
    inside apt-get -q update
    inside apt-get -q install --yes --no-install-recommends clang-19 ninja-build ccache pkg-config python3-venv python3-pip \
        patchelf dpkg-dev fakeroot git ca-certificates xz-utils libjpeg-dev zlib1g-dev \
        libutfcpp-dev libminizip-dev libsfml-dev libopenmpi-dev
    # The root trusts the certificates that this machine trusts.
    cp --dereference /etc/ssl/certs/ca-certificates.crt "$root/etc/ssl/certs"
    inside python3 -m venv /opt/cmake
    inside /opt/cmake/bin/pip install --quiet --disable-pip-version-check --cert /etc/ssl/certs/ca-certificates.crt 'cmake<4'
    inside ln -sf /opt/cmake/bin/cmake /usr/local/bin/cmake
}

# Headers of Debian 12, and the standard library of GCC 12. Programs are linked with stubs of the system's libraries, which
# lack what came after glibc 2.28 and GCC 8. What the stub of libstdc++.so.6 lacks is linked statically.
add_headers() {
    # shellcheck disable=SC2016  # for the shell in the root
    inside bash -euc 'folder=$(mktemp -d); cd "$folder"
        apt-get -q download gcc-12-base/bookworm libstdc++-12-dev/bookworm libgcc-12-dev/bookworm libavif-dev/bookworm libcli11-dev/bookworm \
            nlohmann-json3-dev/bookworm libstb-dev/bookworm libxxhash-dev/bookworm
        for package in ./*.deb; do dpkg-deb -x "$package" /; done
        rm -r "$folder"
        cd /usr/lib/gcc/x86_64-linux-gnu/12
        mkdir -p stubs
        rm -f libstdc++.so libgcc_s.so.1
        ln -s ../../../../../lib/x86_64-linux-gnu/libgcc_s.so.1 libgcc_s.so.1
        # libstdc++.a of Debian 12 reads this variable of glibc 2.32; 0 means that there may be several threads.
        echo "__attribute__((visibility(\"hidden\"))) char __libc_single_threaded = 0;" |
            clang-19 -x c -O2 -fPIC -c - -o single_threaded.o
        ar rcs libsingle_threaded.a single_threaded.o
        echo "INPUT ( $PWD/stubs/libstdc++.so.6 libstdc++.a libsingle_threaded.a )" >libstdc++.so
        echo "INPUT ( $PWD/stubs/libm.so.6 )" >/usr/lib/x86_64-linux-gnu/libm.so
        # This function came with glibc 2.30.
        sed -i "/_GLIBCXX_USE_PTHREAD_COND_CLOCKWAIT/d" /usr/include/x86_64-linux-gnu/c++/12/bits/c++config.h'
    local libraries=$root/usr/lib/x86_64-linux-gnu stubs=$root/usr/lib/gcc/x86_64-linux-gnu/12/stubs
    scripts/link_stub.py clang-19 "$libraries/libstdc++.so.6" "$stubs/libstdc++.so.6" GLIBCXX=3.4.25 CXXABI=1.3.11
    scripts/link_stub.py clang-19 "$libraries/libm.so.6" "$stubs/libm.so.6" GLIBC=2.28
}

# Makes absolute links to libraries relative: a linker outside of the root doesn't follow them.
make_links_relative() {
    # shellcheck disable=SC2016  # for the shell in the root
    inside bash -euc 'find /usr/lib /usr/lib64 -name "*.so*" -lname "/*" | while read -r link; do
        ln --symbolic --force --relative "$(readlink --canonicalize "$link")" "$link"
    done'
}

# add_library PACKAGE SOURCE OPTION...: compiles a library from its source package, and installs it as a package, so that
# its license is found.
add_library() {
    local package=$1 source=$2
    shift 2
    inside dpkg-query --show "$package" >/dev/null 2>&1 && return
    # shellcheck disable=SC2016  # for the shell in the root
    inside bash -euc 'package=$1 source=$2 jobs=$3; shift 3
        # An interrupted run leaves this folder, and the next one goes on there.
        folder=/var/tmp/fathom/$package
        mkdir -p "$folder"; cd "$folder"
        apt-get -q source "$source/bookworm"
        cd "$source"-*/
        CC=clang-19 CXX=clang++-19 cmake -S . -B build -G Ninja -DCMAKE_BUILD_TYPE=Release -DCMAKE_INSTALL_PREFIX=/usr \
            -DCMAKE_INSTALL_LIBDIR=lib/x86_64-linux-gnu -DBUILD_SHARED_LIBS=ON -DBUILD_TESTING=OFF -Wno-dev "$@"
        cmake --build build --parallel "$jobs"
        rm -rf "$folder/tree"
        DESTDIR=$folder/tree cmake --install build
        # Some packages name libraries by absolute paths, which a build outside of the root would look for on its machine.
        find "$folder/tree" -iname "*targets*.cmake" -exec sed -i "s|\([\";:]\)/usr/lib/|\1\${CMAKE_SYSROOT}/usr/lib/|g" {} +
        mkdir -p "$folder/tree/DEBIAN" "$folder/tree/usr/share/doc/$package"
        cp debian/copyright "$folder/tree/usr/share/doc/$package"
        printf "Package: %s\nVersion: %s\nArchitecture: amd64\nMaintainer: none\nDescription: %s, compiled for older systems\n" \
            "$package" "$(dpkg-parsechangelog -S Version)" "$source" >"$folder/tree/DEBIAN/control"
        dpkg-deb --build "$folder/tree" "$folder/$package.deb"
        dpkg --install --force-overwrite "$folder/$package.deb"
        rm -r "$folder"' bash "$package" "$source" "$jobs" "$@"
}

make_system
add_headers
add_library fathom-tbb onetbb -DTBB_TEST=OFF -DTBB_STRICT=OFF -DTBBMALLOC_BUILD=OFF
add_library fathom-png libpng1.6 -DPNG_TESTS=OFF
add_library fathom-webp libwebp -DWEBP_BUILD_{ANIM_UTILS,CWEBP,DWEBP,GIF2WEBP,IMG2WEBP,VWEBP,WEBPINFO,WEBPMUX,EXTRAS}=OFF
add_library fathom-imath imath
add_library fathom-openexr openexr -DOPENEXR_BUILD_TOOLS=OFF -DOPENEXR_INSTALL_EXAMPLES=OFF -DOPENEXR_INSTALL_TOOLS=OFF
add_library fathom-fmt fmtlib -DFMT_TEST=OFF -DFMT_DOC=OFF
add_library fathom-pugixml pugixml
add_library fathom-meshoptimizer meshoptimizer -DMESHOPT_BUILD_SHARED_LIBS=ON -DMESHOPT_SOVERSION=2d
add_library fathom-draco draco
add_library fathom-assimp assimp -DCMAKE_BUILD_TYPE=MinSizeRel -DASSIMP_BUILD_ASSIMP_TOOLS=OFF -DASSIMP_BUILD_TESTS=OFF -DASSIMP_NO_EXPORT=ON -DASSIMP_WARNINGS_AS_ERRORS=OFF -DASSIMP_BUILD_DRACO=OFF -DASSIMP_BUILD_ZLIB=OFF
make_links_relative
inside touch /opt/complete
echo "$root"
