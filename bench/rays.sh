#!/bin/bash
# SPDX-License-Identifier: Apache-2.0
# Rays per second of Fathom and Embree: one line of JSON per mesh and kind of ray, then one about BVH construction.
#   bench/rays.sh [--quick] [--motion | --instances | --trees] [--mesh FILE.ply]... [--threads N] [--not-robust]
#                 [--build fast|standard|high|compact]
# Meshes: those of --mesh; else $FATHOM_MESHES/*.ply if it is set, and generated ones.
# --quick: fewer rays and smaller meshes, with the best instruction set of the machine.
# --motion: each mesh at rest, with vertices moving by 5 % of its size, instanced, and instanced and moving; random times.
#   "ours_times_still", "embree_times_still": rates relative to the mesh at rest.
# --trees: construction alone, in turns; wall clock and processor seconds; "ratio": speed relative to Embree.
# --instances: 10,000 instances of each mesh (default: generated, 100,000 triangles). --not-robust: for Embree only.
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

# Skips instruction sets that the machine lacks.
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
