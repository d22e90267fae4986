#!/bin/bash
# Rays per second, ours and Embree's: one JSON line per mesh and kind of ray, and one per mesh for building it.
#   bench/rays.sh [--quick] [--mesh FILE.ply]... [--threads N]
# Meshes: those named by --mesh; else the *.ply in $FATHOM_MESHES, if it is set, and generated ones.
set -euo pipefail
cd "$(dirname "$0")/.."

quick=false
meshes=()
threads=1
while [ $# -gt 0 ]; do
    case "$1" in
        --quick) quick=true ;;
        --mesh) meshes+=(--mesh "$2"); shift ;;
        --threads) threads=$2; shift ;;
        *) sed -n '2,5p' "$0" >&2; exit 2 ;;
    esac
    shift
done

build=build/bench
{
    cmake -S . -B $build -G Ninja -DCMAKE_BUILD_TYPE=Release -DFATHOM_BENCHMARKS=ON
    ninja -C $build -t targets all | sed -n 's/^\(bench_rays_x86_64_v[34]\): phony$/\1/p' | xargs --no-run-if-empty ninja -C $build
} >&2
programs=()
supported=$(/lib64/ld-linux-x86-64.so.2 --help)
for isa in x86-64-v4 x86-64-v3; do
    # What this machine can't run is left out.
    [ -x $build/bin/rays-$isa ] && [[ $supported == *"$isa (supported"* ]] && programs+=("$build/bin/rays-$isa")
done
if [ ${#programs[@]} = 0 ]; then
    echo "bench/rays.sh: needs Embree 3 (libembree-dev) and a processor with AVX2" >&2
    exit 1
fi

if [ ${#meshes[@]} = 0 ]; then
    if [ -n "${FATHOM_MESHES:-}" ]; then
        for name in living-room kitchen; do
            [ -f "$FATHOM_MESHES/$name.ply" ] && meshes+=(--mesh "$FATHOM_MESHES/$name.ply")
        done
    else
        echo "bench/rays.sh: FATHOM_MESHES is not set: generated meshes only" >&2
    fi
    meshes+=(--generate terrain-1 --generate foliage-1)
    $quick || meshes+=(--generate terrain-10)
fi
options=(--threads "$threads")
$quick && options+=(--parts 32 --runs 3)
for program in "${programs[@]}"; do
    "$program" "${meshes[@]}" "${options[@]}"
done
