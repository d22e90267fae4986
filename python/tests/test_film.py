# SPDX-License-Identifier: Apache-2.0
import numpy as np
import pytest

import fathom


def test_parts_merge_to_the_whole(scene, tmp_path):
    whole = scene.render(size=(64, 48), spp=4, guiding=False, caustics=False)
    parts = [scene.render(size=(64, 48), spp=4, part=(k, 2), guiding=False, caustics=False) for k in (1, 2)]
    parts[1].film.save(tmp_path / "two.exr")
    film = parts[0].film.merge(tmp_path / "two.exr")
    assert film.samples == [(0, 4)] and np.array_equal(film.image().hdr["beauty"], whole.hdr["beauty"])


def test_resume(scene, tmp_path):
    whole = scene.render(size=(64, 48), spp=4)
    scene.render(size=(64, 48), spp=2).film.save(tmp_path / "a.exr")
    seen = []
    resumed = scene.render(size=(64, 48), spp=4, film=tmp_path / "a.exr", callback=lambda progress: seen.append(progress.samples))
    assert np.array_equal(resumed.hdr["beauty"], whole.hdr["beauty"]) and resumed.film.samples == [(0, 4)]
    assert seen[-1] == 2


def test_error_is_estimated(scene):
    coarse, fine = (scene.render(size=(96, 80), spp=spp, guiding=False, caustics=False) for spp in (4, 64))
    for image in (coarse, fine):
        assert 0 < image.error.low <= image.error.error <= image.error.high
    assert fine.error.error < 0.5 * coarse.error.error
    assert fine.film.error("worst-block").error > fine.error.error
    assert scene.render(size=(96, 80), spp=4, error="off").error is None
    with pytest.raises(ValueError, match="metric"):
        fine.film.error("median")


def test_program_merges_films_of_python(scene, tmp_path, program):
    for k in (1, 2):
        scene.render(size=(64, 48), spp=4, part=(k, 2), guiding=False, caustics=False).film.save(tmp_path / f"{k}.exr")
    program("merge", tmp_path / "1.exr", tmp_path / "2.exr", "-o", tmp_path / "all.exr")
    assert fathom.Film.load(tmp_path / "all.exr").samples_per_pixel == 4


def test_wrong_merges_change_nothing(scene):
    film = scene.render(size=(64, 48), spp=2).film
    with pytest.raises(fathom.Error):
        film.merge(film)
    with pytest.raises(fathom.Error, match="seed"):
        film.merge(scene.render(size=(64, 48), spp=2, seed=1).film)
    assert film.samples == [(0, 2)]
