#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Tests the real window: an X server without a screen, simulated keys and mouse, and screenshots.

window_test.py PROGRAM SCENES FAKE_OIDN    exit code 77: Xvfb, xdotool or ImageMagick's `import` is not installed
"""
import json
import math
import os
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import unittest

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "support"))
import waiting  # noqa: E402

PROGRAM = SCENES = FAKE_OIDN = None
NEEDED = ("Xvfb", "xdotool", "import")
DISPLAY = None


def environment():
    return {**os.environ, "DISPLAY": DISPLAY}


def xdotool(*arguments):
    return waiting.run(["xdotool", *map(str, arguments)], env=environment()).stdout


class Screenshot:
    def __init__(self, window):
        data = waiting.run(["import", "-window", str(window), "-depth", "8", "ppm:-"], env=environment(), check=True, text=False).stdout
        head = re.match(rb"P6\s+(\d+)\s+(\d+)\s+255\s", data)
        self.width, self.height = int(head[1]), int(head[2])
        self.pixels = data[head.end():]

    def mean(self, x, y, size=9):
        """Mean color of a square whose center is given as fractions of width and height."""
        x0, y0 = int(x * self.width) - size // 2, int(y * self.height) - size // 2
        sums = [0, 0, 0]
        for row in range(y0, y0 + size):
            at = 3 * (row * self.width + x0)
            for c in range(3):
                sums[c] += sum(self.pixels[at + c:at + 3 * size:3])
        return [s / size**2 for s in sums]

    def whites(self, x0, y0, x1, y1):
        """Number of pure white pixels in a rectangle, which is given in pixels."""
        return sum(self.pixels[3 * (y * self.width + x0):3 * (y * self.width + x1)].count(b"\xff\xff\xff")
                   for y in range(y0, y1))


class Window(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = folder.name
        self.process = None

    def start(self, *arguments, scene="cornell-box.json", oidn="/nowhere"):
        paths = [os.path.join(self.folder, name) for name in ("stdout", "stderr")]
        with open(paths[0], "w") as output, open(paths[1], "w") as errors:
            self.process = subprocess.Popen([PROGRAM, "view", os.path.join(SCENES, scene), *arguments], cwd=self.folder,
                                            env={**environment(), "FATHOM_OIDN": oidn}, stdout=output, stderr=errors)
        # These are opened again to be read: seeking in a file that the program shares would move where it writes.
        self.output, self.errors = [open(path) for path in paths]
        self.addCleanup(self.output.close)
        self.addCleanup(self.errors.close)
        self.addCleanup(self.stop)
        self.window = None
        self.window = self.wait_for("the window", lambda: xdotool("search", "--name", scene).split()[:1])[0]
        # Keys go to the window below the pointer, because there is no window manager.
        xdotool("mousemove", "--window", self.window, 400, 300)
        self.wait_for("samples", lambda: self.samples() >= 4)

    def wait_for(self, what, condition, seen=lambda: ""):
        """Returns the first true value of condition(); fails if the window closes."""
        def state():
            title = repr(self.title()) if self.window else "no window"
            return f"{title}, printed {self.text(self.errors)!r} {seen()}"
        return waiting.wait_for(what, condition, seen=state, stop=waiting.ended(self.process))

    def wait_for_screen(self, what, place, condition, size=9):
        """Waits until condition(color) is true at a place, since titles may precede their images; returns the mean
        color there."""
        self.wait_for(what, lambda: condition(self.screen().mean(*place, size)), seen=lambda: f"colour {self.screen().mean(*place, size)}")
        return self.screen().mean(*place, size)

    def wait_for_near(self, what, place, colour, within):
        self.wait_for_screen(what, place, lambda seen: all(abs(a - b) <= within for a, b in zip(seen, colour)))

    def wait_for_exit(self):
        self.wait_for("the program to end", lambda: self.process.poll() is not None)
        return self.process.returncode

    def stop(self):
        if self.process.poll() is None:
            self.process.kill()
        self.process.wait()

    def text(self, file):
        file.seek(0)
        return file.read()

    def title(self):
        return xdotool("getwindowname", self.window).strip()

    def samples(self):
        match = re.search(r" - (\d+) of \d+ samples", self.title())
        return int(match[1]) if match else 0

    def screen(self):
        return Screenshot(self.window)

    def key(self, *keys):
        xdotool("key", *keys)

    def camera(self):
        """Returns the camera that the window prints."""
        lines = len(self.text(self.output).splitlines())
        self.key("p")
        self.wait_for("the camera", lambda: len(self.text(self.output).splitlines()) > lines)
        return json.loads("{" + self.text(self.output).splitlines()[-1] + "}")["camera"]

    def drag(self, button, right, down):
        xdotool("mousemove", "--window", self.window, 400, 300, "mousedown", button)
        for step in range(1, 6):
            xdotool("mousemove", "--window", self.window, 400 + right * step // 5, 300 + down * step // 5)
        xdotool("mouseup", button)

    def assert_near(self, a, b, within):
        for x, y in zip(a, b):
            self.assertAlmostEqual(x, y, delta=within, msg=f"{a} {b}")

    # ------------------------------------------------------------------------------------------------ the image

    def wait_for_the_box(self):
        def colours():
            screen = self.screen()
            return [screen.mean(*place) for place in ((0.22, 0.5), (0.78, 0.5), (0.55, 0.3), (0.03, 0.05))]

        def is_shown():
            left, right, back, outside = colours()
            return (left[1] > 1.5 * left[0] and right[0] > 2 * right[1] and min(back) > 60 and max(back) - min(back) < 60
                    and outside == [0, 0, 0])

        self.wait_for("the box", is_shown, seen=colours)

    def test_shows_the_picture_and_becomes_clear(self):
        self.start("--spp", "64")
        screen = self.screen()
        self.assertEqual((screen.width, screen.height), (800, 600))
        self.wait_for_the_box()
        self.wait_for("the last sample", lambda: self.samples() == 64)
        self.assertRegex(self.title(), r"^cornell-box.json - 64 of 64 samples, 100 % - [\d.]+ M samples/s$")
        self.key("Escape")
        self.assertEqual(self.wait_for_exit(), 0)
        self.assertEqual(self.text(self.errors), "")
        self.assertEqual(self.text(self.output), "")

    def test_has_the_bits_of_render(self):
        self.start("--spp", "13", "--exposure", "1")
        self.wait_for("the last sample", lambda: self.samples() == 13)
        self.key("F2")
        self.wait_for("the picture", lambda: "saved" in self.text(self.errors))
        waiting.run([PROGRAM, "render", os.path.join(SCENES, "cornell-box.json"), "--spp", "13", "--exposure", "1",
                     "--quiet", "-o", "render.png"], cwd=self.folder, check=True)
        with open(os.path.join(self.folder, "cornell-box-0001.png"), "rb") as a:
            with open(os.path.join(self.folder, "render.png"), "rb") as b:
                self.assertEqual(a.read(), b.read())

    def test_resizing_changes_the_pictures_size(self):
        self.start("--size", "500x300")
        self.assertEqual(self.screen().width, 500)
        xdotool("windowsize", self.window, 640, 560)
        self.wait_for("the new size", lambda: self.screen().width == 640)
        # The height of the view is unchanged; its width follows the window.
        self.wait_for_screen("the left wall", (0.15, 0.5), lambda colour: colour[1] > 1.5 * colour[0])
        self.wait_for_near("what is beside the box", (0.02, 0.02), (0, 0, 0), 0)
        self.key("F2")
        self.wait_for("the picture", lambda: "saved" in self.text(self.errors))
        self.assertEqual([f for f in os.listdir(self.folder) if f.endswith(".exr")], ["cornell-box-0001.exr"])
        with open(os.path.join(self.folder, "cornell-box-0001.png"), "rb") as file:
            head = file.read(24)
        self.assertEqual(head[16:24], (640).to_bytes(4, "big") + (560).to_bytes(4, "big"))

    def test_exposure_and_tone_map(self):
        self.start("--exposure", "0.5")
        self.assertIn("exposure +0.5", self.title())
        # The title may change before its image is shown.
        colour = lambda: self.screen().mean(0.55, 0.3)
        before = self.wait_for_screen("a picture", (0.55, 0.3), lambda colour: min(colour) > 30)
        self.key("plus", "plus")
        self.wait_for("the title", lambda: "exposure +1.5" in self.title())
        self.wait_for("a brighter picture", lambda: colour()[0] > before[0] + 30)
        self.key("minus", "minus", "minus")
        self.wait_for("the title", lambda: "exposure" not in self.title())
        self.wait_for("a darker picture", lambda: colour()[0] < before[0] - 10)
        self.wait_for("all samples", lambda: self.samples() >= 4)
        plain = colour()
        self.key("t")
        self.wait_for("another tone map", lambda: max(abs(x - y) for x, y in zip(colour(), plain)) > 3)
        self.assertEqual(self.text(self.errors), "")

    def test_help(self):
        self.start()
        corner = (0, 0, 116, 380)
        self.assertEqual(self.screen().whites(*corner), 0)
        self.key("h")
        self.wait_for("help", lambda: self.screen().whites(*corner) > 500)
        self.key("F1")
        self.wait_for("no help", lambda: self.screen().whites(*corner) == 0)

    def test_other_views(self):
        self.start()
        self.key("2")
        self.wait_for("albedo", lambda: "[albedo]" in self.title() and self.samples() >= 2)
        # The colors are sRGB of (.12, .45, .15) and (.65, .05, .05).
        self.wait_for_near("the left wall", (0.22, 0.5), (97, 179, 108), 3)
        self.wait_for_near("the right wall", (0.78, 0.5), (210, 63, 63), 3)
        self.key("3")
        self.wait_for("normal", lambda: "[normal]" in self.title() and self.samples() >= 2)
        # The left wall, at x = 555, faces -x; the back wall faces -z.
        self.wait_for_near("the left wall", (0.22, 0.5), (0, 128, 128), 3)
        self.wait_for_near("the back wall", (0.55, 0.3), (128, 128, 0), 3)
        self.key("Tab")
        self.wait_for("depth", lambda: "[depth]" in self.title() and self.samples() >= 2)
        # The back wall is at a distance of 1355, and the focus at 800.
        self.wait_for_near("the back wall", (0.55, 0.3), [255 * 800 / (800 + 1355)] * 3, 3)
        self.key("shift+Tab", "7")
        self.wait_for("material", lambda: "[material]" in self.title() and self.samples() >= 2)
        right = self.screen().mean(0.78, 0.5)
        self.wait_for_screen("another colour than the right wall's", (0.22, 0.5), lambda colour: colour != right)
        self.wait_for_near("what is beside the box", (0.03, 0.05), (0, 0, 0), 0)
        self.key("8")
        self.wait_for("noise", lambda: "[noise]" in self.title() and self.samples() >= 2)
        self.key("1")
        self.wait_for("the picture", lambda: "[" not in self.title() and self.samples() >= 2)
        self.wait_for_the_box()

    def test_noise_is_taken_away(self):
        self.start("--spp", "16", "--tonemap", "srgb", oidn=FAKE_OIDN)
        self.wait_for("all samples", lambda: self.samples() == 16)
        noisy = self.screen().mean(0.55, 0.3)
        # The fake denoiser adds 5 albedos and 500 normals. The back wall, which faces -z, has no blue left.
        self.key("n")
        self.wait_for("the denoised picture", lambda: self.title().endswith("denoised"))
        self.wait_for_screen("its colours", (0.55, 0.3), lambda colour: colour[2] == 0 and colour[0] > 200)
        self.key("F2")
        self.wait_for("the pictures", lambda: "saved" in self.text(self.errors))
        with open(os.path.join(self.folder, "cornell-box-0001.exr"), "rb") as file:
            self.assertIn(b"denoised.R", file.read(4096))
        # After a move the image is different, and denoised again.
        upper = lambda: self.screen().pixels[:800 * 300 * 3]  # excludes the text overlay
        before = upper()
        self.drag(1, 20, 0)
        self.wait_for("another denoised picture", lambda: self.samples() == 16 and self.title().endswith("denoised") and upper() != before
                      and self.screen().mean(0.55, 0.3)[2] == 0, seen=lambda: self.screen().mean(0.55, 0.3))
        self.key("r", "n")
        self.wait_for("the picture as it is", lambda: self.samples() == 16 and not self.title().endswith("denoised"))
        self.wait_for_near("its colours", (0.55, 0.3), noisy, 1)
        self.assertIn("denoised with Open Image Denoise 2.98.76", self.text(self.errors))

    def test_noise_stays_without_a_denoiser(self):
        self.start("--spp", "8")
        self.key("n")
        self.wait_for("the reason", lambda: "FATHOM_OIDN: there is no such library" in self.text(self.errors))
        self.wait_for("all samples", lambda: self.samples() == 8)
        self.assertNotIn("denoised", self.title())

    # ------------------------------------------------------------------------------------------------ the camera

    def test_orbit_pan_zoom_fly_and_reset(self):
        self.start()
        pivot = (280, 280, 0)
        first = self.camera()
        self.assertEqual(first["position"], [280, 280, -800])
        self.assertEqual(first["fov_y_deg"], 40)

        self.drag(1, 100, 40)
        orbited = self.camera()
        self.assertGreater(math.dist(orbited["position"], first["position"]), 100)
        self.assertGreater(orbited["position"][1], 300)
        self.assertAlmostEqual(math.dist(orbited["position"], pivot), 800, delta=1e-3)
        self.assert_near(orbited["look_at"], pivot, 1e-3)
        self.wait_for("samples", lambda: self.samples() >= 2)
        self.wait_for_screen("the box", (0.22, 0.5), lambda colour: colour[1] > 1)

        self.key("r")
        self.assertEqual(self.camera(), first)
        self.drag(3, 60, 0)
        panned = self.camera()
        # The point below the pointer stays below it. The image's right is at smaller x.
        self.assert_near(panned["position"], (280 + 60 / 600 * 2 * 800 * math.tan(math.radians(20)), 280, -800), 0.5)
        self.key("r")
        self.drag(2, 0, 60)
        self.assertGreater(self.camera()["position"][1], 300)

        self.key("r")
        xdotool("click", 4)
        self.assert_near(self.camera()["position"], (280, 280, -704), 1e-3)
        xdotool("click", 5, "click", 5)
        self.assertLess(self.camera()["position"][2], -800)

        self.key("r")
        for key, axis, sign in (("w", 2, 1), ("s", 2, -1), ("d", 0, -1), ("a", 0, 1), ("e", 1, 1), ("q", 1, -1)):
            before = self.camera()["position"]
            moved = lambda: [a - b for a, b in zip(self.camera()["position"], before)]
            xdotool("keydown", key)
            self.wait_for(f"a move by {key}", lambda: moved()[axis] * sign > 10, seen=moved)
            xdotool("keyup", key)
            moved = moved()
            self.assertGreater(moved[axis] * sign, 10, (key, moved))
            self.assertAlmostEqual(moved[(axis + 1) % 3], 0, delta=1e-3)
        self.key("r", "Left")
        looked = self.camera()
        self.assertEqual(looked["position"], first["position"])
        self.assertGreater(looked["look_at"][0], 280)
        # The printed camera is valid in a scene file.
        with open(os.path.join(SCENES, "cornell-box.json")) as file:
            scene = json.load(file)
        scene.pop("$schema")
        scene["camera"] = looked
        with open(os.path.join(self.folder, "printed.json"), "w") as file:
            json.dump(scene, file)
        waiting.run([PROGRAM, "info", os.path.join(self.folder, "printed.json")], check=True)

    def wait_for_answer(self):
        """Waits until a click is answered: requests are answered in order, before an image is saved."""
        saved = self.text(self.errors).count("saved")
        self.key("F2")
        self.wait_for("a picture", lambda: self.text(self.errors).count("saved") > saved)

    def test_a_click_focuses(self):
        self.start()
        first = self.camera()
        # The click is at the front of the short box, at z = 65.
        xdotool("mousemove", "--window", self.window, 445, 480, "click", 1)
        self.wait_for_answer()
        focused = self.camera()
        self.assertEqual(focused["position"], first["position"])
        self.assert_near(focused["look_at"], (280, 280, 65), 0.5)
        # This click hits nothing and changes nothing.
        xdotool("mousemove", "--window", self.window, 20, 20, "click", 1)
        self.wait_for_answer()
        self.assertEqual(self.camera(), focused)
        # Orbits now use the clicked point as pivot.
        self.drag(1, 50, 0)
        turned = self.camera()
        point = (232.2, 90.6, 65)
        self.assertAlmostEqual(math.dist(turned["position"], point), math.dist(first["position"], point), delta=1)
        self.assertGreater(math.dist(turned["look_at"], focused["look_at"]), 5)

    def test_focus_blurs_the_rest(self):
        self.start(scene="depth-of-field.json")
        before = self.camera()
        xdotool("mousemove", "--window", self.window, 400, 500, "click", 1)
        self.wait_for("another focus", lambda: self.camera()["focus_distance"] != before["focus_distance"])
        self.wait_for("samples", lambda: self.samples() >= 1)

    # ------------------------------------------------------------------------------------------------ the rest

    def test_saving_takes_names_that_are_free(self):
        self.start()
        with open(os.path.join(self.folder, "cornell-box-0002.exr"), "w"):
            pass
        self.key("ctrl+s")
        self.wait_for("a picture", lambda: "saved cornell-box-0001.png" in self.text(self.errors))
        # Saving works with another view, immediately after a move, and includes the viewed layers.
        self.key("3", "w", "F2")
        self.wait_for("another picture", lambda: "saved cornell-box-0003.png" in self.text(self.errors))
        self.assertEqual(sorted(f for f in os.listdir(self.folder) if f.startswith("cornell")),
                         ["cornell-box-0001.exr", "cornell-box-0001.png", "cornell-box-0002.exr",
                          "cornell-box-0003.exr", "cornell-box-0003.png"])
        with open(os.path.join(self.folder, "cornell-box-0001.png"), "rb") as file:
            self.assertEqual(file.read(8), b"\x89PNG\r\n\x1a\n")
        self.key("ctrl+q")
        self.assertEqual(self.wait_for_exit(), 0)

    def test_options_mean_what_they_mean_for_render(self):
        scene = os.path.join(SCENES, "report-spheres.json")
        options = ["--size", "480x360", "--spp", "4", "--filter", "box", "--max-depth", "3", "--roulette-depth", "1",
                   "--light-sampling", "off", "--seed", "7", "--background", "1,0.25,0.5", "--orbit", "20,30", "--fov", "30",
                   "--exposure", "-1", "--tonemap", "filmic"]
        self.start(*options, scene="report-spheres.json")
        self.wait_for("all samples", lambda: self.samples() == 4)
        self.key("ctrl+s")
        self.wait_for("a picture", lambda: "saved report-spheres-0001.png" in self.text(self.errors))
        expected = os.path.join(self.folder, "expected.png")
        waiting.run([PROGRAM, "render", scene, *options, "-o", expected], check=True)
        with open(expected, "rb") as a, open(os.path.join(self.folder, "report-spheres-0001.png"), "rb") as b:
            self.assertEqual(a.read(), b.read())

    def test_a_picture_that_can_not_be_saved(self):
        self.start()
        shutil.rmtree(self.folder)
        self.key("F2")
        self.wait_for("a message", lambda: "cornell-box-0001" in self.text(self.errors))
        self.assertNotIn("saved", self.text(self.errors))
        os.mkdir(self.folder)  # the cleanup needs the folder
        # The window continues to work after the error.
        self.key("plus")
        self.wait_for("the title", lambda: "exposure +0.5" in self.title())
        self.assertIsNone(self.process.poll())

    def test_interrupt_and_closing(self):
        self.start()
        self.process.send_signal(signal.SIGINT)
        self.assertEqual(self.wait_for_exit(), 0)

    def test_latency_log(self):
        log = os.path.join(self.folder, "latency.csv")
        result = waiting.run([PROGRAM, "view", os.path.join(SCENES, "cornell-box.json"), "--script-moves", "9",
                              "--log-latency", log], env=environment())
        self.assertEqual((result.returncode, result.stderr), (0, ""))
        self.assertRegex(result.stdout, r"^9 moves: first frame median [\d.]+ ms, 95 % [\d.]+ ms; full size median ")
        with open(log) as file:
            lines = file.read().splitlines()
        self.assertEqual(lines[0], "first_ms,first_width,first_height,full_ms")
        self.assertEqual(len(lines), 10)
        for line in lines[1:]:
            first, width, height, full = map(float, line.split(","))
            self.assertGreater(first, 0)
            self.assertGreaterEqual(full, first)
            self.assertTrue(width >= 400 and height >= 300)

    def refused(self, words, *arguments, program=None, **variables):
        env = environment()
        for name, value in variables.items():
            env.pop(name, None)
            if value is not None:
                env[name] = value
        result = waiting.run([program or PROGRAM, "view", os.path.join(SCENES, "cornell-box.json"), *arguments], env=env)
        self.assertEqual((result.returncode, result.stdout), (1, ""), result.stderr)
        self.assertEqual(len(result.stderr.splitlines()), 1, result.stderr)
        self.assertIn(words, result.stderr)

    def test_what_is_missing_is_said_in_one_line(self):
        self.refused("DISPLAY is not set", DISPLAY=None)
        self.refused("':987' can't be opened", DISPLAY=":987")
        self.refused("larger than", "--size", "60000x100")
        self.refused("--log-latency", "--log-latency", "/no/such/folder/log.csv")
        alone = shutil.copy(PROGRAM, self.folder)
        libraries = os.path.join(os.path.dirname(os.path.dirname(PROGRAM)), "lib")
        self.refused("libfathom_view.so is missing", program=alone, LD_LIBRARY_PATH=libraries)


def main():
    global PROGRAM, SCENES, FAKE_OIDN, DISPLAY
    PROGRAM, SCENES, FAKE_OIDN = [os.path.abspath(sys.argv.pop(1)) for _ in range(3)]
    missing = [program for program in NEEDED if not shutil.which(program)]
    if missing:
        print("skipped: not installed:", ", ".join(missing))
        sys.exit(77)
    read, write = os.pipe()
    server = subprocess.Popen(["Xvfb", "-displayfd", str(write), "-screen", "0", "1280x1024x24", "-nolisten", "tcp",
                               "-noreset"],
                              pass_fds=[write], stderr=subprocess.DEVNULL)
    os.close(write)
    try:
        with os.fdopen(read) as numbers:
            number = numbers.readline().strip()
        if not number:
            print("skipped: Xvfb doesn't start here")
            sys.exit(77)
        DISPLAY = ":" + number
        unittest.main(verbosity=2)
    finally:
        server.terminate()
        server.wait()


if __name__ == "__main__":
    main()
