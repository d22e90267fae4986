# SPDX-License-Identifier: Apache-2.0
"""Makes an HTML page of images of all models in a folder: see gallery.sh."""
import argparse
import html
import json
import os
import shutil
import subprocess
import sys
import urllib.parse
from pathlib import Path

MODELS = {".gltf", ".glb", ".obj", ".ply", ".stl", ".fbx", ".dae", ".3ds", ".off", ".x3d", ".blend"}

PAGE = """<!DOCTYPE html>
<html lang="en">
<meta charset="utf-8">
<meta name="viewport" content="width=device-width">
<title>{title}</title>
<style>
body {{ font: 15px/1.4 sans-serif; margin: 1.5em; background: #f4f4f4; color: #222 }}
main {{ display: grid; grid-template-columns: repeat(auto-fill, minmax({width}px, 1fr)); gap: 1.2em }}
figure {{ margin: 0; background: #fff; border-radius: 4px; overflow: hidden }}
img, .none {{ display: block; width: 100%; aspect-ratio: {aspect} }}
.none {{ background: #ddd }}
figcaption {{ padding: .6em .8em }}
.told {{ color: #666; font-size: 12px; margin: .3em 0 0; padding-left: 1.2em; overflow-wrap: anywhere }}
.error {{ color: #a00 }}
</style>
<h1>{title}</h1>
<p>{summary}</p>
<main>
{figures}
</main>
</html>
"""


def program():
    here = Path(__file__).resolve().parent.parent / "build/release/bin/fathom"
    found = os.environ.get("FATHOM") or shutil.which("fathom") or (str(here) if here.exists() else None)
    if not found:
        sys.exit("gallery: there is no fathom: put it on PATH, or name it by the environment variable FATHOM")
    return found


def models_of(folder):
    return sorted(path for path in folder.rglob("*") if path.suffix.lower() in MODELS and path.is_file())


def triangles_of(fathom, model):
    result = subprocess.run([fathom, "info", str(model), "--json"], capture_output=True, text=True)
    return json.loads(result.stdout)["counts"].get("triangles", 0) if result.returncode == 0 else None


def render(fathom, model, picture, options):
    """Returns a render's events, and whether it wrote an image."""
    command = [fathom, "render", str(model), "--progress", "json", "--spp", str(options.spp), "--size", options.size,
               "--denoise", "auto", "-o", str(picture)]
    result = subprocess.run(command, capture_output=True, text=True)
    events = []
    for line in result.stderr.splitlines():
        try:
            events.append(json.loads(line))
        except json.JSONDecodeError:
            events.append({"event": "error", "message": line})
    return events, result.returncode == 0


def figure(model, name, triangles, events, picture):
    summary = next((event for event in events if event["event"] == "summary"), None)
    facts = [f"{triangles:,} triangles"] if triangles is not None else []
    if summary:
        facts += [f"load {summary['load_s'] + summary['build_s']:.1f} s", f"render {summary['render_s']:.1f} s"]
    told = [(event["event"], event["message"] + (f" ({event['count']} times)" if event.get("count", 1) > 1 else ""))
            for event in events if event["event"] in ("note", "warning", "error")
            and not event["message"].startswith(("denoising with", "not denoised"))]
    lines = "".join(f'<li class="{kind}">{html.escape(text.replace(f"{model.parent}/", ""))}</li>' for kind, text in told)
    shown = f'<img src="{urllib.parse.quote(picture)}" alt="" loading="lazy">' if picture else '<div class="none"></div>'
    return (f"<figure>{shown}<figcaption><b>{html.escape(name)}</b><br>{html.escape(', '.join(facts))}"
            f'{f"""<ul class="told">{lines}</ul>""" if lines else ""}</figcaption></figure>')


def main():
    parser = argparse.ArgumentParser(prog="scripts/gallery.sh", description=__doc__)
    parser.add_argument("folder", type=Path)
    parser.add_argument("-o", "--output", type=Path, default=Path("gallery"))
    parser.add_argument("--spp", type=int, default=32)
    parser.add_argument("--size", default="320x240")
    options = parser.parse_args()
    fathom = program()
    models = models_of(options.folder)
    if not models:
        sys.exit(f"gallery: there are no models in {options.folder}")
    options.output.mkdir(parents=True, exist_ok=True)
    figures, failed = [], 0
    for number, model in enumerate(models):
        name = str(model.relative_to(options.folder))
        picture = f"{number:03}-{model.stem}.jpg"
        print(f"{number + 1}/{len(models)} {name}", flush=True)
        events, done = render(fathom, model, options.output / picture, options)
        failed += not done
        figures.append(figure(model, name, triangles_of(fathom, model), events, picture if done else None))
    width, height = options.size.split("x")
    summary = f"{len(models)} models at {options.spp} samples a pixel" + (f"; {failed} could not be rendered" if failed else "")
    page = PAGE.format(title=html.escape(options.folder.resolve().name), width=width, aspect=f"{width}/{height}",
                       summary=html.escape(summary), figures="\n".join(figures))
    (options.output / "index.html").write_text(page)
    print(f"wrote {options.output / 'index.html'}")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
