#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Speed and noise of real scenes beside Mitsuba 3 `llvm_ad_rgb`, and Fathom's time by stage; writes a table in
Markdown.

`clay.py` of --peers makes each scene of --scenes (folders with a Mitsuba scene.xml) into a diffuse twin that both
programs read. `clay_compare.py`, also of --peers, renders the twins in turns; it makes its own Python environment for
Mitsuba. With --originals both programs also render the unmodified scenes (originals.py). Speed is the ratio of
samples/s, efficiency the ratio of 1 / (relMSE x seconds) at equal samples; both are medians of the rounds. The machine
should be idle: alternating runs compensate for some load, but not all.
"""
import argparse, json, math, os, subprocess, sys, tempfile
from pathlib import Path

import machine

ROOT = Path(__file__).resolve().parent.parent


def make_twin(peers, scene, folder):
    if not (folder / "scene.json").exists():
        files = sorted((scene).glob("scene*.xml"))
        subprocess.run([sys.executable, str(peers / "clay.py"), str(files[0]), str(folder)], check=True, stdout=subprocess.DEVNULL)


def options_of(twin):
    """Rotates environments: clay.py writes them with -z at the image's center, Fathom expects +x."""
    environment = json.loads((twin / "scene.json").read_text()).get("environment", {})
    return ["--env-rotate", "90"] if environment.get("kind") == "image" else []


def without_avx512(folder):
    """Restricts Fathom to AVX2 by a variable, and Mitsuba by a library written into a folder; returns the environment
    variables that Mitsuba needs for it."""
    os.environ["FATHOM_KERNEL"] = "avx2"
    library = Path(folder) / "mitsuba_avx2.so"
    subprocess.run(["cc", "-shared", "-fPIC", "-O1", "-o", str(library), str(ROOT / "bench/mitsuba_avx2.c")], check=True)
    return {"LD_PRELOAD": str(library)}


def compare(args, folder):
    command = [sys.executable, str(ROOT / "bench/originals.py"), "--peers", str(args.peers)] if args.originals else [
        sys.executable, str(args.peers / "clay_compare.py"), "--extra=" + " ".join(options_of(folder))]
    command += ["--fathom", str(args.fathom), "--width", str(args.width), "--spp", str(args.spp), "--rounds", str(args.rounds),
                "--reference-spp", str(args.reference_spp), str(folder)]
    run = subprocess.run(command, stdout=subprocess.PIPE, text=True, env={**os.environ, **args.mitsuba_environment})
    lines = [line for line in run.stdout.splitlines() if line.startswith("{")]
    if not lines:
        sys.exit(f"{folder.name}: nothing was measured")
    return json.loads(lines[0])


def cost_sheet(args, folder):
    scene = [str(folder / "scene.xml")] if args.originals else [str(folder / "scene.json"), *options_of(folder)]
    with tempfile.TemporaryDirectory() as pictures:
        command = [str(args.fathom), "render", *scene, "--spp", "16", "--threads", "1", "--filter", "box", "--size",
                   f"{args.width // 2}x{args.width * 9 // 32}", "--stats", "--progress", "json", "-o", pictures + "/x.exr"]
        lines = subprocess.run(command, check=True, capture_output=True, text=True).stderr.splitlines()
    return next(event for event in map(json.loads, filter(lambda line: line.startswith("{"), lines)) if event["event"] == "stats")


def row(scene, figures, costs):
    share = {name: stage["share"] for name, stage in costs["stages"].items()}
    traversal = share.get("trace", 0) + share.get("shadow", 0)
    others = sorted(((value, name) for name, value in share.items() if name not in ("trace", "shadow")), reverse=True)
    vertex = sum(stage["ns_per_vertex"] for stage in costs["stages"].values())
    ours, theirs = figures["mean_fathom"], figures["mean_mitsuba"]
    apart = max(abs(a - b) / max(b, 1e-9) for a, b in zip(ours, theirs))
    return (f"| {scene} | {figures['speed']} | {figures['efficiency']} | {figures['fathom_msps']} | {figures['relmse_fathom']} / "
            f"{figures['relmse_mitsuba']} | {100 * apart:.2f} % | {vertex:.0f} | {100 * traversal:.0f} % | "
            + ", ".join(f"{name} {100 * value:.0f}" for value, name in others[:3]) + " |")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--fathom", type=Path, default=ROOT / "build/release/bin/fathom")
    parser.add_argument("--scenes", type=Path, default=ROOT / "../shared/scenes/mitsuba")
    parser.add_argument("--peers", type=Path, default=ROOT / "../shared/peers")
    parser.add_argument("--originals", action="store_true", help="the scenes as they are, instead of their twins")
    parser.add_argument("--avx2", action="store_true", help="both programs do without AVX-512")
    parser.add_argument("--only", help="names of scenes, by commas")
    parser.add_argument("--twins", type=Path, default=Path.home() / ".cache/fathom-scenes", help="where twins are kept")
    parser.add_argument("--out", type=Path, default=Path("scenes.md"))
    parser.add_argument("--width", type=int, default=640)
    parser.add_argument("--spp", type=int, default=32)
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--reference-spp", type=int, default=512)
    args = parser.parse_args()
    for needed in (args.peers / "clay.py", args.peers / "clay_compare.py"):
        if not needed.exists():
            sys.exit(f"{needed} is missing: --peers names the folder with the scripts that make and time the twins")
    names = args.only.split(",") if args.only else sorted(p.parent.name for p in args.scenes.glob("*/scene.xml"))
    if not names:
        sys.exit(f"{args.scenes} has no folders with a scene.xml: --scenes names the folder")
    shim = tempfile.TemporaryDirectory()
    args.mitsuba_environment = without_avx512(shim.name) if args.avx2 else {}
    version = subprocess.run([str(args.fathom), "version"], check=True, capture_output=True, text=True).stdout.splitlines()
    head = [f"{machine.processor()}, {os.cpu_count()} cores; {version[1].strip()}; 2 threads, {args.width} wide, {args.spp} samples, {args.rounds} rounds",
            "", "| scene | samples/s, times Mitsuba | efficiency | million samples/s | relMSE, ours / Mitsuba | means apart | ns a vertex "
            "| traversal | then |", "| --- | --- | --- | --- | --- | --- | --- | --- | --- |"]
    rows, speeds, efficiencies = [], [], []
    for name in names:
        folder = args.scenes / name if args.originals else args.twins / name
        if not args.originals:
            make_twin(args.peers, args.scenes / name, folder)
        figures = compare(args, folder)
        speeds.append(figures["speed"]), efficiencies.append(figures["efficiency"])
        rows.append(row(name, figures, cost_sheet(args, folder)))
        mean = lambda values: math.prod(values) ** (1 / len(values))
        foot = f"| geometric mean (least) | {mean(speeds):.2f} ({min(speeds)}) | {mean(efficiencies):.2f} ({min(efficiencies)}) | | | | | | |"
        args.out.write_text("\n".join(head + rows + [foot]) + "\n", encoding="utf-8")  # keeps intermediate results if the run
                                                                                       # is stopped
        print(rows[-1], flush=True)
    print(foot)


if __name__ == "__main__":
    main()
