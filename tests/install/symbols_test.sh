#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# symbols_test.sh NM LIBFATHOM KERNEL...: checks that the libraries export only the intended symbols. Otherwise the loader could
# bind a program to a template compiled for an instruction set that the machine lacks.
set -euo pipefail
nm=$1 library=$2
shift 2
failed=0

exported() { "$nm" --dynamic --defined-only --demangle --format=posix "$1" | sed 's/ [A-Za-z] [0-9a-f]*\( [0-9a-f]*\)\{0,1\}$//'; }

# complain WHAT SYMBOLS: fails if there are any symbols.
complain() {
    if [ -n "$2" ]; then
        printf '%s\n%s\n' "$1" "$2"
        failed=1
    fi
}

complain "$library exports what is not of namespace fathom:" \
    "$(exported "$library" | grep -v -E '^((typeinfo|typeinfo name|vtable) for )?fathom::' || true)"
for kernel in "$@"; do
    [ "$(exported "$kernel")" = fathom_kernel ] || complain "$kernel must export its table of functions only:" "$(exported "$kernel")"
done
exit "$failed"
