#!/usr/bin/env bash
# What render.sh and test.sh share: installing the packages that are missing, and building a preset.
# Read by `source`; run alone, `scripts/setup.sh [tests]` only installs.

# The one list of packages (the same names in Debian 12 and Ubuntu 24.04). clang-19 brings the standard library with it; g++
# replaces it where apt has none.
packages_to_build=(
    clang-19 cmake ninja-build pkg-config ccache
    libtbb-dev libfmt-dev libcli11-dev nlohmann-json3-dev
    libopenexr-dev libpng-dev libjpeg-dev libwebp-dev libstb-dev
    libassimp-dev libsfml-dev
)
packages_to_test=(
    clang-format-19 libgtest-dev libbenchmark-dev libembree-dev
    python3 python3-jsonschema xvfb xdotool imagemagick
)

say() { printf 'fathom: %s\n' "$*" >&2; }
fail() {
    say "$@"
    exit 1
}

is_installed() {
    [ "$(dpkg-query --show --showformat '${db:Status-Status}' "$1" 2>/dev/null)" = installed ]
}

# Runs a command as root: as it is, or through sudo.
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

# Ends with advice where nothing can be installed.
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

# missing_of PACKAGE...: those that are not installed, a line each. Where apt knows of no clang-19, GCC will do, and the
# layout of sources is not tested.
missing_of() {
    local package
    for package in "$@"; do
        # Lists that have neither have not been fetched yet.
        if [[ $package = clang-*19 ]] && ! is_installed "$package" && ! apt_has "$package" && apt_has g++; then
            if [ "$package" = clang-19 ]; then package=g++; else continue; fi
        fi
        is_installed "$package" || echo "$package"
    done
}

# install_missing PACKAGE...: says what is missing, then installs it. Nothing is asked of apt if nothing is missing.
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
    mapfile -t missing < <(missing_of "$@")  # apt may know of clang-19 now
    say "installing with apt-get, and what they need: ${missing[*]}"
    apt_get install --yes --no-install-recommends "${missing[@]}" ||
        fail "apt-get could not install the packages above. Is the machine online?" \
            "On Ubuntu, the component 'universe' must be enabled (add-apt-repository universe)"
}

# Bytes that may be used, by the machine and by this container. (mawk cuts %d off at 2^31.)
free_memory() {
    local free limit
    free=$(awk '/^MemAvailable:/ { printf "%.0f", $2 * 1024 }' /proc/meminfo 2>/dev/null || true)
    limit=$(cat /sys/fs/cgroup/memory.max 2>/dev/null || echo max)
    if [ "$limit" != max ] && [ "$limit" -lt "${free:-0}" ]; then
        free=$limit
    fi
    echo "${free:-4000000000}"
}

# As many compilers at once as there are cores, but each may need 1.5 GB.
build_jobs() {
    local cores by_memory
    cores=$(nproc 2>/dev/null || echo 1)
    by_memory=$(($(free_memory) / 1500000000))
    if [ "$by_memory" -lt 1 ]; then by_memory=1; fi
    if [ "$by_memory" -lt "$cores" ]; then echo "$by_memory"; else echo "$cores"; fi
}

# ccache fails where its folder can't be written, as after another user's run with the same HOME: then without it.
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

# build_preset NAME: configures and builds build/NAME, in the current folder.
build_preset() {
    local preset=$1 jobs
    if [ -e "build/$preset" ] && [ ! -w "build/$preset" ]; then
        fail "$PWD/build/$preset belongs to another user; remove it, or run this command as that user"
    fi
    check_ccache
    # Another clone of the same files finds what this one compiled.
    export CCACHE_BASEDIR=$PWD
    jobs=${FATHOM_JOBS:-$(build_jobs)}
    if [ ! -f "build/$preset/build.ninja" ] || [ CMakePresets.json -nt "build/$preset/build.ninja" ]; then
        say "configuring build/$preset"
        cmake --preset "$preset" >&2 || fail "CMake could not configure build/$preset (see above)"
    fi
    say "building build/$preset, $jobs at a time"
    cmake --build --preset "$preset" --parallel "$jobs" >&2 || fail "the build failed (see above)"
}

if [ "${BASH_SOURCE[0]}" = "$0" ]; then
    set -euo pipefail
    if [ "${1:-}" = tests ]; then
        install_missing "${packages_to_build[@]}" "${packages_to_test[@]}"
    else
        install_missing "${packages_to_build[@]}"
    fi
fi
