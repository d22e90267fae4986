#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Runs the two commands of the README on a minimal system: a fresh installation in a folder (debootstrap, chroot).
#   scripts/bare_machine_test.sh [--no-tests | --only-tests] [SUITE] [MIRROR]
# SUITE is bookworm (Debian 12, the default) or noble (Ubuntu 24.04); MIRROR is the source of its packages (default: the
# first one in this machine's apt configuration). The last commit is tested. Needs root, debootstrap, 8 GB of disk and
# about half an hour; not part of CI. DEBOOTSTRAP_OPTIONS may add options, such as --keyring=FILE if this machine lacks
# the suite's keys.
set -euo pipefail
commands="render tests"
case "${1:-}" in
    --no-tests) commands=render && shift ;;
    --only-tests) commands=tests && shift ;;
esac
suite=${1:-bookworm}
# shellcheck disable=SC2016  # $(REPO_URI) is for apt-get
mirror=${2:-$(apt-get indextargets --format '$(REPO_URI)' | head -n 1)}
source=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
bare=$(mktemp -d)
chmod 755 "$bare"  # other users need access too

cleanup() {
    umount "$bare/dev/shm" "$bare/proc" 2>/dev/null || true
    # Never deletes through a mount that still exists.
    if ! grep -q " $bare/" /proc/mounts; then rm -rf --one-file-system "$bare"; fi
}
trap cleanup EXIT

fail() {
    echo "bare machine: FAILED: $*"
    exit 1
}
# inside USER COMMAND...: runs a command in the bare system, in Fathom's folder, with a clean environment.
inside() {
    local user=$1 home=/root
    shift
    if [ "$user" != root ]; then home=/home/$user; fi
    chroot --userspec="$user" "$bare" /usr/bin/env -i PATH=/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin \
        HOME="$home" LC_ALL=C bash -c 'cd /fathom && "$@"' bash "$@" </dev/null
}
# timed NAME COMMAND...: runs a command and reports its time.
timed() {
    local name=$1
    local TIMEFORMAT="bare machine: $name: %0R s, with %0U + %0S s of CPU"
    shift
    time "$@" || fail "$name"
}

make_system() {
    local components=main script=()
    if [ "$suite" = noble ]; then
        components=main,universe
        # Older debootstraps don't know this release; all Ubuntu releases use one script.
        [ -e "/usr/share/debootstrap/scripts/$suite" ] || script=(/usr/share/debootstrap/scripts/gutsy)
    fi
    # shellcheck disable=SC2086  # several options
    debootstrap ${DEBOOTSTRAP_OPTIONS:-} --variant=minbase --components="$components" "$suite" "$bare" "$mirror" \
        "${script[@]}" >"$bare.log" ||
        fail "debootstrap (see $bare.log)"
    rm -f "$bare.log"
    cp /etc/resolv.conf "$bare/etc/resolv.conf"
    mount -t proc proc "$bare/proc"
    mkdir -p "$bare/dev/shm"
    mount -t tmpfs tmpfs "$bare/dev/shm"
    mkdir "$bare/fathom"
    git -C "$source" archive HEAD | tar -x -C "$bare/fathom"
}

make_user() {
    inside root useradd --create-home user
    inside root chown -R user /fathom
}
let_user_install() {
    inside root apt-get -qq update
    inside root apt-get -qq install --yes --no-install-recommends sudo >/dev/null 2>&1
    echo 'user ALL=(ALL) NOPASSWD: ALL' >"$bare/etc/sudoers.d/user"
}

test_render() {
    timed "render.sh, the first time, as root" inside root ./render.sh
    [ "$(head -c 4 "$bare/fathom/cornell-box.png" | tail -c 3)" = PNG ] || fail "no picture"
    echo "bare machine: $(du -shx "$bare" | cut -f 1) in all"
    timed "render.sh, the second time" inside root ./render.sh

    # With one package removed, a user who may not install it runs render.sh, then one who may.
    inside root apt-get -qq --yes remove libstb-dev >/dev/null
    make_user
    if inside user ./render.sh >"$bare/tmp/no-sudo.log" 2>&1; then fail "a user without sudo should get an error"; fi
    grep "no sudo here" "$bare/tmp/no-sudo.log" || fail "a user without sudo should be told so"
    let_user_install
    timed "render.sh as a user with sudo, one package missing" inside user ./render.sh
}

make_system
if [[ $commands == *render* ]]; then
    test_render
else
    make_user
    let_user_install
fi
if [[ $commands == *tests* ]]; then
    timed "test.sh as a user with sudo" inside user ./test.sh
    inside user tail -n 5 build/release/ctest.log
fi
echo "bare machine: passed"
