#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Makes the root folder of a container image: an installed build, its shared libraries, a shell for recipes that need
# one, and an unprivileged user. The libraries and the shell are copied from this machine.
#   farm/container/root.sh BUILD_FOLDER ROOT
set -euo pipefail
if [ $# -ne 2 ]; then
    sed -n '1d; /^# SPDX/d; /^#/!q; s/^# \{0,1\}//p' "$0" >&2
    exit 2
fi
build=$1 root=$2
[ ! -e "$root" ] || { echo "root.sh: $root is there already" >&2; exit 1; }
mkdir -p "$root"/{dev,etc,proc,sys,tmp,work,usr/local}
chmod 1777 "$root/tmp" "$root/work"
cmake --install "$build" --prefix "$root/usr/local" --strip >/dev/null
# The modules for the window, Assimp and MPI and the development files are removed.
rm -rf "$root"/usr/local/lib/libfathom_{view,assimp,mpi}.so "$root"/usr/local/lib/*/libfathom_{view,assimp,mpi}.so
rm -rf "$root/usr/local/include" "$root"/usr/local/lib/*/cmake "$root"/usr/local/lib/cmake

# Prints the shared libraries that the given programs and modules need, directly or indirectly, and the dynamic loader.
# AVIF's library is opened only when it is needed, so no ELF header lists it.
libraries_of() {
    { ldd "$@" 2>/dev/null || true; } | sed -n 's/.*=> \(\/[^ ]*\) .*/\1/p; s/^[[:space:]]*\(\/[^ ]*\) (.*/\1/p'
}
mapfile -t own < <(find "$root/usr/local" -type f \( -name 'fathom' -o -name '*.so*' \))
mapfile -t opened < <(ldconfig -p | sed -n 's/.*libavif\.so\.[0-9]* .*=> //p' | head -n 1)
libraries_of "${own[@]}" "${opened[@]}" | cat - <(printf '%s\n' "${opened[@]}") | sort -u | while read -r library; do
    case $library in "$root"/* | "" | "$(realpath "$build")"/*) continue ;; esac
    mkdir -p "$root$(dirname "$library")"
    cp --dereference "$library" "$root$library"
done

if command -v busybox >/dev/null; then
    mkdir -p "$root/bin"
    cp --dereference "$(command -v busybox)" "$root/bin/busybox"
    ln -s busybox "$root/bin/sh"
fi
echo 'fathom:x:10001:10001::/work:/bin/sh' >"$root/etc/passwd"
echo 'fathom:x:10001:' >"$root/etc/group"
