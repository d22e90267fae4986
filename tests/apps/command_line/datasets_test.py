#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Tests of the command line: data sets and lists of models."""
import json
import os
import random
import signal
import subprocess
from pathlib import Path

from harness import CommandLine, DOUBLE, Gate, PROGRAM, png_size, run_tests

ROOT = Path(__file__).resolve().parents[3]
WORDS = ("--views", "2", "--spp", "1", "--size", "16x12", "--dataset", "nerf")


def decoded(counts, height, width):
    """The mask of COCO's compressed run lengths, by columns."""
    runs, at = [], 0
    while at < len(counts):
        number, shift, more = 0, 0, True
        while more:
            code = ord(counts[at]) - 48
            number |= (code & 0x1f) << shift
            more, shift, at = bool(code & 0x20), shift + 5, at + 1
        if code & 0x10:
            number -= 1 << shift
        runs.append(number + (runs[-2] if len(runs) > 2 else 0))
    mask = [i % 2 for i, run in enumerate(runs) for _ in range(run)]
    assert len(mask) == width * height, (len(mask), width, height)
    return mask


class Datasets(CommandLine):
    def models(self, **texts):
        """Writes scenes and a list of them; returns the options that render the list to the folder `out`."""
        for name, text in texts.items():
            self.scene(name + ".json", text)
        Path(self.path("list.txt")).write_text("# all models\n\n" + "".join(f"{name}.json\n" for name in texts))
        return "render", "--models", "list.txt", *WORDS, "-o", "out"

    def log(self, name="log.jsonl"):
        return [json.loads(line) for line in self.read("out/" + name).splitlines()]

    def statuses(self, name="log.jsonl"):
        """The last status of each model."""
        return {entry["name"]: entry["status"] for entry in self.log(name)}

    def test_views_without_dataset(self):
        self.ok("render", "box.json", "--views", "3", "--spp", "1", "-o", "a.##.png", "-o", "{name}-{view}.png")
        for i in range(3):
            self.assertTrue(os.path.exists(self.path(f"a.0{i}.png")))
            self.assertTrue(os.path.exists(self.path(f"box-000{i}.png")))

    def test_folder_of_one_model(self):
        self.ok("render", "box.json", *WORDS, "-o", "out/")
        self.assertEqual(sorted(os.listdir(self.path("out"))),
                         ["dataset.json", "train", "transforms_test.json", "transforms_train.json", "transforms_val.json"])
        self.assertEqual(png_size(self.path("out/train/r_0.png")), (16, 12, 8, 6))
        self.assertFalse(os.path.exists(self.path("out.partial")))
        self.assertIn("complete already", self.ok("render", "box.json", *WORDS, "-o", "out/").stderr)
        self.refused(1, "render", "box.json", *WORDS, "--seed", "7", "-o", "out", words=["other settings", "out"])
        os.mkdir(self.path("other"))
        Path(self.path("other/precious")).touch()
        self.refused(1, "render", "box.json", *WORDS, "-o", "other", words=["other files"])
        self.assertTrue(os.path.exists(self.path("other/precious")))

    def test_layers_in_exr(self):
        self.ok("render", "box.json", *WORDS, "--ground-truth", "depth", "-o", "out")
        self.assertEqual(sorted(os.listdir(self.path("out/exr"))), ["000000.exr", "000001.exr"])
        self.assertIn(b"truth.depth.Z", self.read("out/exr/000001.exr"))

    def test_list_goes_on_after_failures(self):
        words = self.models(a="camera a", b="camera b hint-build bogus", c="camera c")
        with open(self.path("list.txt"), "a") as file:
            file.write("missing.json\n")
        result = self.run_program(*words)
        self.assertEqual(result.returncode, 1, result.stderr)
        self.assertIn("2 of 4 models rendered; 2 failed", result.stderr)
        self.assertEqual(self.statuses(), {"a": "done", "b": "failed", "c": "done", "missing": "failed"})
        errors = {entry["name"]: entry["error"] for entry in self.log() if entry["status"] == "failed"}
        self.assertIn("bogus", errors["b"])
        self.assertIn("there is no such file", errors["missing"])
        self.assertEqual(sorted(os.listdir(self.path("out"))), ["a", "c", "log.jsonl"])
        # The next run renders what is missing only.
        self.scene("b.json", "camera b")
        before = os.stat(self.path("out/a/dataset.json")).st_mtime_ns
        result = self.run_program(*words)
        self.assertIn("2 of 4 models are complete already", result.stderr)
        self.assertEqual(self.statuses(), {"a": "done", "b": "done", "c": "done", "missing": "failed"})
        self.assertEqual(os.stat(self.path("out/a/dataset.json")).st_mtime_ns, before)

    def test_coco_run_lengths(self):
        if not PROGRAM:
            self.skipTest("the program is not built")
        self.ok("render", str(ROOT / "scenes/models/chess.glb"), "--views", "2", "--size", "60x40", "--spp", "1", "--dataset", "coco",
                "-o", "out", program=PROGRAM)
        annotations = json.loads(self.read("out/annotations.json"))["annotations"]
        self.assertGreater(len(annotations), 10)
        for a in annotations:
            for prefix in ("", "whole_"):
                mask = decoded(a[prefix + "segmentation"]["counts"], *a[prefix + "segmentation"]["size"])
                self.assertEqual(sum(mask), a[prefix + "area"])
                x = [i // 40 for i, value in enumerate(mask) if value]
                y = [i % 40 for i, value in enumerate(mask) if value]
                self.assertEqual(a[prefix + "bbox"], [min(x), min(y), max(x) - min(x) + 1, max(y) - min(y) + 1])
        self.assertGreater(sum(a["whole_area"] > a["area"] for a in annotations), 0)

    def test_damaged_models(self):
        """Truncated and changed GLB files fail, and cost none of the others."""
        if not PROGRAM:
            self.skipTest("the program is not built")
        data, chance, names = (ROOT / "scenes/models/chess.glb").read_bytes(), random.Random(1), []
        for i in range(24):
            bad = bytearray(data[:chance.randrange(len(data))] if i % 2 else data)
            for _ in range(0 if i % 4 == 1 else 40):
                bad[chance.randrange(min(len(bad), 2000))] = chance.randrange(256)
            Path(self.path(f"bad{i}.glb")).write_bytes(bytes(bad) if i % 3 else b"")
            names.append(f"bad{i}")
            if i % 4 == 0:
                Path(self.path(f"good{i}.glb")).write_bytes(data)
                names.append(f"good{i}")
        Path(self.path("list.txt")).write_text("".join(f"{name}.glb\n" for name in names))
        result = self.run_program("render", "--models", "list.txt", *WORDS, "-o", "out", program=PROGRAM)
        self.assertEqual(result.returncode, 1, result.stderr)
        statuses = self.statuses()
        self.assertEqual(set(statuses), set(names))
        for name in names:
            if name.startswith("good"):
                self.assertEqual(statuses[name], "done")
        self.assertGreater(list(statuses.values()).count("failed"), 12)
        done = {name for name, status in statuses.items() if status == "done"}
        self.assertEqual({name for name in os.listdir(self.path("out")) if "." not in name}, done)

    def test_parts(self):
        words = self.models(**{name: f"camera {name}" for name in "abcde"})
        self.ok(*words, "--part", "1/2")
        self.assertEqual(self.statuses("log-1-of-2.jsonl"), {name: "done" for name in "ace"})
        self.ok(*words, "--part", "2/2")
        self.assertEqual(self.statuses("log-2-of-2.jsonl"), {name: "done" for name in "bd"})
        self.assertEqual({name for name in os.listdir(self.path("out")) if "." not in name}, set("abcde"))

    def test_names(self):
        """Files of one name are told apart by their folders; more equal names are an error."""
        for folder in ("x", "y", "z/x"):
            os.makedirs(self.path(folder))
            self.scene(folder + "/scene.json", "camera a")
        Path(self.path("list.txt")).write_text("x/scene.json\ny/scene.json\n")
        self.ok("render", "--models", "list.txt", *WORDS, "-o", "out")
        self.assertEqual(set(self.statuses()), {"x-scene", "y-scene"})
        Path(self.path("list.txt")).write_text("x/scene.json\nz/x/scene.json\n")
        self.refused(1, "render", "--models", "list.txt", *WORDS, "-o", "out2", words=["x/scene.json", "x-scene"])
        Path(self.path("list.txt")).write_text("# none\n")
        self.refused(1, "render", "--models", "list.txt", *WORDS, "-o", "out2", words=["list.txt", "no model"])
        self.refused(1, "render", "--models", "nowhere.txt", *WORDS, "-o", "out2", words=["nowhere.txt"])

    def test_next_model_loads_meanwhile(self):
        """The second model is read while the first one renders."""
        rendering, loading = Gate(self), Gate(self)
        words = self.models(a=f"camera a gate {rendering.path}", b=f"camera b load-gate {loading.path}")
        process = subprocess.Popen([DOUBLE, *words], cwd=self.folder, stderr=subprocess.PIPE, text=True)
        self.end_at_the_end(process)
        rendering.wait(process, 0)
        loading.wait(process, 0)
        rendering.allow(), loading.allow()
        self.assertEqual(process.wait(), 0)
        self.assertEqual(self.statuses(), {"a": "done", "b": "done"})

    def test_interrupt(self):
        """An interrupt ends the list; the next run goes on with the unfinished model."""
        gate = Gate(self)
        words = self.models(a=f"camera a gate {gate.path}", b="camera b", c="camera c")
        process = subprocess.Popen([DOUBLE, *words], cwd=self.folder, stderr=subprocess.PIPE, text=True)
        self.end_at_the_end(process)
        gate.wait(process, 0)
        process.send_signal(signal.SIGINT)
        self.read_until(process, "interrupted")
        gate.allow()
        self.assertEqual(process.wait(), 130)
        self.assertEqual(self.statuses(), {"a": "interrupted", "b": "interrupted"})
        self.assertEqual(os.listdir(self.path("out")), ["log.jsonl"], "an unfinished folder was left")
        for _ in range(3):
            # Models that were interrupted are not suspected of ending the process.
            self.ok(*words)
            self.assertEqual(self.statuses(), {"a": "done", "b": "done", "c": "done"})

    def test_models_that_end_the_process(self):
        """A model that kills the process is tried once more, after all others and alone, and then left out."""
        gate = Gate(self)
        words = self.models(a="camera a", b=f"camera b load-gate {gate.path}", c="camera c")
        for run in range(2):
            process = subprocess.Popen([DOUBLE, *words], cwd=self.folder, stderr=subprocess.PIPE, text=True)
            self.end_at_the_end(process)
            gate.wait(process, 0)
            if run == 1:
                self.read_until(process, "c (")
            process.kill()
            process.wait()
            os.remove(gate.path + ".waits")
        result = self.run_program(*words)
        self.assertEqual(result.returncode, 1, result.stderr)
        self.assertEqual(self.statuses(), {"a": "done", "b": "failed", "c": "done"})
        self.assertIn("ended twice", result.stderr)
        self.assertIn("ended twice", self.run_program(*words).stderr)

    def test_wrong_options(self):
        def wrong(*arguments, words):
            self.refused(2, "render", *arguments, words=words)
        wrong(words=["SCENE is required"])
        wrong("box.json", "--views", "3", "-o", "a.png", words=["a.png", "####"])
        wrong("box.json", "--dataset", "nerf", "--views", "3", words=["--dataset", "-o FOLDER"])
        wrong("box.json", "--dataset", "nerf", "-o", "out", words=["--views N", "--cameras", "--frames"])
        wrong("box.json", "--dataset", "blender", "--views", "3", "-o", "out", words=["nerfstudio", "blender"])
        wrong("box.json", "--models", "list.txt", *WORDS, "-o", "out", words=["--models", "box.json"])
        wrong("--models", "list.txt", "--views", "3", "-o", "a##.png", words=["--models", "--dataset"])
        wrong("box.json", *WORDS, "-o", "out", "--part", "1/2", words=["--part", "--models"])
        wrong("box.json", *WORDS, "-o", "out", "--time", "10", words=["--time", "--spp"])
        wrong("box.json", *WORDS, "-o", "out", "--turntable", "3", words=["--turntable"])
        wrong("box.json", *WORDS, "-o", "out", "--camera", "side", words=["--camera"])
        wrong("box.json", *WORDS, "-o", "-", words=["folder"])
        wrong("box.json", *WORDS, "-o", "out", "--output-format", "png", words=["--output-format"])
        wrong("box.json", "--on", "ring", words=["--on", "--views"])
        wrong("box.json", "--ground-truth", "flow", "-o", "a.exr", words=["flow", "--dataset"])
        wrong("box.json", "--ground-truth", "depth", "-o", "a.png", words=["--ground-truth", ".exr"])
        wrong("box.json", "--ground-truth", "depht", "-o", "a.exr", words=["--ground-truth", "depht"])

    def test_wrong_camera_files(self):
        matrix = [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 3], [0, 0, 0, 1]]
        good = {"camera_angle_x": 0.7, "frames": [{"file_path": "a", "transform_matrix": matrix}]}
        def wrong(change, *words):
            Path(self.path("cameras.json")).write_text(change if isinstance(change, str) else json.dumps({**good, **change}))
            self.refused(1, "render", "box.json", "--cameras", "cameras.json", "--dataset", "npz", "-o", "out",
                         words=["cameras.json", *words])
        wrong("{", "JSON")
        wrong("[]", "frames")
        wrong({"frames": []}, "frames", "empty")
        wrong({"frames": [3]}, "frames[0]", "object")
        wrong({"frames": [{}]}, "frames[0]", "transform_matrix")
        wrong({"frames": [{"transform_matrix": [[1, 2], [3, 4]]}]}, "frames[0].transform_matrix", "4x4")
        wrong({"frames": [{"transform_matrix": [[0] * 4] * 4}]}, "frames[0].transform_matrix", "rotation")
        wrong({"camera_angle_x": "wide"}, "camera_angle_x", "number")
        wrong({"camera_angle_x": 4}, "angle of view")
        wrong({"frames": [{"transform_matrix": matrix}], "camera_angle_x": None}, "camera_angle_x")
        wrong({"k1": 0.1}, "k1", "distortion")
        wrong({"fl_x": 100, "fl_y": 120, "w": 64, "h": 48}, "square")
        Path(self.path("cameras.json")).write_text(json.dumps({**good, "w": 24, "h": 10}))
        self.ok("render", "box.json", "--cameras", "cameras.json", "--spp", "1", "--dataset", "nerf", "-o", "out")
        self.assertEqual(png_size(self.path("out/train/r_0.png"))[:2], (24, 10))


if __name__ == "__main__":
    run_tests()
