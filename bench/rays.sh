#!/bin/bash
# Rays per second, ours and Embree's: one JSON line per mesh and kind of ray, and a last one about building the trees.
#   bench/rays.sh [--quick] [--motion | --instances | --trees] [--mesh FILE.ply]... [--threads N] [--build fast|default|high|compact] [--not-robust]
# Meshes: those named by --mesh; else the *.ply in $FATHOM_MESHES, if it is set, and generated ones.
# --quick: fewer rays of smaller meshes, with the best instruction set that the machine has.
# --motion: each mesh at rest, with vertices that move by 5 % of its size, placed, and placed and moving as far; all rays at
#   random times; "ours_times_still" and "embree_times_still": rays/s as a part of those of the mesh at rest.
# --trees: building alone, in turns; seconds on the wall and of the processor; "ratio": how many times as fast as Embree.
# --instances: each mesh in 10,000 places; unless named otherwise generated ones of 100,000 triangles.
# --not-robust: Embree without its robust flag; ours stays watertight.
set -euo pipefail
cd "$(dirname "$0")/.."

quick=false
mode=
meshes=()
options=()
while [ $# -gt 0 ]; do
    case "$1" in
        --quick) quick=true ;;
        --mesh) meshes+=(--mesh "$(realpath "$OLDPWD/$2" 2>/dev/null || realpath "$2")"); shift ;;
        --threads | --build) options+=("$1" "$2"); shift ;;
        --motion | --instances | --trees) mode=$1; options+=("$1") ;;
        --not-robust) options+=("$1") ;;
        *) sed -n '1d; /^# SPDX/d; /^#/!q; s/^# \{0,1\}//p' "$0" >&2; exit 2 ;;
    esac
    shift
done

# What this machine can't run is left out.
isas=()
supported=$(/lib64/ld-linux-x86-64.so.2 --help)
for isa in x86-64-v4 x86-64-v3; do
    [[ $supported == *"$isa (supported"* ]] && isas+=("$isa")
done
$quick && isas=("${isas[@]:0:1}")

build=build/bench
programs=()
{
    cmake -S . -B $build -G Ninja -DCMAKE_BUILD_TYPE=Release -DFATHOM_BENCHMARKS=ON
    known=$(ninja -C $build -t targets all)
    for isa in "${isas[@]}"; do
        target=bench_rays_${isa//-/_}
        [[ $known == *"$target: phony"* ]] || continue
        ninja -C $build "$target"
        programs+=("$build/bin/rays-$isa")
    done
} >&2
if [ ${#programs[@]} = 0 ]; then
    echo "bench/rays.sh: needs Embree 3 (libembree-dev) and a processor with AVX2" >&2
    exit 1
fi

if [ ${#meshes[@]} = 0 ] && [ "$mode" = --instances ]; then
    meshes=(--generate boulder-0.1 --generate foliage-0.1)
elif [ ${#meshes[@]} = 0 ]; then
    if [ -n "${FATHOM_MESHES:-}" ]; then
        for name in living-room kitchen; do
            [ -f "$FATHOM_MESHES/$name.ply" ] && meshes+=(--mesh "$FATHOM_MESHES/$name.ply")
        done
    else
        echo "bench/rays.sh: FATHOM_MESHES is not set: generated meshes only" >&2
    fi
    meshes+=(--generate terrain-1 --generate foliage-1)
    $quick || [ "$mode" = --motion ] || meshes+=(--generate terrain-10)
fi
$quick && options+=(--parts 64 --runs 3)

trees=""
while read -r line; do
    case "$line" in
        *'"kind"'*) echo "$line" ;;
        *) trees+="${trees:+, }$line" ;;
    esac
done < <(for program in "${programs[@]}"; do "$program" "${meshes[@]}" "${options[@]}" || echo failed >&2; done)
[ -n "$trees" ] || exit 1
echo "{\"trees\": [$trees]}"
