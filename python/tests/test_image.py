# SPDX-License-Identifier: Apache-2.0
import gc
import zlib

import numpy as np
import pytest

import fathom
from conftest import SMALL
from fathom.png import encode_pfm, encode_png


def test_arrays_share_memory_and_are_read_only(scene):
    image = scene.render(**SMALL)
    first, second = image.hdr["beauty"], image.hdr["beauty"]
    assert np.shares_memory(first, second) and not first.flags.writeable


def test_arrays_outlive_everything(scene):
    image = scene.render(**SMALL)
    depth, beauty, expected = image.hdr["depth"], image.hdr["beauty"], image.hdr["beauty"].copy()
    film = image.film
    del image, scene
    gc.collect()
    junk = [np.ones(depth.shape, np.float32) for _ in range(200)]
    assert np.array_equal(beauty, expected) and np.isfinite(depth).any() and film.samples_per_pixel == 2 and junk


@pytest.mark.parametrize("order", [(0, 1, 2, 3), (3, 2, 1, 0), (1, 3, 0, 2), (2, 0, 3, 1)])
def test_objects_die_in_any_order(scene, order):
    image = scene.render(**SMALL)
    alive = [scene, image, image.film, scene.mesh]
    vertices = scene.mesh.vertices
    del scene, image
    for index in order:
        alive[index] = None
        gc.collect()
        for thing in alive:
            if isinstance(thing, fathom.Image):
                thing.more(1)
            elif isinstance(thing, fathom.Mesh):
                assert np.array_equal(thing.vertices, vertices)
            elif isinstance(thing, fathom.Film):
                assert thing.samples_per_pixel >= 2
            elif thing is not None:
                thing.render(**SMALL)


def test_more_has_the_bits_of_one_render(scene):
    whole = scene.render(size=(64, 48), spp=5).hdr["beauty"]
    image = scene.render(**SMALL)
    before = image.hdr["beauty"]
    kept = before.copy()
    assert image.more(3) is image and np.array_equal(image.hdr["beauty"], whole)
    assert np.array_equal(before, kept)


def test_more_fails_after_a_change(scene):
    image = scene.render(**SMALL)
    scene.mesh.transform = np.diag([2, 2, 2, 1])
    image.more(1)  # the compiled scene is still that of the image
    scene.render(**SMALL)
    with pytest.raises(fathom.Error, match="its scene has changed"):
        image.more(1)
    assert image.film.samples_per_pixel == 3


def test_detach(scene):
    image = scene.render(**SMALL).detach()
    assert image.rgb.any()
    with pytest.raises(fathom.Error):
        image.more(1)


def test_missing_layer_says_what_to_do(scene):
    with pytest.raises(KeyError, match="aov='normal'"):
        scene.render(**SMALL).hdr["normal"]


def test_png_in_notebooks(scene):
    data = scene.render(**SMALL)._repr_png_()
    assert data.startswith(b"\x89PNG")


def test_pfm_encoder_writes_the_last_row_first():
    assert encode_pfm(np.array([[1, 2], [3, 4]])) == b"Pf\n2 2\n-1.0\n" + np.array([3, 4, 1, 2], "<f4").tobytes()


def test_png_encoder():
    pixels = np.arange(2 * 3 * 3, dtype=np.uint16).reshape(2, 3, 3) * 1000
    data = encode_png(pixels)
    begin = data.index(b"IDAT") + 4
    rows = np.frombuffer(zlib.decompress(data[begin:data.index(b"IEND") - 8]), np.uint8).reshape(2, -1)
    assert (rows[:, 0] == 0).all() and np.array_equal(rows[:, 1:].copy().view(">u2").reshape(2, 3, 3), pixels)
