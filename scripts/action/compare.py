#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Step of action.yml: renders the images of a list and compares them with their references.

FATHOM_RENDERS             file with a render per line: REFERENCE SCENE [OPTION]..., words as in a shell, # for comments
FATHOM_OPTIONS             options for all renders; those of a line take precedence
FATHOM_TOLERANCE           for `fathom diff`
FATHOM_ALLOW_NOISE         "true": differences by noise are no failure
FATHOM_OUTPUT              folder for images and results.json
GITHUB_OUTPUT              gets different=N

Fails only if the list is wrong: summary.py decides by the results, after the images were published.
"""
import json
import os
import pathlib
import shlex
import shutil
import subprocess
import sys
import time


def read_list(path):
    """Returns (reference, scene, options) for each line."""
    renders = []
    for number, line in enumerate(path.read_text().splitlines(), 1):
        words = shlex.split(line, comments=True)
        if not words:
            continue
        if len(words) < 2:
            sys.exit(f"{path}: line {number}: expected REFERENCE SCENE [OPTION]..., found '{line.strip()}'")
        renders.append((pathlib.Path(words[0]), words[1], words[2:]))
    if not renders:
        sys.exit(f"{path}: the list has no renders")
    return renders


def run(*words):
    """Runs the program and returns exit code, output and the last line of its messages."""
    result = subprocess.run(["fathom", *map(str, words)], capture_output=True, text=True)
    lines = result.stderr.strip().splitlines()
    return result.returncode, result.stdout, lines[-1] if lines else f"exit code {result.returncode}"


def without(options, names):
    """Returns the options, of which each begins with a word with a dash, except those of these names."""
    kept, keeps = [], True
    for word in options:
        if word.startswith("-") and not word[1:2].isdigit():
            keeps = word.split("=")[0] not in names
        if keeps:
            kept.append(word)
    return kept


def compare(reference, scene, options, output):
    """Renders an image and returns its result: state, and numbers or a message."""
    name = "-".join(part for part in reference.parts if part not in ("/", "..", "."))
    image, difference = output / name, output / f"{name}.diff.png"
    result = {"name": str(reference), "scene": scene, "image": name}
    start = time.monotonic()
    common = without(shlex.split(os.environ.get("FATHOM_OPTIONS", "")), {word.split("=")[0] for word in options})
    code, _, message = run("render", scene, *common, *options, "-o", image, "-q")
    result["seconds"] = round(time.monotonic() - start, 2)
    if code != 0:
        return {**result, "state": "failed", "message": message}
    if not reference.exists():
        return {**result, "state": "new", "message": "there is no reference: commit the image of the artifact"}
    shutil.copy(reference, output / f"reference-{name}")
    noise = ["--allow-noise"] if os.environ.get("FATHOM_ALLOW_NOISE") == "true" else []
    code, text, message = run("diff", image, reference, "--tolerance", os.environ.get("FATHOM_TOLERANCE") or "0", *noise,
                              "--json", "-o", difference)
    if code > 1:
        return {**result, "state": "failed", "message": message}
    return {**result, "state": "different" if code else "same", "reference": f"reference-{name}",
            "difference": difference.name, "numbers": json.loads(text)}


def main():
    output = pathlib.Path(os.environ["FATHOM_OUTPUT"])
    renders = read_list(pathlib.Path(os.environ["FATHOM_RENDERS"]))
    output.mkdir(parents=True, exist_ok=True)
    results = []
    for reference, scene, options in renders:
        results.append(compare(reference, scene, options, output))
        print(f"{results[-1]['state']}: {reference} {results[-1].get('message', '')}", flush=True)
    (output / "results.json").write_text(json.dumps(results, indent=1))
    different = sum(result["state"] != "same" for result in results)
    with open(os.environ["GITHUB_OUTPUT"], "a") as file:
        file.write(f"different={different}\n")


if __name__ == "__main__":
    main()
