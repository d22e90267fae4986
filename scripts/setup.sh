#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Shared by render.sh and test.sh: installs missing packages and builds a preset. They `source` it; run directly,
# `scripts/setup.sh [tests]` only installs packages.

# The list of packages; names are equal in Debian 12 and Ubuntu 24.04. clang-19 includes the standard library; g++
# replaces it if apt has no clang-19.
packages_to_build=(
    clang-19 cmake ninja-build pkg-config ccache
    libtbb-dev libfmt-dev libcli11-dev nlohmann-json3-dev
    libopenexr-dev libpng-dev libjpeg-dev libwebp-dev libavif-dev libstb-dev libxxhash-dev
    libpugixml-dev zlib1g-dev libassimp-dev libsfml-dev libdraco-dev libmeshoptimizer-dev
)
# OpenColorIO is optional: a program linked with it starts about 2 ms later.
packages_to_test=(
    clang-format-19 libgtest-dev libbenchmark-dev libembree-dev libopencolorio-dev
    git zsh fish groff python3 python3-dev python3-venv python3-jsonschema python3-yaml xvfb xdotool imagemagick slurm-wlm munge openmpi-bin libopenmpi-dev
)

# Tools of scripts/package.sh.
packages_to_package=(git patchelf dpkg-dev fakeroot)

say() { printf 'fathom: %s\n' "$*" >&2; }
fail() {
    say "$@"
    exit 1
}

is_installed() {
    [ "$(dpkg-query --show --showformat '${db:Status-Status}' "$1" 2>/dev/null)" = installed ]
}

# Runs a command as root, with sudo if needed.
as_root() {
    if [ "$(id -u)" -eq 0 ]; then
        "$@"
    else
        sudo "$@"
    fi
}

apt_get() {
    as_root env DEBIAN_FRONTEND=noninteractive apt-get -q -o DPkg::Lock::Timeout=300 -o Dpkg::Use-Pty=0 "$@" </dev/null
}

# Fails with advice if packages can't be installed.
check_that_packages_can_be_installed() {
    local missing=("$@")
    command -v apt-get >/dev/null ||
        fail "these packages are missing, and there is no apt-get here to install them: ${missing[*]}"
    [ "$(id -u)" -eq 0 ] && return
    local advice="as root, run:  apt-get update && apt-get install --no-install-recommends ${missing[*]}"
    command -v sudo >/dev/null || fail "packages are missing, and there is no sudo here to install them; $advice"
    # Without a terminal, sudo can't ask for a password.
    if [ ! -t 0 ] && ! sudo -n true 2>/dev/null; then
        fail "packages are missing, and sudo would ask for a password but has no terminal; $advice"
    fi
    sudo true || fail "sudo did not let this user install packages; $advice"
}

apt_has() {
    apt-cache show "$1" >/dev/null 2>&1
}

# missing_of PACKAGE...: prints the packages that are not installed, one per line. If apt has no clang-19, GCC replaces
# it and the formatting check is skipped.
missing_of() {
    local package
    for package in "$@"; do
        # Neither package is in apt's lists, so the lists have not been fetched yet.
        if [[ $package = clang-*19 ]] && ! is_installed "$package" && ! apt_has "$package" && apt_has g++; then
            if [ "$package" = clang-19 ]; then package=g++; else continue; fi
        fi
        is_installed "$package" || echo "$package"
    done
}

