#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Draws the graphs of docs/performance.md: docs/images/graphs/*.svg from docs/measurements/*.json.

usage: graphs.py [ROOT]

The output depends on the JSON files alone. Needs nothing but Python.
"""
import json
import math
import pathlib
import sys
from xml.sax.saxutils import escape

WIDTH = 760
LEFT, RIGHT = 172, 56  # room for names and for the numbers behind the longest bar
BAR, GAP, GROUP_GAP = 15, 3, 13

# Colors of the light theme are attributes and those of the dark theme a style sheet, so programs without style sheets
# draw the light one.
# Blue and orange can be told apart with each common kind of color blindness.
LIGHT = {"paper": "#ffffff", "ink": "#1f2328", "faint": "#59636e", "line": "#d1d9e0", "s0": "#0969da", "s1": "#bc4c00", "s2": "#6e7781"}
DARK = {"paper": "#0d1117", "ink": "#f0f6fc", "faint": "#9198a1", "line": "#3d444d", "s0": "#4493f8", "s1": "#db6d28", "s2": "#8b949e"}


class Svg:
    def __init__(self, height, title):
        style = "".join(f".{name}{{fill:{color}}}" for name, color in DARK.items() if name != "line")
        self.parts = [
            f'<svg xmlns="http://www.w3.org/2000/svg" width="{WIDTH}" height="{height}" viewBox="0 0 {WIDTH} {height}" '
            f'role="img" font-family="system-ui, \'DejaVu Sans\', Arial, sans-serif" font-size="13">',
            f"<title>{escape(title)}</title>",
            f"<style>@media (prefers-color-scheme: dark){{{style}.line{{stroke:{DARK['line']}}}}}</style>",
        ]
        self.rect(0, 0, WIDTH, height, "paper")

    def rect(self, x, y, width, height, name):
        self.parts.append(
            f'<rect class="{name}" x="{x:.1f}" y="{y:.1f}" width="{width:.1f}" height="{height:.1f}" fill="{LIGHT[name]}"/>')

    def text(self, x, y, words, name="ink", anchor="start", size=13, bold=False):
        weight = ' font-weight="600"' if bold else ""
        self.parts.append(f'<text class="{name}" x="{x:.1f}" y="{y:.1f}" text-anchor="{anchor}" font-size="{size}"{weight} '
                          f'fill="{LIGHT[name]}">{escape(words)}</text>')

    def line(self, x, y0, y1, width=1):
        self.parts.append(f'<line class="line" x1="{x:.1f}" y1="{y0:.1f}" x2="{x:.1f}" y2="{y1:.1f}" '
                          f'stroke="{LIGHT["line"]}" stroke-width="{width}"/>')

    def finish(self):
        return "\n".join(self.parts + ["</svg>"]) + "\n"


def bars(title, subtitle, series, groups, ticks, unit="×", logarithmic=False):
    """Draws horizontal bars: a group for each (name, values), a bar for each series; None leaves a bar out.

    A logarithmic axis begins at 1, so the length of a bar is the logarithm of a ratio.
    """
    bar_count = sum(1 for _, values in groups for value in values if value is not None)
    top = 92
    height = top + bar_count * (BAR + GAP) + len(groups) * GROUP_GAP + 34
    svg = Svg(height, f"{title}. {subtitle}")
    svg.text(16, 26, title, size=16, bold=True)
    svg.text(16, 46, subtitle, "faint", size=12)
    x = 16
    for number, name in enumerate(series):
        svg.rect(x, 60, 12, 12, f"s{number}")
        svg.text(x + 18, 71, name)
        x += 40 + 7.4 * len(name)
    low, high = (1 if logarithmic else 0), ticks[-1]
    place = (lambda v: math.log(max(v, low) / low) / math.log(high / low)) if logarithmic else (lambda v: v / high)
    scale = WIDTH - LEFT - RIGHT
    bottom = height - 30
    for tick in ticks:
        at = LEFT + place(tick) * scale
        svg.line(at, top - 6, bottom, 2 if tick == 1 else 1)
        svg.text(at, bottom + 16, f"{tick:g}{unit}", "faint", "middle", 12)
    y = top + GROUP_GAP / 2
    for name, values in groups:
        shown = [(number, value) for number, value in enumerate(values) if value is not None]
        middle = y + (len(shown) * (BAR + GAP) - GAP) / 2
        svg.text(LEFT - 10, middle + 4.5, name, anchor="end", bold=name.endswith("mean"))
        for number, value in shown:
            length = place(value) * scale
            svg.rect(LEFT, y, max(length, 1), BAR, f"s{number}")
            svg.text(LEFT + length + 6, y + BAR - 3, f"{value:g}{unit}", size=12)
            y += BAR + GAP
        y += GROUP_GAP
    return svg.finish()


class Results:
    def __init__(self, root):
        self.folder = root / "docs" / "measurements"

    def run(self, name, run_id):
        runs = json.loads((self.folder / f"{name}.json").read_text(encoding="utf-8"))["runs"]
        return next(run for run in runs if run["id"] == run_id)

    def column(self, name, run_id, key, column):
        """Returns the values of `column` by the value of `key` in each row; rows without the column are left out."""
        return {row[key]: row[column] for row in self.run(name, run_id)["rows"] if column in row}


def both(names, *columns):
    return [(name, [column.get(name) for column in columns]) for name in names]


def scenes(results, column, title, ticks, logarithmic):
    wide = results.column("scenes", "diffuse-zen4-avx512", "scene", column)
    narrow = results.column("scenes", "diffuse-zen4-avx2", "scene", column)
    return bars(title, "EPYC (Zen 4), 2 threads, 640 pixels wide, 32 samples per pixel. Longer is better.",
                ["AVX-512", "AVX2 (both programs)"], both(sorted(wide, key=lambda name: name.endswith("mean")), wide, narrow), ticks, logarithmic=logarithmic)


def originals(results):
    speed = results.column("scenes", "original-sapphire-rapids-avx512", "scene", "speed_times_mitsuba")
    efficiency = results.column("scenes", "original-sapphire-rapids-avx512", "scene", "efficiency")
    return bars("Scenes with their own materials, relative to Mitsuba 3.9.1",
                "Xeon (Sapphire Rapids), AVX-512, 2 threads, one round. Logarithmic; longer is better.",
                ["samples per second", "efficiency"], both(speed, speed, efficiency), [1, 2, 4, 8, 16, 32], logarithmic=True)


def pbrt(results):
    speed = results.column("pbrt", "originals", "scene", "speed_times_pbrt")
    efficiency = results.column("pbrt", "originals", "scene", "efficiency_times_pbrt")
    return bars("pbrt's scenes, relative to pbrt-v4", "Zen 5, AVX-512, 1 thread, processor time. Longer is better.",
                ["samples per second", "efficiency"], both(speed, speed, efficiency), [0, 1, 4, 8, 12])


def cornell_box(results):
    machines = [("Zen 5", "zen5"), ("Emerald Rapids", "emerald-rapids"), ("Zen 4", "zen4"), ("Sapphire Rapids", "sapphire-rapids")]
    columns = [{name: results.column("cornell-box", f"{machine}-{level}", "scene", "times_mitsuba")["cornell-box.json"]
                for name, machine in machines} for level in ("avx512", "avx2")]
    return bars("Cornell box: samples per second, relative to Mitsuba 3.9.1",
                "800x600, depth 50, 2 threads. On Zen 5, Mitsuba uses AVX-512 in both rows.",
                ["AVX-512", "AVX2"], both([name for name, _ in machines], *columns), [0, 1, 4, 8, 12])


def rays(results):
    names = {"primary": "camera rays", "shadow": "shadow rays", "bounce_1": "first bounce", "bounce_3": "third bounce",
             "occlusion": "short occlusion rays"}
    columns = []
    for level in ("avx512", "avx2"):
        mean = results.run("rays", f"sapphire-rapids-{level}")["rows"][0]
        columns.append({name: mean[key] for key, name in names.items()})
    return bars("Rays per second, relative to Embree 3.13.5",
                "Means of six meshes of 0.1 to 10 million triangles, Xeon (Sapphire Rapids), 1 thread. Longer is better.",
                ["AVX-512", "AVX2"], both(names.values(), *columns), [0, 0.5, 1, 1.5, 2])


def samplers(results):
    rows = results.run("samplers", "relmse")["rows"]
    peers = ["independent", "stratified", "multijitter", "orthogonal", "ldsampler"]
    best = {row["scene"]: round(min(row[peer] for peer in peers) / row["fathom"], 2) for row in rows}
    plain = {row["scene"]: round(min(row[peer] for peer in peers) / row["fathom_without_guiding"], 2) for row in rows}
    return bars("Noise at equal samples: Mitsuba's best sampler, relative to Fathom",
                "relMSE of the best of five samplers divided by Fathom's, 64 samples per pixel. Longer is better.",
                ["Fathom as it runs by default", "without path guiding"], both(best, best, plain), [0, 0.5, 1, 1.5, 2, 2.5])


def graphs(root):
    """Returns the text of each file, by its name."""
    results = Results(root)
    return {
        "scenes-speed.svg": scenes(results, "speed_times_mitsuba", "Samples per second, relative to Mitsuba 3.9.1", [0, 1, 2, 3, 4, 5], False),
        "scenes-efficiency.svg": scenes(results, "efficiency", "Efficiency (noise at equal time), relative to Mitsuba 3.9.1, logarithmic",
                                        [1, 2, 4, 8, 16, 32], True),
        "scenes-original.svg": originals(results),
        "pbrt.svg": pbrt(results),
        "cornell-box.svg": cornell_box(results),
        "rays-embree.svg": rays(results),
        "samplers.svg": samplers(results),
    }


def main():
    root = pathlib.Path(sys.argv[1]) if len(sys.argv) > 1 else pathlib.Path(__file__).resolve().parent.parent
    folder = root / "docs" / "images" / "graphs"
    folder.mkdir(parents=True, exist_ok=True)
    for name, text in graphs(root).items():
        (folder / name).write_text(text, encoding="utf-8")
        print(f"docs/images/graphs/{name}")


if __name__ == "__main__":
    main()
