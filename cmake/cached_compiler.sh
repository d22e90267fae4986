#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# cached_compiler.sh COMPILER ARGUMENT...: compiles with ccache, run in the build folder. Results are found again in
# other clones of the same files.
root=$(cd "$(dirname "$0")/.." && pwd)

# prints the arguments' value of -o.
output() {
    while [ $# -gt 1 ] && [ "$1" != -o ]; do shift; done
    echo "$2"
}

case " $* " in
    *" -emit-pch "*)
        # A precompiled header contains absolute paths, so it is neither cached nor hashed. ccache reads the checksum of
        # the headers that it was made of instead.
        "$@" || exit
        header=$(output "$@")
        sed -e 's/^[^:]*: *//' -e 's/\\$//' "$header.d" | xargs cat | sha256sum >"$header.sum"
        exit
        ;;
esac
# ccache makes paths relative, but not those that follow -Xclang.
for argument; do
    shift
    set -- "$@" "${argument#"$PWD"/}"
done
export CCACHE_BASEDIR="$root" CCACHE_PCH_EXTSUM=true CCACHE_SLOPPINESS=pch_defines,time_macros
exec ccache "$@"