# install_missing PACKAGE...: prints the missing packages, then installs them. Does not call apt if none is missing.
install_missing() {
    if [ -n "${FATHOM_NO_INSTALL:-}" ]; then
        return
    fi
    if ! command -v dpkg-query >/dev/null; then
        fail "this machine has no Debian packages. Install what these packages have in your system's way, then" \
            "run this command again with FATHOM_NO_INSTALL=1: $*"
    fi
    local missing=()
    mapfile -t missing < <(missing_of "$@")
    if [ ${#missing[@]} -eq 0 ]; then
        return
    fi
    check_that_packages_can_be_installed "${missing[@]}"
    say "updating apt's lists of packages"
    apt_get update || say "apt-get update failed; trying with the package lists that are there"
    mapfile -t missing < <(missing_of "$@")  # apt may know clang-19 after its update
    say "installing with apt-get, and what they need: ${missing[*]}"
    apt_get install --yes --no-install-recommends "${missing[@]}" ||
        fail "apt-get could not install the packages above. Is the machine online?" \
            "On Ubuntu, the component 'universe' must be enabled (add-apt-repository universe)"
}

# group_folders ROOT: prints `limit-file folder` for each memory control group of this process and for all parent
# groups, since each of their limits applies. src/base/machine.cpp uses the algorithm too.
group_folders() {
    local mounts=$1/sys/fs/cgroup line controllers group base file
    {
        cat "$1/proc/self/cgroup" 2>/dev/null || true
        # A container may have a memory group that /proc/self/cgroup does not list.
        printf '0::/\n0:memory:/\n'
    } | while IFS= read -r line; do
        line=${line#*:}
        controllers=${line%%:*} group=${line#*:}
        if [ -z "$controllers" ]; then
            base=$mounts file=memory.max
            # On systems with hierarchies of both versions, version 2 has a folder of its own.
            if [ -d "$mounts/unified" ]; then base=$mounts/unified; fi
        elif [[ ,$controllers, = *,memory,* ]]; then
            base=$mounts/memory file=memory.limit_in_bytes
            if [ -d "$mounts/$controllers" ]; then base=$mounts/$controllers; fi
        else
            continue
        fi
        while [[ $group = /?* ]]; do
            echo "$file $base$group"
            group=${group%/*}
        done
        echo "$file $base"
    done
}

# free_memory [ROOT]: prints the available bytes, limited by this process's control groups. (%.0f because mawk truncates
# %d at 2^31.)
free_memory() {
    local root=${1:-} free limit used cache file folder
    free=$(awk '/^MemAvailable:/ { printf "%.0f", $2 * 1024 }' "$root/proc/meminfo" 2>/dev/null || true)
    free=${free:-4000000000}
    while read -r file folder; do
        limit=$(cat "$folder/$file" 2>/dev/null || echo max)
        # Each group has one of the two files.
        used=$(cat "$folder/memory.current" "$folder/memory.usage_in_bytes" 2>/dev/null || true)
        # Inactive file cache can be reclaimed.
        cache=$(awk -v key="$([ "$file" = memory.max ] || echo total_)inactive_file" '$1 == key { print $2 }' \
            "$folder/memory.stat" 2>/dev/null || true)
        # Without a limit, version 1 reports a number near 2^63.
        if [[ $limit =~ ^[0-9]{1,18}$ && $used =~ ^[0-9]{1,18}$ ]]; then
            used=$((used > ${cache:-0} ? used - ${cache:-0} : 0))
            limit=$((limit > used ? limit - used : 0))
            if [ "$limit" -lt "$free" ]; then free=$limit; fi
        fi
    done < <(group_folders "$root")
    echo "$free"
}

# Prints the number of compilers that run at once: one per core, limited to one per 1.5 GB of memory.
build_jobs() {
    local cores by_memory
    cores=$(nproc 2>/dev/null || echo 1)
    by_memory=$(($(free_memory) / 1500000000))
    if [ "$by_memory" -lt 1 ]; then by_memory=1; fi
    if [ "$by_memory" -lt "$cores" ]; then echo "$by_memory"; else echo "$cores"; fi
}

# ccache fails if its folder is not writable, for instance after another user's run with the same HOME: the build then
# goes without it.
check_ccache() {
    command -v ccache >/dev/null || return 0
    local folder compiler
    folder=$(mktemp -d)
    compiler=${CXX:-$(command -v clang++-19 || echo c++)}
    echo 'int x;' >"$folder/x.cpp"
    if ! ccache "$compiler" -c "$folder/x.cpp" -o "$folder/x.o" 2>/dev/null; then
        say "ccache can't use its folder; building without it"
        export CCACHE_DISABLE=1
    fi
    rm -r "$folder"
}

# build_preset NAME [TARGET...]: configures and builds a preset in the current folder: everything, or the given targets.
build_preset() {
    local preset=$1 jobs folder
    shift
    # `test` adds to the build of `release`, so the library is compiled once for both.
    folder=build/$preset
    [ "$preset" != test ] || folder=build/release
    if [ -e "$folder" ] && [ ! -w "$folder" ]; then
        fail "$PWD/$folder belongs to another user; remove it, or run this command as that user"
    fi
    check_ccache
    jobs=${FATHOM_JOBS:-$(build_jobs)}
    if [ ! -f "$folder/build.ninja" ] || [ CMakePresets.json -nt "$folder/build.ninja" ] ||
        { [ "$preset" = test ] && ! grep -q '^FATHOM_TESTS:BOOL=ON' "$folder/CMakeCache.txt"; }; then
        say "configuring $folder"
        cmake --preset "$preset" ${CI:+-DFATHOM_WERROR=ON} >&2 || fail "CMake could not configure $folder (see above)"
    fi
    say "building $folder, $jobs at a time"
    # The C locale, as in tests/planted: ccache keeps results apart by the language of compiler messages.
    LC_ALL=C cmake --build --preset "$preset" --parallel "$jobs" ${1:+--target "$@"} >&2 || fail "the build failed (see above)"
}

if [ "${BASH_SOURCE[0]}" = "$0" ]; then
    set -euo pipefail
    if [ "${1:-}" = tests ]; then
        install_missing "${packages_to_build[@]}" "${packages_to_test[@]}"
    else
        install_missing "${packages_to_build[@]}"
    fi
fi
