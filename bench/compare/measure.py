# SPDX-License-Identifier: Apache-2.0
"""Measures one scene: long references first, then images of several budgets, in turns."""
import math
import sys

import numpy as np

import environments
import errors
import images
import neutral
import renderers
import scenes

REFERENCE_SEED = 1000


def source_of(name, options):
    """The folder of a generated scene, or the file of a room; None where the file is missing."""
    if name in scenes.GENERATED:
        folder = options.out / "scenes" / name
        made = scenes.make(name)
        made["size"] = scaled(made["size"], options)
        neutral.save(made, folder)
        return folder, made["size"], made.get("region")
    return scenes.rooms.file(name, options.rooms), scaled(scenes.rooms.SIZE, options), None


def scaled(size, options):
    return [max(16, round(side * options.scale)) for side in size]


def is_candidate(renderer, scene):
    """Renderers for caustics render only those scenes."""
    return scene in scenes.CAUSTICS or renderer not in renderers.CAUSTIC_ONLY


def opened(name, source, size, options, folder, notes):
    """The renderers that can render a scene; the reasons of the others go to notes."""
    result = {}
    for renderer in options.renderers:
        if not is_candidate(renderer, name):
            continue
        try:
            result[renderer] = renderers.open_renderer(renderer, source, size, options, folder)
        except (renderers.Unsupported, renderers.Failed, environments.Missing) as error:
            notes[renderer] = str(error)
            print(f"{name}: {error}", file=sys.stderr, flush=True)
    return result


def samples_for(render, cpu_s):
    """The power of two of samples per pixel that comes closest to a processor time."""
    spp = 4
    while True:
        spent = render(spp, 1)[2]
        if spent > cpu_s / 8 or spp >= 4096:
            return max(2, 2 ** round(math.log2(spp * cpu_s / spent)))
        spp *= 4


def region_of(image, region):
    """The part of an image that is compared. region: fractions of the width and height from the top left corner."""
    image = image[:-1]  # LuxCore's last row is wrong.
    if not region:
        return image
    height, width = image.shape[:2]
    return image[int(region[1] * height):int(region[3] * height), int(region[0] * width):int(region[2] * width)]


class Measurement:
    def __init__(self, name, active, region, options, notes):
        self.name, self.active, self.region, self.options, self.notes = name, active, region, options, notes
        self.spp, self.references, self.runs = {}, {}, {renderer: [] for renderer in active}

    def attempt(self, renderer, action):
        """Runs an action of a renderer; a renderer that fails is dropped with a note."""
        try:
            return action()
        except (renderers.Failed, OSError) as error:
            self.notes[renderer] = str(error)
            print(f"{self.name}: {error}", file=sys.stderr, flush=True)
            self.active.pop(renderer)
            return None

    def say(self, text):
        print(f"{self.name}: {text}", file=sys.stderr, flush=True)

    def choose_samples(self):
        for renderer, program in list(self.active.items()):
            spp = self.attempt(renderer, lambda: samples_for(program.render, 2 * self.options.seconds))
            if spp:
                self.spp[renderer] = spp

    def render_references(self):
        """Two halves of each reference, in turns."""
        halves = {renderer: [] for renderer in self.active}
        for half in range(2):
            for renderer, program in list(self.active.items()):
                count = max(2, self.spp[renderer] * self.options.reference_factor // 2)
                made = self.attempt(renderer, lambda: program.render(count, REFERENCE_SEED + half))
                if made:
                    halves[renderer].append(made[0])
                    self.say(f"half a reference by {renderer}, {count} samples, {made[2]:.1f} s")
        self.references = {renderer: pair for renderer, pair in halves.items() if len(pair) == 2}

    def measure(self):
        """Images of a sixteenth, a quarter and all of the budget; of all, several rounds."""
        plan = [(16, 1)] + [(4, 1)] + [(1, self.options.rounds)]
        for divisor, rounds in plan:
            for round in range(rounds):
                for renderer, program in list(self.active.items()):
                    spp = max(2, self.spp[renderer] // divisor)
                    made = self.attempt(renderer, lambda: program.render(spp, 1 + round))
                    if made:
                        self.add_run(renderer, spp, divisor, *made)

    def add_run(self, renderer, spp, divisor, image, wall, cpu):
        reference = np.mean(self.references[renderer], 0)
        relmse, trimmed = errors.relmse(region_of(image, self.region), region_of(reference, self.region))
        self.runs[renderer].append({"spp": spp, "full": divisor == 1, "wall_s": wall, "cpu_s": cpu, "relmse": relmse, "trimmed": trimmed})
        self.say(f"{renderer}, {spp} samples, {cpu:.2f} s, relMSE {relmse:.3g} ({trimmed:.3g})")
        if divisor == 1:
            images.write_png(self.options.out / "images" / f"{self.name}-{renderer}.png", image, reference)

    def compare_references(self):
        if "fathom" not in self.references:
            return {}
        cut = {renderer: [region_of(half, self.region) for half in pair] for renderer, pair in self.references.items()}
        own = cut["fathom"]
        result = {}
        for renderer, pair in cut.items():
            if renderer != "fathom":
                comparison = errors.compare_references(np.mean(pair, 0), pair, np.mean(own, 0), own)
                result[renderer] = {**comparison, "verdict": errors.verdict(comparison)}
                self.say(f"reference of {renderer}: {result[renderer]}")
        for renderer, pair in self.references.items():
            reference = np.mean(pair, 0)
            images.write_png(self.options.out / "images" / f"{self.name}-{renderer}-reference.png", reference, reference)
            np.save(self.options.out / "images" / f"{self.name}-{renderer}-reference.npy", reference.astype(np.float32))
        return result


def measure(name, options):
    """Figures of a scene for the page, or None if its file is missing."""
    source, size, region = source_of(name, options)
    if source is None:
        print(f"{name}: skipped, {scenes.rooms.NAMES[name]} is missing in {options.rooms}", file=sys.stderr)
        return None
    folder = options.out / "temporary"
    folder.mkdir(parents=True, exist_ok=True)
    (options.out / "images").mkdir(exist_ok=True)
    notes = {}
    active = opened(name, source, size, options, folder, notes)
    measurement = Measurement(name, active, region, options, notes)
    try:
        measurement.choose_samples()
        measurement.render_references()
        compared = measurement.compare_references()
        measurement.measure()
    finally:
        for program in active.values():
            program.close()
    return {"scene": name, "size": size, "seconds": options.seconds, "reference_factor": options.reference_factor, "rounds": options.rounds,
            "threads": options.threads, "notes": notes, "references": compared,
            "means": {renderer: float(np.mean(pair)) for renderer, pair in measurement.references.items()}, "runs": measurement.runs}
