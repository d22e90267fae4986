# SPDX-License-Identifier: Apache-2.0
"""Graphs of the error over time."""
import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402


def error_over_time(result, path):
    """One line for each renderer, with all errors (solid) and without the largest (dashed); both axes are logarithmic."""
    figure, axes = plt.subplots(figsize=(7, 4.2))
    for name, runs in result["runs"].items():
        points = sorted((run["cpu_s"], run["relmse"], run["trimmed"]) for run in runs)
        if points:
            seconds, relmse, trimmed = zip(*points)
            line, = axes.plot(seconds, relmse, "o-", label=name, linewidth=2.5 if name == "fathom" else 1.2, markersize=3)
            axes.plot(seconds, trimmed, "--", color=line.get_color(), linewidth=1)
    axes.set(xscale="log", yscale="log", xlabel="processor seconds", ylabel="relMSE (dashed: without the largest 0.1 %)", title=result["scene"])
    axes.grid(True, which="both", alpha=0.25)
    axes.legend(fontsize=8)
    figure.savefig(path, bbox_inches="tight")
    plt.close(figure)
    return path
