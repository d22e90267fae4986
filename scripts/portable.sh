#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Builds for older systems: package.sh sources it after setup.sh.

# Makes the folder FATHOM_PORTABLE_ROOT (default build/portable-root) with the libraries of an older system, once.
make_portable_root() {
    export FATHOM_PORTABLE_ROOT=${FATHOM_PORTABLE_ROOT:-$PWD/build/portable-root}
    if [ -e "$FATHOM_PORTABLE_ROOT/opt/complete" ]; then return; fi
    say "making $FATHOM_PORTABLE_ROOT, which takes some minutes"
    mkdir -p "$FATHOM_PORTABLE_ROOT"
    as_root scripts/portable_root.sh "$FATHOM_PORTABLE_ROOT" >&2
}

# needed_libraries SYSTEM FILE...: prints names and files of the libraries that the files need, directly or indirectly,
# with those of the system in the folder SYSTEM (the empty word: this machine's).
needed_libraries() {
    local system=$1 file loader
    shift
    loader=$(echo "$system"/lib/x86_64-linux-gnu/ld-2.*.so)
    for file in "$@"; do
        if [ -n "$system" ]; then
            "$loader" --library-path "$system/usr/lib/x86_64-linux-gnu" --list "$file"
        else
            ldd "$file"
        fi
    done | sed -n 's/^[[:space:]]*\([^ /]*\) => \(\/[^ ]*\) .*/\1 \2/p' | sort -u
}
