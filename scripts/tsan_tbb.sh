#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Builds oneTBB with the thread sanitizer into build/tsan-tbb, where the preset tsan looks first, from the source of the
# installed package. With the uninstrumented package the sanitizer can't see synchronization between tasks: it would
# report every task, and suppressing that would hide all races.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
here=$PWD prefix=$PWD/build/tsan-tbb work=$PWD/build/tsan-tbb/work
[ -f "$prefix/lib/cmake/TBB/TBBConfig.cmake" ] && exit
mkdir -p "$work/lists/partial" "$work/sources.d"

# A copy of the machine's package sources, with source packages enabled.
: >"$work/sources.list"
for list in /etc/apt/sources.list /etc/apt/sources.list.d/*; do
    case $list in
        *.list) [ ! -f "$list" ] || sed -n 's/^deb /deb-src /p' "$list" >>"$work/sources.list" ;;
        *.sources) sed 's/^Types:.*/Types: deb-src/' "$list" >"$work/sources.d/${list##*/}" ;;
    esac
done
apt() {
    apt-get -q -o Dir::Etc::sourcelist="$work/sources.list" -o Dir::Etc::sourceparts="$work/sources.d" \
        -o Dir::State::lists="$work/lists" -o APT::Sandbox::User= "$@"
}
cd "$work"
apt update >&2 || true  # an entry without source packages is harmless
read -r name version < <(dpkg-query --show --showformat '${source:Package} ${source:Version}\n' libtbb-dev)
apt source --download-only "$name=$version" >&2
dpkg-source --extract "${name}_${version#*:}.dsc" source >&2

cmake -G Ninja -S source -B build -DCMAKE_BUILD_TYPE=RelWithDebInfo -DCMAKE_CXX_COMPILER="${CXX:-clang++-19}" \
    -DCMAKE_CXX_FLAGS="-fsanitize=thread -g1" -DTBB_TEST=OFF -DTBB_STRICT=OFF -DTBBMALLOC_BUILD=OFF \
    -DCMAKE_INSTALL_LIBDIR=lib -DCMAKE_INSTALL_PREFIX="$prefix" >&2
cmake --build build --parallel "${FATHOM_JOBS:-$(nproc)}" >&2
cmake --install build >&2
cd "$here"
rm -r "$work"
