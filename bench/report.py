#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Remakes the appendix of the report from which Fathom originated: the Cornell box at 1 to 10,000 samples per pixel,
times for one thread and for all, a graph with a linear fit (SVG), and the time in which next event estimation reaches
the noise of 10,000 samples without it.

usage: bench/report.py [--fathom PROGRAM] [--most 10000] [FOLDER]      (default folder: report)

Times in the report, in minutes: 3.3 (5 samples), 4.1, 5.5, 12.7, 22.4, 93.8 (5000), 186.5 (10,000).
"""
import argparse, json, os, subprocess, sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
SAMPLES = [1, 5, 25, 100, 500, 1000, 5000, 10000]
REPORT_MINUTES = {5: 3.3, 25: 4.1, 100: 5.5, 500: 12.7, 1000: 22.4, 5000: 93.8, 10000: 186.5}


def render(program, scene, out, *options):
    run = subprocess.run([str(program), "render", str(ROOT / "scenes" / scene), "--max-depth", "50", "--progress", "json", "-o",
                          str(out), *options], check=True, capture_output=True, text=True)
    return json.loads(run.stderr.strip().splitlines()[-1])["render_s"]


def mean_variance(program, folder, scene, spp, *options):
    """Mean over the image of the variance of the mean, from two halves of the samples with exact sums."""
    halves = []
    for name, samples in [("a", f"0:{spp // 2}"), ("b", f"{spp // 2}:{spp}")]:
        out = folder / f"half-{name}.hdr"
        render(program, scene, out, "--samples", samples, *options)
        halves.append(read_hdr(out))
    # The difference of two halves has four times the variance of the mean of all samples.
    return sum((x - y) ** 2 for x, y in zip(*halves)) / len(halves[0]) / 4


def read_hdr(path):
    data = Path(path).read_bytes()
    body = data.index(b"\n\n") + 2
    end = data.index(b"\n", body)
    _, height, _, width = data[body:end].split()
    width, height, at, values = int(width), int(height), end + 1, []
    for _ in range(height):
        at += 4
        planes = []
        for _ in range(4):
            row = bytearray()
            while len(row) < width:
                count = data[at]
                if count > 128:
                    row += bytes([data[at + 1]]) * (count - 128)
                    at += 2
                else:
                    row += data[at + 1:at + 1 + count]
                    at += 1 + count
            planes.append(row)
        for r, g, b, e in zip(*planes):
            scale = 2.0 ** (e - 136) if e else 0.0
            values += [r * scale, g * scale, b * scale]
    return values


def fit(points):
    """Least-squares fit of seconds = a + b * samples."""
    n, sx, sy = len(points), sum(x for x, _ in points), sum(y for _, y in points)
    sxx, sxy = sum(x * x for x, _ in points), sum(x * y for x, y in points)
    b = (n * sxy - sx * sy) / (n * sxx - sx * sx)
    return (sy - b * sx) / n, b


def graph(path, one, every, threads):
    width, height, left, bottom = 640, 400, 70, 50
    most_x, most_y = max(x for x, _ in one), max(y for _, y in one + every) * 1.05
    px = lambda x: left + (width - left - 20) * x / most_x
    py = lambda y: height - bottom - (height - bottom - 20) * y / most_y
    parts = [f'<svg xmlns="http://www.w3.org/2000/svg" width="{width}" height="{height}" font-family="sans-serif" font-size="12">',
             f'<rect width="{width}" height="{height}" fill="white"/>',
             f'<path d="M{left},20V{height - bottom}H{width - 20}" fill="none" stroke="black"/>']
    for i in range(6):
        x, y = most_x * i / 5, most_y * i / 5
        parts.append(f'<text x="{px(x)}" y="{height - bottom + 16}" text-anchor="middle">{x:.0f}</text>')
        parts.append(f'<text x="{left - 6}" y="{py(y) + 4}" text-anchor="end">{y:.0f}</text>')
    parts.append(f'<text x="{width / 2}" y="{height - 10}" text-anchor="middle">samples a pixel</text>')
    parts.append(f'<text x="14" y="{height / 2}" transform="rotate(-90 14 {height / 2})" text-anchor="middle">seconds</text>')
    for row, (points, colour, name) in enumerate([(one, "#b03030", "1 thread"), (every, "#3050b0", f"{threads} threads")]):
        a, b = fit(points)
        parts.append(f'<path d="M{px(0)},{py(max(a, 0))}L{px(most_x)},{py(a + b * most_x)}" stroke="{colour}" fill="none"/>')
        parts += [f'<circle cx="{px(x)}" cy="{py(y)}" r="3" fill="{colour}"/>' for x, y in points]
        parts.append(f'<text x="{left + 20}" y="{40 + 18 * row}" fill="{colour}">{name}: {a:.2f} s + {b * 1000:.3f} ms a sample</text>')
    path.write_text("\n".join(parts) + "\n</svg>\n")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--fathom", default=ROOT / "build/release/bin/fathom")
    parser.add_argument("--most", type=int, default=10000)
    parser.add_argument("folder", nargs="?", type=Path, default=Path("report"))
    args = parser.parse_args()
    args.folder.mkdir(parents=True, exist_ok=True)
    threads = len(os.sched_getaffinity(0))
    one, every, rows = [], [], []
    for spp in [s for s in SAMPLES if s <= args.most]:
        picture = args.folder / f"cornell-{spp}.png"
        every.append((spp, render(args.fathom, "cornell-box.json", picture, "--spp", str(spp))))
        one.append((spp, render(args.fathom, "cornell-box.json", picture, "--spp", str(spp), "--threads", "1")))
        # The report has the mirror wall up to 5000 samples (87.2 minutes).
        mirror = render(args.fathom, "cornell-box-mirror.json", args.folder / f"mirror-{spp}.png", "--spp", str(spp)) if spp <= 5000 else None
        minutes = REPORT_MINUTES.get(spp)
        mirror_text = f"{mirror / 60:.3f}" if mirror else "-"
        rows.append(f"| {spp} | {minutes if minutes else '-'} | {one[-1][1] / 60:.3f} | {every[-1][1] / 60:.3f} | {mirror_text} |")
        print(rows[-1], flush=True)
    graph(args.folder / "times.svg", one, every, threads)

    # Variance falls as one over the number of samples: it is measured at few samples and extrapolated to 10,000.
    without = mean_variance(args.fathom, args.folder, "cornell-box.json", 128, "--light-sampling", "off") * 128 / 10000
    spp = 2
    while mean_variance(args.fathom, args.folder, "cornell-box.json", spp) > without and spp < 4096:
        spp *= 2
    reached = render(args.fathom, "cornell-box.json", args.folder / "equal.png", "--spp", str(spp))
    note = (f"With light sampling {spp} samples a pixel have less noise than 10,000 without: {reached:.2f} s on {threads} threads "
            "instead of the report's 186.5 minutes.")
    table = ["| samples | report, minutes | 1 thread | " + f"{threads} threads | mirror wall, {threads} threads |", "| --- | --- | --- | --- | --- |"]
    (args.folder / "report.md").write_text("\n".join(table + rows) + "\n\n" + note + "\n\n![times](times.svg)\n")
    print(note)


main()
