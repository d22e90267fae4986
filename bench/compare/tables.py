# SPDX-License-Identifier: Apache-2.0
"""The tables of results: a title, a head and rows of text each."""
import statistics

import figures
import scenes
from explanations import explanation


def number(x):
    return "-" if x is None else f"{x:.3g}"


def summary_rows(results):
    """Scene, best peer, efficiency over it with all errors and without the largest, samples per pixel and seconds of Fathom."""
    rows = []
    for result in results:
        best, trimmed = figures.best_peer(result), figures.best_peer(result, "trimmed")
        runs = [run for run in result["runs"].get("fathom", []) if run["full"]]
        rows.append({"scene": result["scene"], "peer": best[0] if best else "none", "ratio": best[1] if best else None,
                     "trimmed_peer": trimmed[0] if trimmed else "none", "trimmed": trimmed[1] if trimmed else None,
                     "spp": runs[0]["spp"] if runs else None, "relmse": statistics.median(run["relmse"] for run in runs) if runs else None,
                     "cpu_s": statistics.median(run["cpu_s"] for run in runs) if runs else None})
    return rows


def groups(results):
    return {"all scenes": results, "caustics": [result for result in results if result["scene"] in scenes.CAUSTICS],
            "all other scenes": [result for result in results if result["scene"] not in scenes.CAUSTICS]}


def mean_rows(results):
    """Geometric mean and least of each group."""
    rows = []
    for name, members in groups(results).items():
        for key, text in (("relmse", "all errors"), ("trimmed", "without the largest 0.1 %")):
            values = [best[1] for best in (figures.best_peer(result, key) for result in members) if best]
            if values:
                rows.append([name, text, str(len(values)), number(figures.geometric_mean(values)), number(min(values)),
                             str(sum(value < 1 for value in values))])
    return rows


def summary_table(results):
    head = ["scene", "best peer", "efficiency over it", "best peer, trimmed", "efficiency, trimmed", "samples", "relMSE", "processor s"]
    return head, [[row["scene"], row["peer"], number(row["ratio"]), row["trimmed_peer"], number(row["trimmed"]), number(row["spp"]),
                   number(row["relmse"]), number(row["cpu_s"])] for row in summary_rows(results)]


def peer_table(results):
    """Fathom's efficiency over that of every peer; those whose image differs are in parentheses."""
    names = [name for name in figures_names(results) if name != "fathom"]
    rows = []
    for result in results:
        all_errors, trimmed = figures.ratios(result), figures.ratios(result, "trimmed")
        cells = []
        for name in names:
            text = f"{number(all_errors[name])} / {number(trimmed.get(name))}" if name in all_errors else ""
            cells.append(text if not text or figures.counts(name, result["scene"], result["references"]) else f"({text})")
        rows.append([result["scene"], *cells])
    return ["scene", *names], rows


def figures_names(results):
    seen = [name for result in results for name in result["runs"]]
    return sorted(set(seen), key=seen.index)


def reference_table(results):
    """Every comparison of references that isn't equal, or was explained."""
    rows = []
    for result in results:
        for renderer, comparison in result["references"].items():
            known = explanation(renderer, result["scene"])
            text = known["text"] if known else ("not explained" if comparison["verdict"] == "different" else "")
            if comparison["verdict"] == "equal":
                continue
            rows.append([result["scene"], renderer, comparison["verdict"], f"{100 * (comparison['mean_ratio'] - 1):+.2f} %",
                         f"{100 * comparison['mean_error']:.2f} %", f"{100 * comparison['block_difference']:+.1f} %",
                         f"{100 * comparison['block_error']:.1f} %", text])
    return ["scene", "renderer", "verdict", "mean", "its error", "largest block", "its error", "explanation"], rows


def equal_references(results):
    verdicts = [comparison["verdict"] for result in results for comparison in result["references"].values()]
    return verdicts.count("equal"), len(verdicts)


def notes_table(results):
    return ["scene", "renderer", "note"], [[result["scene"], renderer, note] for result in results for renderer, note in result["notes"].items()]


def worse(results):
    """Peers that are better than Fathom, by the larger advantage."""
    return sorted(((1 / row["ratio"], row["scene"], row["peer"]) for row in summary_rows(results) if row["ratio"] and row["ratio"] < 1), reverse=True)


def tables(results):
    equal, compared = equal_references(results)
    return [("Where a peer is better", ["scene", "peer", "its efficiency over Fathom's"],
             [[scene, peer, number(ratio)] for ratio, scene, peer in worse(results)]),
            ("Means of Fathom's efficiency over the best peer", ["scenes", "errors", "number", "geometric mean", "least", "peer is better"],
             mean_rows(results)),
            ("Fathom's efficiency over the best peer", *summary_table(results)),
            ("Fathom's efficiency over each peer, all errors / without the largest 0.1 %", *peer_table(results)),
            (f"References: {equal} of {compared} equal Fathom's; the others", *reference_table(results)),
            ("Not rendered", *notes_table(results))]


def markdown(head, rows):
    lines = [head, ["---"] * len(head), *rows]
    return "\n".join("| " + " | ".join(str(cell).replace("|", "/") for cell in line) + " |" for line in lines) + "\n"
