# SPDX-License-Identifier: Apache-2.0
"""Writes the results of a folder as a page (index.html) and as tables in Markdown (compare.md)."""
import html
import json
import platform
import sys
from pathlib import Path

import environments
import graphs
import scenes
from tables import markdown, tables

sys.path.append(str(Path(__file__).resolve().parents[1]))
import machine  # noqa: E402

STYLE = """body{font:15px/1.5 sans-serif;max-width:75em;margin:2em auto;padding:0 1em;color:#222}table{border-collapse:collapse;margin:1em 0}
td,th{border:1px solid #ccc;padding:.2em .6em;text-align:right}td:first-child,th:first-child{text-align:left}.worse{background:#fbd5d5}
.images{display:flex;flex-wrap:wrap;gap:1em}figure{margin:0}figcaption{font-size:90%}"""


def read(folder):
    results = [json.loads(path.read_text()) for path in (folder / "results").glob("*.json")]
    return sorted(results, key=lambda result: scenes.NAMES.index(result["scene"]))


def html_table(head, rows):
    cell = lambda tag, text: f"<{tag}>{html.escape(str(text))}</{tag}>"
    body = "".join("<tr>" + "".join(cell("td", text) for text in row) + "</tr>" for row in rows)
    return "<table><tr>" + "".join(cell("th", text) for text in head) + "</tr>" + body + "</table>"


def conditions(results):
    version = ", ".join(sorted({package for name, packages in environments.PINNED.items() if name != "tools" for package in packages
                                if not package.startswith("numpy")}))
    settings = {(result["seconds"], result["threads"], result["rounds"], result["reference_factor"]) for result in results}
    text = "; ".join(f"{s:g} s with {t} threads, {r} rounds, references of {f} times the samples" for s, t, r, f in sorted(settings))
    return f"{machine.processor()} ({platform.machine()}). {version}. {text}."


def scene_section(folder, result):
    graph = graphs.error_over_time(result, folder / "images" / f"{result['scene']}.svg")
    pictures = []
    for name in result["runs"]:
        for suffix, label in (("", ""), ("-reference", ", reference")):
            path = folder / "images" / f"{result['scene']}-{name}{suffix}.png"
            if path.exists():
                pictures.append(f'<figure><img src="images/{path.name}" alt=""><figcaption>{name}{label}</figcaption></figure>')
    return (f'<h2 id="{result["scene"]}">{result["scene"]}</h2><img src="images/{graph.name}" alt="error over time">'
            f'<div class="images">{"".join(pictures)}</div>')


def write(folder):
    results = read(folder)
    if not results:
        return
    parts = tables(results)
    (folder / "compare.md").write_text(conditions(results) + "\n\n" + "\n".join(
        f"## {title}\n{markdown(head, rows) if rows else 'None.' + chr(10)}" for title, head, rows in parts))
    body = "".join(f"<h2>{html.escape(title)}</h2>" + (html_table(head, rows) if rows else "<p>None.</p>") for title, head, rows in parts)
    body += "".join(scene_section(folder, result) for result in results)
    (folder / "index.html").write_text(f"<!doctype html><html lang='en'><meta charset='utf-8'><title>Fathom and other renderers</title>"
                                       f"<style>{STYLE}</style><h1>Fathom and other renderers</h1><p>{html.escape(conditions(results))}</p>{body}</html>\n")
