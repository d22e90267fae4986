#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Executes the steps of a Containerfile in a folder, for machines without a container engine, and runs its entry point.
#   scripts/containerfile.sh FILE CONTEXT ROOT [ARGUMENT]...
# CONTEXT is the folder with the files that COPY names. ROOT has the system that FROM names. Without an ARGUMENT, those of
# CMD are taken. Knows the instructions FROM, COPY, RUN, USER, WORKDIR, ENTRYPOINT and CMD; others are errors. Needs root.
set -euo pipefail
if [ $# -lt 3 ]; then
    sed -n '1d; /^# SPDX/d; /^#/!q; s/^# \{0,1\}//p' "$0" >&2
    exit 2
fi
file=$1 context=$2 root=$3
shift 3
user=0:0 folder=/ entry=() defaults=()

# inside COMMAND...: runs a command in the root as the user and in the folder that the file has named so far.
inside() {
    # shellcheck disable=SC2016  # for the shell in the root
    chroot --userspec="$user" "$root" /usr/bin/env -i PATH=/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin \
        /bin/sh -c 'cd "$1" && shift && exec "$@"' sh "$folder" "$@"
}

# Prints the words of a JSON list, one a line.
words_of() { python3 -c 'import json, sys; print(*json.loads(sys.argv[1]), sep="\n")' "$1"; }

while read -r instruction rest; do
    case $instruction in
        FROM) echo "FROM $rest: $root" >&2 ;;
        COPY)
            read -ra names <<<"$rest"
            # The names are patterns of files.
            # shellcheck disable=SC2068
            (cd "$context" && cp -- ${names[@]:0:${#names[@]}-1} "$root${names[-1]}")
            ;;
        RUN) inside /bin/sh -c "$rest" </dev/null ;;
        USER) user=$rest ;;
        WORKDIR)
            mkdir -p "$root$rest"
            folder=$rest
            ;;
        ENTRYPOINT) mapfile -t entry < <(words_of "$rest") ;;
        CMD) mapfile -t defaults < <(words_of "$rest") ;;
        *)
            echo "containerfile.sh: $file: unknown instruction $instruction" >&2
            exit 1
            ;;
    esac
# Comments are left out, and lines that end with a backslash are joined with the next.
done < <(sed '/^#/d; /^$/d' "$file" | sed -e ':a' -e '/\\$/{N; s/\\\n//; ba' -e '}')
[ $# -gt 0 ] || set -- "${defaults[@]}"
inside "${entry[@]}" "$@"
