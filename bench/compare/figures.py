# SPDX-License-Identifier: Apache-2.0
"""Efficiencies from the runs of a scene, and the peer that is best in each."""
import math
import statistics

from explanations import explanation


def is_peer(name):
    return not name.startswith("fathom")


def efficiency(runs, key="relmse"):
    """1 / (relMSE x processor seconds): median of the runs with the full budget."""
    values = [1 / (run[key] * run["cpu_s"]) for run in runs if run["full"] and run[key] > 0]
    return statistics.median(values) if values else None


def counts(renderer, scene, references):
    """Whether a peer renders the same image, so that its efficiency can be compared."""
    comparison = references.get(renderer)
    if comparison is None:
        return False
    known = explanation(renderer, scene)
    return comparison["verdict"] != "different" or bool(known and known["counts"])


def best_peer(result, key="relmse"):
    """The most efficient peer that counts, and Fathom's efficiency over its; None where there is none."""
    own = efficiency(result["runs"].get("fathom", []), key)
    peers = {name: efficiency(runs, key) for name, runs in result["runs"].items()
             if is_peer(name) and counts(name, result["scene"], result["references"])}
    peers = {name: value for name, value in peers.items() if value}
    if not own or not peers:
        return None
    name = max(peers, key=peers.get)
    return name, own / peers[name]


def ratios(result, key="relmse"):
    """Fathom's efficiency over that of each peer."""
    own = efficiency(result["runs"].get("fathom", []), key)
    values = {name: efficiency(runs, key) for name, runs in result["runs"].items() if name != "fathom"}
    return {name: own / value for name, value in values.items() if own and value}


def geometric_mean(values):
    return math.exp(sum(map(math.log, values)) / len(values)) if values else float("nan")
