#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Tests of the command line: options for the image: size, camera, light, formats, denoising."""
import json
import math
import os
import re
from pathlib import Path

from harness import CommandLine, FAKE_OIDN, PROGRAM, png_size, run_tests


class Picture(CommandLine):
    def test_half_says_what_stays_float(self):
        """65504 is the largest half. A layer with a larger value stays float, which is reported."""
        if not PROGRAM:
            self.skipTest("the program itself is not given")
        for value in (65504, 70000):
            self.scene("sky.json", json.dumps({"fathom": 1, "camera": {"position": [0, 0, 4], "look_at": [0, 0, 0]},
                                               "environment": {"kind": "constant", "color": [value, 1, 1]},
                                               "nodes": {"ball": {"sphere": {"radius": 1}}}}))
            options = ("render", "sky.json", "--spp", "1", "--size", "8x8", "--light", "file", "--aov", "depth,albedo")
            halves = self.ok(*options, "--exr", "half", "-o", "a.exr", "-o", "a.png", program=PROGRAM).stderr
            line = "a.exr: the image has values above 65504, which half can't hold: written as float\n"
            self.assertEqual(halves.count("65504"), 1 if value > 65504 else 0, halves)
            self.assertEqual(line in halves, value > 65504, halves)
            # The channel list gives the type of the channel R: 1 is half, 2 is float.
            channels = self.read("a.exr")
            self.assertEqual(channels[channels.index(b"\0R\0") + 3], 2 if value > 65504 else 1)
            self.assertEqual(channels[channels.index(b"albedo.R\0") + 9], 1)
            self.assertEqual(channels[channels.index(b"depth.Z\0") + 8], 2)
            self.assertNotIn("65504", self.ok(*options, "-o", "a.exr", program=PROGRAM).stderr)

    def test_defaults(self):
        result = self.ok("render", "box.json")
        self.assertEqual(png_size(self.path("box.png")), (800, 600, 8, 2))
        self.assertIn("256 samples", result.stderr)
        self.assertIn("wrote box.png", result.stderr)
        self.assertRegex(result.stderr, r"load [\d.]+ s, build [\d.]+ s, render [\d.]+ s.*256 samples.*rays.*peak memory")
        self.assertEqual(result.stdout, "")
        self.scene("few.json", "camera a spp 3")
        text = self.ok("render", "few.json").stderr
        self.assertNotIn("256", text)
        self.assertIn("3 samples per pixel", text)
        self.assertIn("5 samples per pixel", self.ok("render", "few.json", "--spp", "5").stderr)

    def test_size(self):
        for text, arguments, size in (("camera a aspect 2", [], (800, 400)),
                                      ("camera a aspect 1", [], (600, 600)),
                                      ("camera a aspect 2", ["--size", "50x50"], (50, 50)),
                                      ("camera a size 64 32", [], (64, 32)),
                                      ("camera a size 64 32", ["--size", "8x9"], (8, 9)),
                                      ("camera a aspect 2 camera b aspect 1", ["--camera", "b"], (600, 600)),
                                      ("camera a aspect 2", ["--orbit", "0,0"], (800, 600))):
            self.scene("s.json", text)
            self.ok("render", "s.json", "--spp", "1", *arguments)
            self.assertEqual(png_size(self.path("s.png"))[:2], size, (text, arguments))

    def test_pictures(self):
        self.ok("render", "box.json", "--spp", "1", "--size", "20x10", "--background", "transparent", "--png-bits", "16",
                "-o", "a.png", "-o", "a.exr", "-o", "a.jpg", "-o", "a.webp", "-o", "a.avif", "--output", "a.hdr")
        self.assertEqual(png_size(self.path("a.png")), (20, 10, 16, 6))
        for name in ("a.exr", "a.jpg", "a.webp", "a.avif", "a.hdr"):
            self.assertTrue(os.path.exists(self.path(name)), name)
        self.ok("render", "box.json", "--spp", "1", "--size", "20x10", "-o", "b.exr", "--exr", "half",
                "--aov", "albedo,samples,variance")
        with open(self.path("b.exr"), "rb") as file:
            data = file.read()
        for word in (b"variance.R", b"samples.Y", b"fathom.seed", b"fathom.render_s"):
            self.assertIn(word, data)

    def test_quality(self):
        """The lower --quality is, the smaller lossy files are; the default is 95."""
        if not PROGRAM:
            self.skipTest("no program given")
        # The noise of a single sample serves as detail.
        self.scene("detail.json", json.dumps({
            "fathom": 1, "camera": {"position": [0, 0, 3], "look_at": [0, 0, 0]},
            "environment": {"kind": "gradient", "bottom": [0, 0, 0]}, "materials": {"m": {"kind": "diffuse"}},
            "scene": [{"sphere": {"center": [0, 0, 0], "radius": 1.2}, "material": "m"}]}))
        for ending in ("jpg", "webp", "avif"):
            sizes = {}
            for quality in ("15", "60", "95", None):
                name = f"{quality}.{ending}"
                self.ok("render", "detail.json", "--spp", "1", "--size", "96x96", "-o", name,
                        *(["--quality", quality] if quality else []), program=PROGRAM)
                sizes[quality] = os.path.getsize(self.path(name))
            self.assertLess(1.2 * sizes["15"], sizes["60"], (ending, sizes))
            self.assertLess(1.2 * sizes["60"], sizes["95"], (ending, sizes))
            # WebP is lossless by default.
            (self.assertGreater if ending == "webp" else self.assertEqual)(sizes[None], sizes["95"], (ending, sizes))

    def test_primaries(self):
        self.ok("render", "box.json", "--spp", "1", "--size", "4x4", "-o", "a.exr", "--exr-primaries", "acescg")
        self.ok("render", "box.json", "--spp", "1", "--size", "4x4", "-o", "b.exr", "--exr-primaries", "rec709")
        for name, said in (("a.exr", True), ("b.exr", False)):
            with open(self.path(name), "rb") as file:
                self.assertEqual(b"chromaticities" in file.read(), said, name)
        self.refused(2, "render", "box.json", "--exr-primaries", "p3", words=["rec709", "acescg"])

    def test_ocio(self):
        os.environ.pop("OCIO", None)
        self.refused(2, "render", "box.json", "--ocio", "c.ocio", "--tonemap", "srgb", words=["--ocio", "give one"])
        if "OpenColorIO" not in self.ok("version").stdout:
            self.refused(1, "render", "box.json", "--ocio", "env", words=["libopencolorio-dev"])
            self.skipTest("this build has no OpenColorIO")
        self.scene("c.ocio", "ocio_profile_version: 1\nroles: {default: plain, scene_linear: plain}\ndisplays:\n"
                   "  screen:\n    - !<View> {name: a, colorspace: plain}\n    - !<View> {name: b, colorspace: plain}\n"
                   "colorspaces:\n  - !<ColorSpace> {name: plain}\n")
        ocio = ["--spp", "1", "--size", "4x4", "--ocio", "c.ocio", "--ocio-input", "plain"]
        self.assertIn("OpenColorIO: c.ocio: display 'screen', view 'a'", self.ok("render", "box.json", *ocio).stderr)
        self.assertIn("view 'b'", self.ok("render", "box.json", *ocio, "--ocio-view", "b").stderr)
        self.refused(1, "render", "box.json", *ocio, "--ocio-view", "d", words=["c.ocio", "'d'", "a, b"])
        self.refused(1, "render", "box.json", "--ocio-view", "b", words=["OCIO", "not set"])

    def camera_line(self, *arguments):
        return re.search(r"camera '.*", self.ok("render", "box.json", "--spp", "1", *arguments).stderr).group()

    def test_camera(self):
        self.assertIn("'main' at 1,2,3 to 1,2,2 up 0,1,0 fov 40", self.camera_line())
        self.assertIn("'side' at 1,2,3", self.camera_line("--camera", "side"))
        self.assertIn("at -5,6,7 to 1,2,2 up 0,1,0", self.camera_line("--look-from", "-5,6,7"))
        self.assertIn("at 1,2,3 to 0,0,0", self.camera_line("--look-at", "0,0,0"))
        self.assertIn("up 0,0,1 fov 60", self.camera_line("--up", "0,0,1", "--look-at", "9,9,9", "--fov", "60"))
        self.assertIn("up 0,0,-1", self.camera_line("--look-from", "0,5,0", "--look-at", "0,0,0"))
        self.assertIn("at 45,-20,100", self.camera_line("--orbit", "45,-20"))
        for name, place in (("front", "0,0"), ("back", "180,0"), ("left", "-90,0"), ("right", "90,0"), ("top", "0,90"),
                            ("bottom", "0,-90"), ("three-quarter", "30,20")):
            self.assertIn(f"at {place},100", self.camera_line("--view", name))
        self.refused(2, "render", "box.json", "--view", "side", words=["side", "three-quarter"])
        self.refused(2, "render", "box.json", "--view", "top", "--camera", "main", words=["--view"])
        self.scene("bare.json", "empty")
        text = self.ok("render", "bare.json", "--spp", "1").stderr
        self.assertIn("a camera that frames the scene", text)
        self.assertIn("at 30,20,100", text)

    def test_build(self):
        """The default BVH quality is the one that finishes the image soonest; an option or the scene overrides it."""
        def level(*arguments, scene="tree.json"):
            said = re.search(r"warning: build (\w+)", self.ok("render", scene, "--size", "40x20", *arguments).stderr)
            return said.group(1) if said else "standard"
        self.scene("tree.json", "camera a triangles 1000")
        # High quality needs 32 samples per triangle: 40 samples for each of 800 pixels.
        self.assertEqual(level("--spp", "40"), "high")
        self.assertEqual(level("--spp", "39"), "standard")
        self.assertEqual(level("--spp", "40", "--crop", "0,0,39,20"), "standard")
        self.assertEqual(level("--spp", "79", "--part", "1/2"), "standard")
        self.assertEqual(level("--samples", "100:139"), "standard")
        self.assertEqual(level("--samples", "100:140"), "high")
        self.assertEqual(level("--spp", "10", "--turntable", "4"), "high")
        self.assertEqual(level("--spp", "40", "--only-sample", "0,0,0"), "standard")
        self.assertEqual(level("--spp", "40", "--build", "standard"), "standard")
        self.assertEqual(level("--spp", "40", "--build", "fast"), "fast")
        self.scene("hint.json", "camera a triangles 1000 hint-build compact")
        self.assertEqual(level("--spp", "40", scene="hint.json"), "compact")
        self.assertEqual(level("--spp", "40", "--build", "standard", scene="hint.json"), "standard")
        self.scene("none.json", "camera a")
        self.assertEqual(level("--spp", "40", scene="none.json"), "standard")
        self.scene("wrong.json", "camera a hint-build best")
        self.refused(1, "render", "wrong.json", words=["build", "standard or high", "'best'"])
        self.refused(2, "render", "tree.json", "--build", "default", words=["--build", "standard"])

    def test_environment_and_warnings(self):
        self.scene("sky.hdr", "x")
        self.scene("w.json", "camera a warn something nan")
        text = self.ok("render", "w.json", "--spp", "1", "--env", "sky.hdr", "--up-axis", "z", "-q").stderr
        self.assertIn("environment sky.hdr", text)
        self.assertIn("up axis z", text)
        self.assertIn("fathom: warning: something (2 times)\n", text)
        self.assertIn("3 samples were NaN", text)
        self.assertIn("(--only-sample 7,8,9 replays one)", text)

    def test_light(self):
        self.scene("sky.hdr", "x")
        self.scene("dark.json", "camera a")
        text = self.ok("render", "dark.json", "--spp", "1", "--size", "200x100").stderr
        self.assertIn("light auto aspect 2", text)
        self.assertIn("light: added a lamp, an exposure", text)
        self.assertIn("light file", self.ok("render", "dark.json", "--spp", "1", "--light", "file").stderr)
        self.assertIn("light studio", self.ok("render", "dark.json", "--spp", "1", "--light", "studio").stderr)
        # An environment given by an option is the only light.
        text = self.ok("render", "dark.json", "--spp", "1", "--env", "sky.hdr").stderr
        self.assertIn("light auto, its own", text)
        self.refused(2, "render", "dark.json", "--env", "sky.hdr", "--light", "studio", words=["give one"])
        self.refused(2, "render", "dark.json", "--light", "moon", words=["moon"])

    def test_environment_turned_and_dimmed(self):
        self.scene("sky.hdr", "x")
        self.scene("plain.json", "camera a")
        seen = lambda *options: self.ok("render", "plain.json", "--spp", "1", "--env", "sky.hdr", *options).stderr
        self.assertIn("sky.hdr towards 1.000,0.000,0.000 times 1\n", seen())
        # The rotation is counterclockwise seen from above: from +x (the right) to -z (ahead).
        self.assertIn("sky.hdr towards 0.866,0.000,-0.500 times 0.25\n", seen("--env-rotate", "30", "--env-strength", "0.25"))
        for option in ("--env-rotate", "--env-strength"):
            self.refused(2, "render", "plain.json", option, "2", words=["no environment", "--env FILE"])
        self.refused(2, "render", "plain.json", "--env", "sky.hdr", "--env-strength", "-1", words=["--env-strength"])

    def test_sun_and_sky(self):
        self.scene("sky.hdr", "x")
        seen = lambda *options: self.ok("render", "box.json", "--spp", "1", *options).stderr
        self.assertIn("sky and sun at 0.000,0.500,0.866\n", seen("--light", "sun", "--sun-elevation", "30", "--sun-azimuth", "0"))
        self.assertIn("sky without sun at 1.000,0.000,0.000\n",
                      seen("--light", "sky", "--sun-elevation", "0", "--sun-azimuth", "90"))
        self.assertIn("sky and sun at 1.000,2.000,3.000\n", seen("--light", "sun", "--sun-direction", "1,2,3"))
        self.assertIn("light file", seen("--light", "sun"))
        self.refused(2, "render", "box.json", "--light", "sun", "--env", "sky.hdr", words=["give one"])
        self.refused(2, "render", "box.json", "--sun-elevation", "9", words=["--light sun"])
        self.refused(2, "render", "box.json", "--light", "sun", "--sun-direction", "0,0,0", words=["direction"])
        self.refused(2, "render", "box.json", "--light", "sun", "--sun-direction", "1,1,0", "--sun-azimuth", "3",
                     words=["leave out"])

    def test_the_sun_of_a_place_and_a_date(self):
        """The sun's position agrees with I. Reda, A. Andreas: Solar Position Algorithm for Solar Radiation
        Applications, 2008, table A5.1:
        at 39.742476 N, 105.1786 W, on 2003-10-17 at 12:30:30, UTC-7, elevation 39.872046 before refraction, azimuth
        194.340241."""
        def towards(place, date):
            text = self.ok("render", "box.json", "--spp", "1", "--light", "sun", "--sun-place", place, "--sun-date", date).stderr
            return [float(x) for x in re.search(r"sky and sun at (\S+),(\S+),(\S+)\n", text).groups()]
        def expected(elevation, azimuth):
            e, a = math.radians(elevation), math.radians(azimuth)
            return [math.cos(e) * math.sin(a), math.sin(e), -math.cos(e) * math.cos(a)]  # components are east, up, south
        def near(found, expected):
            for a, b in zip(found, expected):
                self.assertAlmostEqual(a, b, delta=7e-4)  # three digits are printed, and the method is accurate to 0.01 degrees
        for date in ("2003-10-17T12:30:30-07:00", "2003-10-17T19:30:30Z", "2003-10-18T01:00:30+05:30"):
            near(towards("39.742476,-105.1786", date), expected(39.872046, 194.340241))
        # By J. Meeus: Astronomical Algorithms, 1998, example 25.a, the sun is above 7.785 S, 176.580 E at this time:
        # its right ascension is 198.380, and the sidereal time of Greenwich 21.801 (equation 12.4).
        near(towards("-7.785,176.580", "1992-10-13T00:00Z"), [0, 1, 0])
        # At noon of the summer solstice the sun is 23.44 degrees higher than at an equinox, and in the south; in Sydney
        # it is in the north.
        self.assertAlmostEqual(towards("51.4769,0", "2026-06-21T12:02Z")[1], math.sin(math.radians(90 - 51.4769 + 23.44)), delta=1e-3)
        self.assertGreater(towards("51.4769,0", "2026-06-21T12:02Z")[2], 0.4)
        self.assertLess(towards("-33.87,151.21", "2026-06-21T02:00Z")[2], -0.4)
        self.assertGreater(towards("51.4769,0", "2026-06-21T18:00Z")[1], 0)
        self.assertLess(towards("51.4769,0", "2026-06-21T18:00Z")[0], -0.9)
        sun = ["render", "box.json", "--light", "sun"]
        self.refused(2, *sun, "--sun-place", "1,2", words=["--sun-place, --sun-date"])
        self.refused(2, *sun, "--sun-date", "2026-06-21T12:00Z", words=["--sun-place, --sun-date"])
        for place in ("91,0", "1", "0,361", "x,y"):
            self.refused(2, *sun, "--sun-place", place, "--sun-date", "2026-06-21T12:00Z", words=["--sun-place"])
        for date in ("2026-06-21", "2026-06-21T12:00", "2026-02-29T12:00Z", "2026-13-01T12:00Z", "2026-06-21T25:00Z",
                     "2026-06-21T12:00+2", "2026-06-21T12:00Zulu", "noon", "1800-01-01T12:00Z"):
            self.refused(2, *sun, "--sun-place", "1,2", "--sun-date", date, words=["--sun-date", date])
        both = ["--sun-place", "1,2", "--sun-date", "2026-06-21T12:00Z"]
        self.refused(2, *sun, *both, "--sun-azimuth", "3", words=["--sun-place", "leave out"])
        self.refused(2, "render", "box.json", *both, words=["--light sun"])

    def test_ground(self):
        def words(*options, command="box.json"):
            return self.ok("render", command, "--spp", "1", *options).stderr
        self.assertIn("ground where it fits of 0.55", words())
        self.assertIn("ground where it fits of 0.25", words("--background", "0.25"))
        self.assertIn("ground of 0.55", words("--ground", "shadow"))
        self.assertIn("ground of 0.75", words("--ground", "0.5,0.75,1", "--background", "0.25"))
        self.assertNotIn("ground", words("--ground", "none"))
        self.assertNotIn("ground", words("--background", "transparent"))
        self.assertIn("ground of 0.25", words("--ground", "0.25", "--background", "transparent"))
        self.refused(2, "render", "box.json", "--ground", "shadow", "--background", "transparent", words=["--ground", "--background"])
        self.refused(2, "render", "box.json", "--ground", "shade", words=["--ground", "shade"])

    def test_denoise(self):
        if not FAKE_OIDN:
            self.skipTest("no library to denoise with")
        there = {**os.environ, "FATHOM_OIDN": FAKE_OIDN}
        render = ["render", "box.json", "--spp", "2", "--size", "20x10", "--denoise"]
        channels = lambda name: set(re.findall(rb"(?:denoised|albedo|normal)\.[A-Z]", Path(self.path(name)).read_bytes()))
        text = self.ok(*render, "-o", "a.exr", "-o", "a.png", "--mergeable", env=there).stderr
        self.assertIn("denoising with Open Image Denoise 2.98.76 (" + FAKE_OIDN + ")\n", text)
        self.assertEqual(channels("a.exr"), {b"denoised.R", b"denoised.G", b"denoised.B"})
        # The noisy image is unchanged in the file, and a PNG shows the denoised one.
        self.ok(*render[:-1], "-o", "raw.png")
        self.ok("merge", "a.exr", "-o", "merged.png")
        self.ok("merge", "a.exr", "--denoise", "-o", "denoised.png", "-o", "m.exr", env=there)
        data = {name: Path(self.path(name)).read_bytes() for name in ("a.png", "raw.png", "merged.png", "denoised.png")}
        self.assertEqual(data["raw.png"], data["merged.png"])
        self.assertEqual(data["a.png"], data["denoised.png"])
        self.assertIn(b"denoised.R", channels("m.exr"))
        # Layers that guide the denoiser are removed unless an option asks for them; the test double of the library has
        # no layers.
        if PROGRAM:
            self.scene("ball.json", '{"fathom": 1, "camera": {"position": [0, 0, 4], "look_at": [0, 0, 0]}, '
                                    '"environment": {"kind": "constant"}, "scene": [{"sphere": {"radius": 1}}]}')
            ball = ["render", "ball.json", "--spp", "2", "--size", "20x10", "--denoise", "-q", "-o", "b.exr"]
            self.ok(*ball, program=PROGRAM, env=there)
            self.assertEqual(channels("b.exr"), {b"denoised.R", b"denoised.G", b"denoised.B"})
            self.ok(*ball, "-o", "c.png", program=PROGRAM, env=there)
            self.ok(*[word for word in ball if word != "--denoise"], "-o", "d.png", program=PROGRAM)
            self.assertNotEqual(*(Path(self.path(name)).read_bytes() for name in ("c.png", "d.png")))
            self.ok(*ball, "--aov", "normal", program=PROGRAM, env=there)
            self.assertEqual({name[:8] for name in channels("b.exr")}, {b"denoised", b"normal.X", b"normal.Y", b"normal.Z"})
        # --denoise auto denoises the image if it can, and otherwise reports why not.
        for words in (["--denoise", "auto"], ["--denoise=auto"]):
            text = self.ok(*render[:-1], *words, "-o", "auto.png", env=there).stderr
            self.assertIn("denoising with Open Image Denoise 2.98.76", text)
            self.assertEqual(Path(self.path("auto.png")).read_bytes(), data["a.png"])
        text = self.ok(*render[:-1], "--denoise", "auto", "-o", "auto.png", env={**there, "FATHOM_OIDN": "/none.so"}).stderr
        self.assertIn("not denoised: /none.so: FATHOM_OIDN", text)
        self.assertEqual(Path(self.path("auto.png")).read_bytes(), data["raw.png"])
        self.refused(2, *render[:-1], "--denoise=perhaps", words=["--denoise", "perhaps"])
        self.ok("render", "--denoise", "box.json", "--spp", "1", "-o", "auto.png", env=there)
        # If a denoiser is required but missing, the command fails before anything is rendered.
        self.refused(1, *render, "-o", "new.png", words=["/none.so: FATHOM_OIDN"], env={**there, "FATHOM_OIDN": "/none.so"})
        self.assertFalse(os.path.exists(self.path("new.png")))
        away = {"PATH": self.folder, "HOME": self.folder}
        result = self.run_program(*render, "-o", "new.png", env=away)
        if result.returncode:  # it succeeds if the system has the library
            self.assertEqual(result.stderr.count("\n"), 1)
            self.assertIn("pip install pyoidn", result.stderr)

    def test_fireflies(self):
        """A small lamp seen through glass makes fireflies. They are reported with a limit that removes them; films
        store the limit, and parts must agree on it."""
        if not PROGRAM:
            self.skipTest("no program given")
        self.scene("room.json", json.dumps({
            "fathom": 1, "camera": {"position": [0.2, 0.1, 3.4], "look_at": [0, 0, 0]},
            "materials": {"wall": {"kind": "diffuse", "color": [0.75, 0.75, 0.75]}, "glass": {"kind": "glass"},
                          "lamp": {"kind": "none", "emission": [60, 60, 60]}},
            "scene": [{"box": {"min": [-1, -1.1, -1], "max": [1, -1, 1]}, "material": "wall"},
                      {"box": {"min": [-1, -1, -1.1], "max": [1, 1, -1]}, "material": "wall"},
                      {"box": {"min": [-1.1, -1, -1], "max": [-1, 1, 1]}, "material": "wall"},
                      {"box": {"min": [-1, 1, -1], "max": [1, 1.1, 1]}, "material": "wall"},
                      {"rectangle": {"corner": [-0.2, 0.9, -0.2], "edge_u": [0.3, 0, 0], "edge_v": [0, 0, 0.3]}, "material": "lamp"},
                      {"sphere": {"center": [0, -0.4, 0], "radius": 0.4}, "material": "glass"}]}))
        render = ["render", "room.json", "--size", "240x180", "--caustics", "off"]
        line = r"([\d.e-]+) % of the samples \(fireflies\) make (\d+) % of the noise: --denoise, or --clamp-indirect 10 \(biased\), would remove them\n"
        told = re.search(line, self.ok(*render, "--spp", "64", program=PROGRAM).stderr)
        self.assertLess(float(told[1]), 1)
        self.assertGreater(int(told[2]), 20)
        events = [json.loads(words) for words in
                  self.ok(*render, "--spp", "64", "--progress", "json", program=PROGRAM).stderr.splitlines()]
        event = next(event for event in events if event["event"] == "fireflies")
        self.assertEqual((round(100 * event["noise"]), event["clamp"]), (int(told[2]), 10))
        self.assertIn("--clamp-indirect 20 ", self.ok(*render, "--spp", "64", "--exposure", "-1", program=PROGRAM).stderr)
        limited = [*render, "--clamp-indirect", "0.5"]
        text = self.ok(*limited, "--samples", "0:64", "-o", "a.exr", program=PROGRAM).stderr
        self.assertIn("biased: indirect light is clamped at 0.5\n", text)
        self.assertNotIn("of the noise", text)
        self.assertIn(b"fathom.clamp_indirect\0string\0\3\0\0\x000.5", Path(self.path("a.exr")).read_bytes())
        self.ok(*limited, "--samples", "64:66", "-o", "b.exr", program=PROGRAM)
        self.ok(*render, "--samples", "66:68", "-o", "c.exr", program=PROGRAM)
        self.ok("merge", "a.exr", "b.exr", "-o", "all.exr", program=PROGRAM)
        self.refused(1, "merge", "all.exr", "c.exr", "-o", "x.exr", words=["c.exr", "clamp_indirect is none"], program=PROGRAM)

    def test_guiding_by_itself(self):
        """Guiding is used if it is worth the time. Parts that will be merged agree on it."""
        for options, guiding in [(["--spp", "1365"], "off"), (["--spp", "1366"], "on"), (["--time", "0.1"], "off"),
                                 (["--samples", "0:1"], "on"), (["--spp", "1", "--mergeable"], "on"),
                                 (["--samples", "0:1", "--guiding", "off"], "off"), (["--spp", "1", "--guiding", "on"], "on"),
                                 (["--spp", "1", "--guiding", "auto"], "off")]:
            with self.subTest(options=options):
                self.ok("render", "box.json", "-o", "guided.exr", "--size", "64x48", *options)
                word = b"fathom.guiding\0string\0" + len(guiding).to_bytes(4, "little") + guiding.encode()
                self.assertIn(word, Path(self.path("guided.exr")).read_bytes())

    def test_caustics_by_themselves(self):
        """Light tracing is used where glass refracts the light of a point, and both parts of an image agree on it."""
        scene = {"fathom": 1, "camera": {"position": [0, 1, 4], "look_at": [0, 0.5, 0]},
                 "materials": {"floor": {"kind": "diffuse"}, "glass": {"kind": "glass", "ior": 1.5}},
                 "lights": {"bulb": {"kind": "point", "position": [0, 2, 0], "intensity": 5}},
                 "scene": [{"material": "floor", "rectangle": {"corner": [-2, 0, 2], "edge_u": [4, 0, 0], "edge_v": [0, 0, -4]}}]}
        ball = {"material": "glass", "sphere": {"center": [0, 0.8, 0], "radius": 0.5}}
        Path(self.path("plain.json")).write_text(json.dumps(scene))
        Path(self.path("ball.json")).write_text(json.dumps({**scene, "scene": [*scene["scene"], ball]}))
        note, warning = "caustics: on, because", "is missing (caustics); --caustics on renders it"
        for name, options, caustics, words in [
                ("plain", [], "off", None), ("ball", [], "on", note), ("ball", ["--caustics", "auto"], "on", note),
                ("ball", ["--caustics", "off"], "off", warning), ("ball", ["--caustics", "on"], "on", None),
                ("plain", ["--caustics", "on"], "on", None), ("ball", ["--light-sampling", "off"], "off", warning)]:
            with self.subTest(name=name, options=options):
                text = self.ok("render", name + ".json", "--size", "16x12", "--spp", "2", "-o", "x.exr", *options, program=PROGRAM).stderr
                for line in (note, warning):
                    self.assertEqual(line in text, line == words, text)
                number = b"0.25" if caustics == "on" else b"0"
                word = b"fathom.light_paths\0string\0" + len(number).to_bytes(4, "little") + number
                self.assertIn(word, Path(self.path("x.exr")).read_bytes())
        common = ["render", "ball.json", "--size", "16x12"]
        self.ok(*common, "--samples", "0:3", "-o", "a.exr", program=PROGRAM)
        self.ok(*common, "--samples", "3:6", "-o", "b.exr", program=PROGRAM)
        self.ok("merge", "a.exr", "b.exr", "-o", "all.exr", program=PROGRAM)
        self.ok(*common, "--samples", "6:8", "--caustics", "off", "-o", "c.exr", program=PROGRAM)
        self.refused(1, "merge", "all.exr", "c.exr", "-o", "x.exr", words=["c.exr", "light_paths is 0x0p+0"], program=PROGRAM)

    def test_caustics_seen_through_glass(self):
        """What light paths cannot show is named; photons show it, and their parts are not mixed with others."""
        square = lambda material, y: {"material": material, "rectangle": {"corner": [-2, y, 2], "edge_u": [4, 0, 0], "edge_v": [0, 0, -4]}}
        scene = {"fathom": 1, "camera": {"position": [0, 4, 0.1], "look_at": [0, 0, 0]},
                 "materials": {"floor": {"kind": "diffuse"}, "water": {"kind": "glass", "ior": 1.33}},
                 "lights": {"bulb": {"kind": "point", "position": [0, 2, 0], "intensity": 5}},
                 "scene": [square("floor", 0), square("water", 0.5)]}
        Path(self.path("pool.json")).write_text(json.dumps(scene))
        warning = "caustics that are seen through glass or in mirrors are missing, about"
        common = ["render", "pool.json", "--size", "16x12"]
        for caustics, warned in [("auto", True), ("on", True), ("merged", False), ("off", False)]:
            with self.subTest(caustics=caustics):
                text = self.ok(*common, "--spp", "2", "--caustics", caustics, "-o", "x.exr", program=PROGRAM).stderr
                self.assertEqual(warning in text, warned, text)
        self.ok(*common, "--samples", "0:2", "--caustics", "merged", "-o", "a.exr", program=PROGRAM)
        self.assertIn(b"fathom.merge_caustics\0string\0\2\0\0\0on", Path(self.path("a.exr")).read_bytes())
        self.ok(*common, "--samples", "2:4", "--caustics", "merged", "-o", "b.exr", program=PROGRAM)
        self.ok("merge", "a.exr", "b.exr", "-o", "all.exr", program=PROGRAM)
        self.ok(*common, "--samples", "4:6", "--caustics", "on", "-o", "c.exr", program=PROGRAM)
        self.refused(1, "merge", "all.exr", "c.exr", "-o", "x.exr", words=["c.exr", "light_paths is 0x1p-2, not 0x1p-2+merged"], program=PROGRAM)

    def test_caustics_of_small_lamps(self):
        """A million samples are worth a trial in scenes with smooth glass, and fewer or others are not."""
        lamp = {"material": "light", "rectangle": {"corner": [-0.05, 3, -0.05], "edge_u": [0.1, 0, 0], "edge_v": [0, 0, 0.1]}}
        floor = {"material": "floor", "rectangle": {"corner": [-2, 0, 2], "edge_u": [4, 0, 0], "edge_v": [0, 0, -4]}}
        scene = {"fathom": 1, "camera": {"position": [0, 1, 4], "look_at": [0, 0.5, 0]},
                 "materials": {"floor": {"kind": "diffuse"}, "light": {"kind": "none", "emission": [900, 900, 900]}}}
        for name, glass in [("smooth", {"kind": "glass"}), ("rough", {"kind": "glass", "roughness": 0.4})]:
            ball = {"material": "ball", "sphere": {"center": [0, 0.8, 0], "radius": 0.5}}
            Path(self.path(name + ".json")).write_text(json.dumps(
                {**scene, "materials": {**scene["materials"], "ball": glass}, "scene": [floor, lamp, ball]}))
        for name, samples, is_on in [("smooth", 1366, True), ("smooth", 1365, False), ("rough", 1366, False)]:
            with self.subTest(name=name, samples=samples):
                result = self.ok("render", name + ".json", "--size", "32x24", "--spp", str(samples), "-o", "x.exr", program=PROGRAM)
                self.assertEqual("caustics: on, because a trial" in result.stderr, is_on, result.stderr)

    def test_only_sample(self):
        result = self.ok("render", "box.json", "--only-sample", "12,34,56")
        self.assertEqual(result.stdout, "pixel 12,34 sample 56: 12 34 56\n")
        self.assertFalse(os.path.exists(self.path("box.png")))


if __name__ == "__main__":
    run_tests()
