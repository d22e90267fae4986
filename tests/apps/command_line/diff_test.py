#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Tests of `fathom diff` and of `fathom render --reference`: numbers, exit codes, images, errors, noise and changes."""
import json
import os
import struct
import unittest

from harness import CommandLine, DOUBLE, PROGRAM, png_size, run_tests

SAME, DIFFERENT, TROUBLE, NOT_REFERENCE = 0, 1, 2, 4


def scene(gray=0.5):
    return json.dumps({"fathom": 1, "camera": {"position": [0, 0, 4], "look_at": [0, 0, 0]},
                       "environment": {"kind": "gradient", "top": [1, 1, 1], "bottom": [0.2, 0.1, 0.1]},
                       "materials": {"m": {"kind": "diffuse", "color": [gray, gray, gray]}},
                       "scene": [{"sphere": {"center": [0, 0, 0], "radius": 1.2}, "material": "m"}]})


def pfm(width, height, values):
    """An image of linear values, of which each pixel has three; lines from the top."""
    rows = [values[3 * width * y:3 * width * (y + 1)] for y in range(height)]
    return b"PF\n%d %d\n-1\n" % (width, height) + b"".join(struct.pack(f"<{3 * width}f", *row) for row in reversed(rows))


def png(width, height, pixels):
    """An 8-bit RGB image."""
    import zlib

    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
    lines = b"".join(b"\0" + bytes(pixels[3 * width * y:3 * width * (y + 1)]) for y in range(height))
    return (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0))
            + chunk(b"IDAT", zlib.compress(lines)) + chunk(b"IEND", b""))


class Diff(CommandLine):
    def write(self, name, data):
        with open(self.path(name), "wb") as file:
            file.write(data)

    def diff(self, *arguments):
        return self.run_program("diff", *arguments)

    def json(self, *arguments):
        return json.loads(self.diff(*arguments, "--json").stdout)

    def test_numbers_and_exit_codes(self):
        values = [0.5] * (3 * 6 * 4)
        self.write("a.pfm", pfm(6, 4, values))
        values[3 * (6 * 2 + 5) + 1] = 0.75
        self.write("b.pfm", pfm(6, 4, values))
        equal = self.diff("a.pfm", "a.pfm")
        self.assertEqual(equal.returncode, SAME, equal.stderr)
        self.assertIn("result             equal\n", equal.stdout)
        result = self.diff("a.pfm", "b.pfm")
        self.assertEqual(result.returncode, DIFFERENT, result.stderr)
        self.assertEqual(result.stderr, "")
        self.assertIn("different pixels   1 of 24 (4.17 %)\n", result.stdout)
        self.assertIn("largest difference 0.25 in G of pixel 5,2: 0.5, reference 0.75\n", result.stdout)
        self.assertIn("PSNR               28.12 dB, peak 0.75\n", result.stdout)
        self.assertIn("noise              not tested: ", result.stdout)
        numbers = self.json("a.pfm", "b.pfm")
        self.assertEqual((numbers["width"], numbers["height"], numbers["linear"], numbers["same"]), (6, 4, True, False))
        self.assertEqual((numbers["different_pixels"], numbers["invalid_pixels"]), (1, 0))
        self.assertEqual(numbers["largest"], {"difference": 0.25, "x": 5, "y": 2, "channel": "G", "value": 0.5, "reference": 0.75})
        self.assertAlmostEqual(numbers["mse"], 0.25**2 / 72)
        self.assertAlmostEqual(numbers["relmse"], 0.25**2 / (0.75**2 + 0.01) / 72)
        self.assertTrue(0 < numbers["flip"]["mean"] < numbers["flip"]["max"] <= 1)
        self.assertNotIn("noise", numbers)
        self.assertIsNone(self.json("a.pfm", "a.pfm")["psnr_db"])

    def test_tolerance(self):
        self.write("a.png", png(2, 1, [10, 20, 30, 40, 50, 60]))
        self.write("b.png", png(2, 1, [10, 20, 30, 40, 51, 60]))
        self.assertEqual(self.diff("a.png", "b.png").returncode, DIFFERENT)
        self.assertEqual(self.diff("a.png", "b.png", "--tolerance", "0.0039").returncode, DIFFERENT)
        result = self.diff("a.png", "b.png", "--tolerance", "0.004")
        self.assertEqual(result.returncode, SAME)
        self.assertIn("the same within 0.004", result.stdout)
        self.assertEqual(self.diff("a.png", "b.png", "--tolerance", "0.004", "-q").stdout, "")

    def test_values_that_are_not_numbers(self):
        nan = float("nan")
        self.write("a.pfm", pfm(2, 1, [nan, 1, 1, 1, 1, 1]))
        self.write("b.pfm", pfm(2, 1, [1, 1, 1, 1, 1, 1]))
        self.assertEqual(self.diff("a.pfm", "a.pfm").returncode, SAME)
        result = self.diff("a.pfm", "b.pfm", "--tolerance", "100")
        self.assertEqual(result.returncode, DIFFERENT)
        self.assertIn("largest difference inf in R of pixel 0,0: nan, reference 1\n", result.stdout)
        self.assertIn("NaN or infinite    1 pixels: left out of the means\n", result.stdout)
        self.assertIsNone(self.json("a.pfm", "b.pfm")["largest"]["difference"])

    def test_errors(self):
        self.write("a.pfm", pfm(2, 1, [1] * 6))
        self.write("b.pfm", pfm(1, 2, [1] * 6))
        self.write("a.png", png(2, 1, [1] * 6))
        self.write("damaged.png", png(2, 1, [1] * 6)[:60])
        for words, arguments in ((["a.pfm: the image is 2x1, but b.pfm is 1x2"], ["a.pfm", "b.pfm"]),
                                 (["a.pfm: the image is linear radiance, but a.png is tone mapped"], ["a.pfm", "a.png"]),
                                 (["no.png: there is no such file"], ["a.png", "no.png"]),
                                 (["damaged.png: "], ["a.png", "damaged.png"]),
                                 (["box.json: "], ["box.json", "a.png"]),
                                 (["it has no layer 'depth'"], ["a.pfm", "a.pfm", "--layer", "depth"]),
                                 (["--allow-noise: noise can't be tested: only EXR"], ["a.png", "a.png", "--allow-noise"]),
                                 (["--tolerance: "], ["a.pfm", "a.pfm", "--tolerance", "-1"]),
                                 (["REFERENCE is required"], ["a.pfm"]),
                                 (["a.png is an image to be compared: choose another file"], ["a.png", "a.png", "-o", "a.png"]),
                                 (["no/d.png"], ["a.png", "a.png", "-o", "no/d.png"]),
                                 (["d.bmp"], ["a.png", "a.png", "-o", "d.bmp"])):
            self.refused(TROUBLE, "diff", *arguments, words=words)

    def test_standard_output_that_is_full(self):
        self.write("a.png", png(2, 1, [1] * 6))
        with open("/dev/full", "w") as full:
            self.assertEqual(self.run_program("diff", "a.png", "a.png", stdout=full).returncode, TROUBLE)

    def test_picture(self):
        self.write("a.png", png(300, 200, [100] * (3 * 300 * 200)))
        self.write("b.png", png(300, 200, [100] * (3 * 300 * 199) + [200] * (3 * 300)))
        self.assertEqual(self.diff("a.png", "b.png", "-o", "d.png", "-o", "d.exr").returncode, DIFFERENT)
        width, height, _, _ = png_size(self.path("d.png"))
        self.assertEqual(width, 300)
        self.assertTrue(250 <= height <= 290, height)
        # The map is in the rows of the image; its last row is bright, its first black.
        codes = self.json("d.png", "d.png")
        self.assertEqual(codes["width"], 300)
        values = self.json("d.exr", "d.exr")
        self.assertEqual((values["width"], values["height"]), (300, 200))
        # Small images are magnified.
        self.write("c.png", png(2, 1, [1] * 6))
        self.diff("c.png", "c.png", "-o", "c2.png")
        self.assertEqual(png_size(self.path("c2.png"))[0], 240)


