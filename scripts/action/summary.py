#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Step of action.yml: writes a summary with numbers and images, and fails if a render is not like its reference.

FATHOM_OUTPUT        folder with images and results.json, of compare.py
FATHOM_ARTIFACT      name of the artifact with this folder; may be empty
FATHOM_IMAGES_URL    address below which the images are published; may be empty
GITHUB_STEP_SUMMARY  file that the summary is added to
"""
import json
import os
import pathlib
import sys
import urllib.parse

SHOWN = {".png", ".jpg", ".jpeg", ".webp", ".avif"}
MARKS = {"same": "✅ same", "different": "❌ different", "new": "🆕 new", "failed": "💥 failed"}


def text(value):
    """Escapes text for a table of Markdown."""
    return str(value).replace("&", "&amp;").replace("<", "&lt;").replace("|", "\\|").replace("\n", " ")


def noise_text(numbers):
    noise = numbers.get("noise")
    if noise is None or numbers["same"]:
        return ""
    if noise["explains_differences"]:
        return "explains the differences"
    return f"does not explain {len(noise['changed_blocks'])} of {noise['blocks']} blocks"


def row(result):
    cells = [MARKS[result["state"]], text(result["name"]), result["seconds"]]
    if "numbers" not in result:
        return cells + [text(result["message"]), "", "", "", ""]
    n = result["numbers"]
    largest = n["largest"]["difference"]
    return cells + [f"{n['different_pixels']} of {n['width'] * n['height']}", "∞" if largest is None else f"{largest:.3g}",
                    "∞" if n["psnr_db"] is None else f"{n['psnr_db']:.1f} dB", f"{n['flip']['mean']:.4f}", noise_text(n)]


def images(result, url):
    """The render, its reference and the difference side by side, as far as browsers show their formats."""
    cells = []
    for title, key in (("render", "image"), ("reference", "reference"), ("FLIP", "difference")):
        name = result.get(key)
        if name and pathlib.Path(name).suffix.lower() in SHOWN:
            cells.append((title, f'<img src="{url}/{urllib.parse.quote(name)}" alt="{title}" width="320">'))
    if not cells:
        return ""
    table = ["| " + " | ".join(cell[part] for cell in cells) + " |" for part in (0, 1)]
    table.insert(1, "|" + " --- |" * len(cells))
    return "\n".join([f"\n#### {text(result['name'])}", "", *table, ""])


def summary(results, url, artifact):
    different = [result for result in results if result["state"] != "same"]
    lines = [f"### Fathom: {len(results) - len(different)} of {len(results)} renders are like their references", "",
             "| | reference | seconds | different pixels | largest difference | PSNR | FLIP | noise |",
             "| --- | --- | ---: | --- | ---: | ---: | ---: | --- |"]
    lines += ["| " + " | ".join(map(str, row(result))) + " |" for result in results]
    if url:
        lines += [images(result, url) for result in different if result["state"] != "failed"]
    elif different and artifact:
        lines += ["", f"The images are in the artifact `{text(artifact)}`."]
    return "\n".join(lines) + "\n", len(different)


def main():
    results = json.loads((pathlib.Path(os.environ["FATHOM_OUTPUT"]) / "results.json").read_text())
    page, different = summary(results, os.environ.get("FATHOM_IMAGES_URL", ""), os.environ.get("FATHOM_ARTIFACT", ""))
    with open(os.environ["GITHUB_STEP_SUMMARY"], "a") as file:
        file.write(page)
    if different:
        sys.exit(f"{different} of {len(results)} renders are not like their references")


if __name__ == "__main__":
    main()
