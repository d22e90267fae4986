#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Tests bench/compare: error measures, meshes, the choice of the best peer, and exporters. What it writes for pbrt and Mitsuba
is rendered by Fathom's own importers, and must give the image of Fathom's version.

compare_test.py PROGRAM; skipped (77) without NumPy
"""
import json
import os
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

try:
    import numpy as np
except ImportError as error:
    print(f"skipped: {error}")
    sys.exit(77)

HERE = Path(__file__).resolve()
COMPARE = HERE.parents[2] / "bench/compare"
sys.path[:0] = [str(COMPARE), str(HERE.parents[1] / "support")]
import errors  # noqa: E402
import figures  # noqa: E402
import mitsuba_xml  # noqa: E402
import neutral  # noqa: E402
import scenes  # noqa: E402
import tables  # noqa: E402
import waiting  # noqa: E402
from exporters import cycles, fathom, luxcore, mitsuba, pbrt  # noqa: E402

PROGRAM = os.path.abspath(sys.argv[1])
del sys.argv[1]


class Errors(unittest.TestCase):
    def test_relmse_by_hand(self):
        reference = np.full((1, 2, 3), 0.12)
        reference[0, 1] = 0.36  # the mean is 0.24, so that the floor is 0.01 * 2 * 2
        image = reference + 0.1
        expected = (0.01 / (0.12**2 + 0.04) + 0.01 / (0.36**2 + 0.04)) / 2
        self.assertAlmostEqual(errors.relmse(image, reference)[0], expected)

    def test_relmse_does_not_depend_on_the_scale(self):
        rng = np.random.default_rng(1)
        image, reference = rng.random((8, 8, 3)), rng.random((8, 8, 3))
        self.assertAlmostEqual(errors.relmse(image, reference)[0], errors.relmse(50 * image, 50 * reference)[0])

    def test_the_trimmed_error_leaves_a_thousandth_out(self):
        reference = np.ones((20, 50, 1))
        image = reference + 0.1
        image[3, 4] = 1000
        all_errors, trimmed = errors.relmse(image, reference)
        self.assertGreater(all_errors, 100)
        self.assertAlmostEqual(trimmed, 0.01 / (1 + 0.01 / 0.12**2))

    def compared(self, change, sigma=0.01):
        rng = np.random.default_rng(2)
        noisy = lambda image: image + sigma * rng.normal(size=image.shape)
        reference = 0.5 + np.zeros((64, 64, 3))
        one, two = ([noisy(image) for _ in range(2)] for image in (change(reference.copy()), reference))
        return errors.verdict(errors.compare_references(np.mean(one, 0), one, np.mean(two, 0), two))

    def test_verdicts_on_references(self):
        def block(image):
            image[8:16, 40:48] *= 1.1
            return image
        self.assertEqual(self.compared(lambda image: image), "equal")
        self.assertEqual(self.compared(lambda image: 1.007 * image), "equal")
        self.assertEqual(self.compared(lambda image: 1.02 * image), "different")
        self.assertEqual(self.compared(block), "different")

    def test_noise_is_no_difference(self):
        verdicts = {self.compared(lambda image: 1.02 * image, sigma=5)}
        self.assertNotIn("different", verdicts)


def result(references, seconds):
    runs = {name: [{"spp": 4, "full": False, "relmse": 9.0, "trimmed": 9.0, "cpu_s": 1.0},
                   {"spp": 16, "full": True, "relmse": 0.5, "trimmed": 0.25, "cpu_s": cpu}] for name, cpu in seconds.items()}
    return {"scene": "cornell", "runs": runs, "notes": {}, "references": {name: {
        "verdict": verdict, "mean_ratio": 1.5, "mean_error": 0.0, "block_difference": 0.5, "block_error": 0.0}
        for name, verdict in references.items()}}


class Figures(unittest.TestCase):
    def test_the_best_peer_renders_the_same_image(self):
        measured = result({"fast": "different", "good": "equal", "slow": "noisy"}, {"fathom": 1, "fast": 0.1, "good": 2, "slow": 4})
        self.assertEqual(figures.best_peer(measured), ("good", 2.0))
        self.assertEqual(figures.ratios(measured), {"fast": 0.1, "good": 2.0, "slow": 4.0})

    def test_no_peer(self):
        self.assertIsNone(figures.best_peer(result({"fast": "different"}, {"fathom": 1, "fast": 0.1})))

    def test_tables(self):
        measured = result({"good": "equal", "odd": "different"}, {"fathom": 4, "good": 2, "odd": 1})
        text = "\n".join(tables.markdown(head, rows) for _, head, rows in tables.tables([measured]))
        self.assertIn("| cornell | good | 2 |", text)  # a peer that is better
        self.assertIn("| cornell | 0.5 / 0.5 | (0.25 / 0.25) |", text)
        self.assertIn("| cornell | odd | different | +50.00 % |", text)


class Shapes(unittest.TestCase):
    def test_solids_are_closed_and_face_outwards(self):
        for name in ("caustic-ball-area", "caustic-glass-area", "subsurface", "fog", "metals"):
            for mesh_name, mesh in scenes.make(name)["meshes"].items():
                with self.subTest(name=name, mesh=mesh_name):
                    self.check_solid(mesh)

    def check_solid(self, mesh):
        positions = np.round(mesh["positions"].astype(float), 6)
        _, welded = np.unique(positions, axis=0, return_inverse=True)
        triangles = welded.ravel()[mesh["triangles"]]
        triangles = triangles[(triangles != np.roll(triangles, 1, axis=1)).all(axis=1)]
        edges = np.vstack([triangles[:, [i, (i + 1) % 3]] for i in range(3)])
        self.assertEqual(len(np.unique(edges, axis=0)), len(edges))
        self.assertTrue(np.array_equal(np.unique(edges, axis=0), np.unique(edges[:, ::-1], axis=0)))
        a, b, c = (mesh["positions"].astype(float)[mesh["triangles"][:, i]] for i in range(3))
        self.assertGreater((a * np.cross(b, c)).sum(), 0)  # six times the volume
        if mesh["normals"] is not None:
            facing = (np.cross(b - a, c - a) * mesh["normals"][mesh["triangles"][:, 0]]).sum(-1)
            self.assertGreater(facing.min(), 0)

    def test_all_scenes_are_made(self):
        for name in scenes.GENERATED:
            made = scenes.make(name)
            used = {item["material"] for item in made["objects"] if "material" in item}
            self.assertLessEqual(used, made["materials"].keys(), name)


class Peers(unittest.TestCase):
    def test_cycles_has_z_up(self):
        self.assertEqual(cycles.z_up([1, 2, 3]).tolist(), [1, -3, 2])

    def test_curves_of_cycles_lie_on_the_spline(self):
        curves = np.random.default_rng(3).random((2, 6, 4))
        points = cycles.subdivided(curves, steps=2)
        self.assertEqual(points.shape, (2, 7, 4))
        knot = lambda i: (curves[:, i] + 4 * curves[:, i + 1] + curves[:, i + 2]) / 6
        middle = (curves[:, 1] + 23 * curves[:, 2] + 23 * curves[:, 3] + curves[:, 4]) / 48
        for index, expected in ((0, knot(0)), (2, knot(1)), (3, middle), (6, knot(3))):
            np.testing.assert_allclose(points[:, index], expected)

    def test_luxcore(self):
        scene = scenes.make("caustic-ball-point")
        rows = luxcore.properties(scene)
        self.assertAlmostEqual(rows["scene.lights.light0.color"][0], 40 * 4 * np.pi)
        tangent = np.tan(np.radians(rows["scene.camera.fieldofview"] / 2)) * 3 / 4
        self.assertAlmostEqual(2 * np.degrees(np.arctan(tangent)), scene["camera"]["fov_y_deg"])
        self.assertIsNone(luxcore.unsupported(scene))
        self.assertIn("hair", luxcore.unsupported(scenes.make("hair")))


class Imported(unittest.TestCase):
    """Fathom renders its own version of a scene and those of others."""

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)

    def render(self, scene, name):
        out = self.folder / f"{name}.exr"
        done = waiting.run([PROGRAM, "render", str(scene), "--size", "48x36", "--spp", "64", "--filter", "box", "--mergeable", "-q", "-o", str(out)])
        self.assertEqual(done.returncode, 0, done.stderr)
        return str(out)

    def difference(self, name, write):
        """What `fathom diff` reports on Fathom's image and another version's."""
        scene = scenes.make(name)
        if name == "fog":  # thick and forward, so that the image shows the phase function
            scene["materials"]["fog"] |= {"sigma_s": [1.0, 0.8, 0.6], "g": 0.8}
        neutral.save(scene, self.folder)
        made = neutral.load(self.folder)
        own, other = self.render(fathom.write(made, self.folder), "own"), self.render(write(made, self.folder), "other")
        done = waiting.run([PROGRAM, "diff", other, own, "--json"])
        self.assertIn(done.returncode, (0, 1), done.stderr)
        return json.loads(done.stdout)

    def check(self, name, write):
        report = self.difference(name, write)
        self.assertTrue(report["same"] or report["noise"]["explains_differences"], report)

    def test_pbrt(self):
        for name in ("cornell-glossy", "metals", "fog", "caustic-ball-spot", "hair"):
            with self.subTest(name):
                self.check(name, pbrt.write)

    def test_mitsuba(self):
        for name in ("cornell-glossy", "metals", "environment", "fog", "caustic-ball-spot", "hair"):
            with self.subTest(name):
                self.check(name, lambda scene, folder: mitsuba_xml.write(mitsuba.build(mitsuba_xml, scene, folder, "path"), folder / "scene.xml"))


class Protocol(unittest.TestCase):
    def test_a_renderer_process_answers(self):
        script = ("import sys; sys.path[0] = sys.argv[1]\nfrom runners import serve\nimport numpy as np\nstream = serve.answers()\n"
                  "print('noise of a renderer')\n"
                  "serve.serve(stream, lambda spp, seed: (np.full((2, 3, 3), spp + seed), 1.5, 2.5))\n")
        with tempfile.TemporaryDirectory() as folder:
            out = Path(folder) / "image.npy"
            request = json.dumps({"spp": 4, "seed": 3, "out": str(out)}) + "\n"
            process = subprocess.Popen([sys.executable, "-c", script, str(COMPARE)], stdin=subprocess.PIPE, stdout=subprocess.PIPE,
                                       stderr=subprocess.PIPE, text=True)
            process.stdin.write(request)
            process.stdin.flush()
            printed, error = waiting.finish(process)
            lines = [json.loads(line) for line in printed.splitlines()]
            self.assertEqual(lines, [{"ready": True}, {"wall_s": 1.5, "cpu_s": 2.5}], error)
            self.assertEqual(np.load(out).mean(), 7)


if __name__ == "__main__":
    unittest.main()
