#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Renders the project's scenes, 800x600 with 50 bounces, and writes a page that shows them.

usage: scenes/gallery.py [--fathom PROGRAM] [--spp N] [FOLDER]      (default folder: gallery)"""
import argparse, html, json, subprocess
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
SCENES = ["cornell-box", "cornell-box-mirror", "cornell-box-triangles", "report-spheres", "report-checker", "report-marble",
          "report-light", "environment", "textures", "depth-of-field", "motion-blur", "motion-nodes",
          "motion-vertices", "curves", "points", "instances", "displacement", "model",
          "still-life"]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--fathom", default=ROOT / "build/release/bin/fathom")
    parser.add_argument("--spp", default="256")
    parser.add_argument("folder", nargs="?", type=Path, default=Path("gallery"))
    args = parser.parse_args()
    args.folder.mkdir(parents=True, exist_ok=True)
    rows = []
    for name in SCENES:
        scene = ROOT / "scenes" / f"{name}.json"
        picture = args.folder / f"{name}.png"
        run = subprocess.run([str(args.fathom), "render", str(scene), "--size", "800x600", "--max-depth", "50", "--spp", args.spp,
                              "--progress", "json", "-o", str(picture)], check=True, capture_output=True, text=True)
        summary = json.loads(run.stderr.strip().splitlines()[-1])
        comment = json.loads(scene.read_text()).get("comment", "")
        rows.append(f'<figure><img src="{picture.name}" width="800" height="600" alt="{name}"><figcaption><b>{name}</b>: '
                    f'{html.escape(comment)} {args.spp} samples a pixel in {summary.get("render_s", 0):.1f} s.</figcaption></figure>')
        print(name, f'{summary.get("render_s", 0):.1f} s')
    page = args.folder / "index.html"
    page.write_text('<!doctype html><meta charset="utf-8"><title>Fathom: gallery</title>\n<style>body{font-family:sans-serif;'
                    'background:#222;color:#ddd}figure{display:inline-block;max-width:800px}</style>\n<h1>Gallery</h1>\n'
                    + "\n".join(rows) + "\n")
    print("wrote", page)


main()