@unittest.skipUnless(PROGRAM, "the program itself is not given")
class Renders(CommandLine):
    OPTIONS = ("--size", "48x32", "--light", "file", "-q")

    def setUp(self):
        super().setUp()
        self.scene("s.json", scene())

    def render(self, *arguments, code=0):
        result = self.run_program("render", *arguments, *self.OPTIONS, program=PROGRAM)
        self.assertEqual(result.returncode, code, result.stderr)
        return result

    def noise(self, *arguments, code=DIFFERENT):
        result = self.run_program("diff", *arguments, "--json", program=PROGRAM)
        self.assertEqual(result.returncode, code, result.stderr)
        return json.loads(result.stdout)["noise"]

    def test_noise_and_change(self):
        """Films with different seeds and numbers of samples differ by noise; a material that changed is found."""
        self.scene("t.json", scene(gray=0.6))
        self.render("s.json", "--spp", "64", "--mergeable", "-o", "a.exr")
        self.render("s.json", "--spp", "16", "--seed", "1", "--aov", "variance", "-o", "b.exr")
        self.render("t.json", "--spp", "64", "--seed", "2", "--mergeable", "--exr", "half", "-o", "c.exr")
        noise = self.noise("b.exr", "a.exr")
        self.assertTrue(noise["explains_differences"])
        self.assertEqual((noise["blocks"], noise["block_side"], noise["changed_blocks"]), (6, 16, []))
        self.assertEqual(self.run_program("diff", "b.exr", "a.exr", "--allow-noise", program=PROGRAM).returncode, SAME)
        text = self.run_program("diff", "b.exr", "a.exr", program=PROGRAM).stdout
        self.assertIn("the differences are explained by noise", text)
        self.assertIn("result             different, but only by noise\n", text)

        changed = self.noise("c.exr", "a.exr", "--allow-noise", "-o", "d.png")
        self.assertFalse(changed["explains_differences"])
        self.assertTrue(changed["whole_image_changed"])
        block = changed["changed_blocks"][0]
        self.assertEqual(block["pixels"][1::2] in ([0, 16], [16, 32]), True)
        self.assertGreater(block["mean"], block["reference_mean"])
        self.assertLess(block["p"], 0.01)
        text = self.run_program("diff", "c.exr", "a.exr", program=PROGRAM).stdout
        self.assertIn("noise does not explain the differences of ", text)
        self.assertIn("result             different\n", text)

    def test_noise_needs_its_variance(self):
        self.render("s.json", "--spp", "4", "-o", "a.exr")
        self.render("s.json", "--spp", "4", "--seed", "1", "--mergeable", "-o", "b.exr")
        self.refused(TROUBLE, "diff", "b.exr", "a.exr", "--allow-noise", program=PROGRAM,
                     words=["a.exr has no layer variance; render it with --mergeable or --aov variance"])

    def test_same_samples(self):
        self.scene("t.json", scene(gray=0.50001))
        for name in ("s", "t"):
            self.render(f"{name}.json", "--spp", "4", "--mergeable", "-o", f"{name}.exr")
        text = self.run_program("diff", "s.exr", "t.exr", program=PROGRAM).stdout
        self.assertIn("both have the same seed and samples", text)
        self.assertNotIn("same seed", self.run_program("diff", "s.exr", "s.exr", program=PROGRAM).stdout)

    def test_layers(self):
        self.render("s.json", "--spp", "2", "--aov", "depth,normal", "-o", "a.exr")
        self.render("s.json", "--spp", "2", "--aov", "depth,normal", "--seed", "1", "-o", "b.exr")
        result = self.run_program("diff", "a.exr", "b.exr", "--layer", "depth", "-o", "d.png", program=PROGRAM)
        self.assertEqual(result.returncode, DIFFERENT, result.stderr)
        self.assertNotIn("FLIP", result.stdout)
        self.assertIn(" in Z of pixel ", result.stdout)
        self.assertTrue(os.path.exists(self.path("d.png")))

    def test_reference(self):
        """A render equals its reference in each format, also one that none of its outputs has."""
        for name in ("r.exr", "r.png", "r.jpg", "r.webp", "r.hdr"):
            self.render("s.json", "--spp", "2", "-o", name)
            self.render("s.json", "--spp", "2", "-o", "x.png", "--reference", name)
            self.render("s.json", "--spp", "2", "--seed", "1", "-o", "x.png", "--reference", name, code=NOT_REFERENCE)
        self.render("s.json", "--spp", "2", "--seed", "1", "-o", "x.png", "--reference", "r.exr", "--tolerance", "10")
        self.render("s.json", "--spp", "2", "--exr", "half", "-o", "h.exr")
        self.render("s.json", "--spp", "2", "--exr", "half", "-o", "x.png", "--reference", "h.exr")
        self.render("s.json", "--spp", "2", "-o", "x.png", "--reference", "h.exr", code=NOT_REFERENCE)

    def test_report_of_reference(self):
        self.render("s.json", "--spp", "4", "-o", "r.exr", "--mergeable")
        options = ("render", "s.json", "--spp", "4", "--seed", "1", "-o", "x.png", "--reference", "r.exr", *self.OPTIONS[:-1])
        result = self.run_program(*options, program=PROGRAM)
        self.assertEqual(result.returncode, NOT_REFERENCE)
        for word in ("wrote x.png\n", "reference          r.exr\n", "FLIP", "different, but only by noise\n"):
            self.assertIn(word, result.stderr)
        lines = self.run_program(*options, "--progress", "json", program=PROGRAM).stderr.splitlines()
        events = [event for event in map(json.loads, lines) if event["event"] == "comparison"]
        self.assertEqual([(e["reference"], e["same"], e["noise"]["explains_differences"]) for e in events],
                         [("r.exr", False, True)])

    def test_reference_errors(self):
        self.render("s.json", "--spp", "1", "-o", "r.png")
        for code, words, arguments in (
                (1, ["r.png: the reference is 48x32, but the image to be rendered is 40x30"], ["--size", "40x30"]),
                (1, ["r.png is the reference: choose another file with -o"], ["-o", "r.png"]),
                (1, ["no.png: there is no such file"], ["--reference", "no.png"]),
                (2, ["--reference: works for one image"], ["--turntable", "2", "-o", "x.##.png"]),
                (2, ["--reference: leave it out with --only-sample"], ["--only-sample", "1,1,0"])):
            reference = [] if "--reference" in arguments else ["--reference", "r.png"]
            size = [] if "--size" in arguments else ["--size", "48x32"]
            self.refused(code, "render", "s.json", "--spp", "1", "-q", *reference, *size, *arguments, words=words, program=PROGRAM)
        self.refused(2, "render", "s.json", "--tolerance", "1", words=["--tolerance: belongs to --reference"], program=PROGRAM)


if __name__ == "__main__":
    assert DOUBLE
    run_tests()
