# SPDX-License-Identifier: Apache-2.0
import os
import signal
import threading
import time

import numpy as np
import pytest

import fathom

# Guiding and light tracing would begin with trials of a second.
LONG = dict(size=(128, 96), spp=1 << 20, guiding=False, caustics=False)


def interrupt_after(seconds):
    timer = threading.Timer(seconds, lambda: os.kill(os.getpid(), signal.SIGINT))
    timer.start()
    return timer


def test_interrupt_keeps_the_image(scene):
    scene.render(size=(128, 96), spp=1)
    timer = interrupt_after(1)
    begin = time.monotonic()
    with pytest.raises(KeyboardInterrupt) as raised:
        scene.render(**LONG)
    timer.join()
    assert isinstance(raised.value, fathom.Interrupted) and time.monotonic() - begin < 6
    image = raised.value.image
    done = image.film.samples_per_pixel
    assert done >= 1 and image.rgb.any()
    assert image.more(1).film.samples_per_pixel == done + 1


def test_exceptions_of_callbacks_stop_the_render(scene):
    def fail(progress):
        raise ZeroDivisionError("from the callback")

    with pytest.raises(ZeroDivisionError, match="from the callback"):
        scene.render(**LONG, callback=fail)
    assert scene.render(size=(16, 16), spp=1).rgb.any()


def test_callback(scene):
    seen = []

    def look(progress):
        seen.append((progress.samples, progress.total, progress.elapsed, progress.rgb.shape, progress))

    scene.render(size=(64, 48), spp=64, callback=look)
    assert seen[-1][:2] == (64, 64) and seen[-1][3] == (48, 64, 3)
    with pytest.raises(RuntimeError, match="inside the callback"):
        seen[-1][4].rgb


def test_other_threads_run(scene):
    counts = []

    def count():
        for _ in range(20):
            counts.append(time.monotonic())
            time.sleep(0.01)

    thread = threading.Thread(target=count)
    thread.start()
    scene.render(size=(128, 96), time=0.4)
    end = time.monotonic()
    thread.join()
    assert sum(1 for at in counts if at < end) >= 10


def test_scene_that_is_rendered_cannot_be_changed(scene):
    errors = []

    def change(progress):
        for action in (lambda: setattr(scene.mesh, "transform", np.eye(4)), lambda: scene.render(size=(8, 8), spp=1)):
            with pytest.raises(RuntimeError, match="being rendered"):
                action()
            errors.append(action)

    scene.render(size=(64, 48), spp=1, callback=change)
    assert len(errors) >= 2


def test_image_that_gets_samples_keeps_its_scene(scene):
    image = scene.render(size=(64, 48), spp=1)
    scene.mesh.transform = np.eye(4)
    seen = []

    def disturb(progress):
        for action in (lambda: scene.render(size=(64, 48), spp=1), lambda: image.more(1), lambda: image.film.samples,
                       lambda: image.detach()):
            with pytest.raises(RuntimeError, match="being rendered"):
                action()
        seen.append((progress.samples, progress.total))

    image.more(3, callback=disturb)
    assert seen[-1] == (3, 3) and image.film.samples_per_pixel == 4


def test_two_scenes_in_two_threads(scene, tetrahedron):
    other = fathom.Scene()
    other.add_mesh(*tetrahedron)
    expected = scene.render(size=(64, 48), spp=4).hdr["beauty"]
    results = []
    threads = [threading.Thread(target=lambda s=s: results.append((s, s.render(size=(64, 48), spp=4)))) for s in (scene, other)]
    [thread.start() for thread in threads]
    [thread.join() for thread in threads]
    assert np.array_equal(dict((id(s), image) for s, image in results)[id(scene)].hdr["beauty"], expected)


def test_bar_of_the_caller(scene):
    class Bar:
        n, total, closed = 0, None, False

        def update(self, count):
            self.n += count

        def close(self):
            self.closed = True

    bar = Bar()
    scene.render(size=(64, 48), spp=8, progress=bar)
    assert (bar.n, bar.total, bar.closed) == (8, 8, True)
