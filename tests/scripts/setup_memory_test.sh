#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Tests the free memory that scripts/setup.sh detects in fake root folders, with the cases of
# tests/base/machine_test.cpp.  setup_memory_test.sh ROOT_OF_THE_PROJECT
set -euo pipefail
# shellcheck source=scripts/setup.sh
source "$1/scripts/setup.sh"
root=$(mktemp -d)
trap 'rm -r "$root"' EXIT
failures=0

# put FILE TEXT: writes a file below the fake root.
put() {
    mkdir -p "$(dirname "$root/$1")"
    printf '%b' "$2" >"$root/$1"
}
# expect BYTES CASE: checks the result and clears the fake root.
expect() {
    local found
    found=$(free_memory "$root")
    if [ "$found" != "$1" ]; then
        echo "$2: expected $1, found $found"
        failures=$((failures + 1))
    fi
    rm -r "${root:?}"/*
    put proc/meminfo 'MemTotal:       16000000 kB\nMemAvailable:    8000000 kB\n'
}

put proc/meminfo 'MemAvailable:    8000000 kB\n'
expect 8192000000 "without groups"

put proc/self/cgroup '0::/user.slice/job\n'
put sys/fs/cgroup/user.slice/job/memory.max '3000000000\n'
put sys/fs/cgroup/user.slice/job/memory.current '2500000000\n'
expect 500000000 "the process's own group"

put proc/self/cgroup '0::/user.slice/job\n'
put sys/fs/cgroup/user.slice/job/memory.max '3000000000\n'
put sys/fs/cgroup/user.slice/job/memory.current '2500000000\n'
put sys/fs/cgroup/user.slice/job/memory.stat 'anon 1000\ninactive_file 1500000000\nactive_file 7\n'
expect 2000000000 "a cache that gives way"

put proc/self/cgroup '0::/user.slice/job/step\n'
put sys/fs/cgroup/user.slice/job/step/memory.max 'max\n'
put sys/fs/cgroup/user.slice/memory.max '1000000000\n'
put sys/fs/cgroup/user.slice/memory.current '0\n'
expect 1000000000 "a group above has less"

put proc/self/cgroup '0::/docker/abc\n'
put sys/fs/cgroup/memory.max '1000000000\n'
put sys/fs/cgroup/memory.current '0\n'
expect 1000000000 "a container that sees its group as the root"

put proc/self/cgroup '5:cpu,cpuacct:/x\n4:memory:/jobs/a\n0::/z\n'
mkdir -p "$root/sys/fs/cgroup/unified"
put sys/fs/cgroup/memory/jobs/a/memory.limit_in_bytes '9223372036854771712\n'
put sys/fs/cgroup/memory/jobs/a/memory.usage_in_bytes '1000\n'
put sys/fs/cgroup/memory/jobs/memory.limit_in_bytes '2000000000\n'
put sys/fs/cgroup/memory/jobs/memory.usage_in_bytes '1500000000\n'
expect 500000000 "version 1"

exit $((failures > 0))
