# SPDX-License-Identifier: Apache-2.0
import json

import numpy as np
import pytest

import fathom
from conftest import ROOT, SMALL

SCENE = ROOT / "scenes" / "cornell-box.json"


@pytest.mark.filterwarnings("ignore::fathom.scene.SceneWarning")
def test_options_of_the_issue(tmp_path, scene):
    scene.save(tmp_path / "model.glb")
    image = fathom.render(str(tmp_path / "model.glb"), size=(96, 54), spp=4)
    image.save(tmp_path / "model.png")
    assert image.rgb.shape == (54, 96, 3) and image.rgb.dtype == np.uint8
    assert image.hdr["depth"].shape == (54, 96) and image.hdr["depth"].dtype == np.float32
    assert (tmp_path / "model.png").read_bytes().startswith(b"\x89PNG")


def test_same_png_as_program(tmp_path, program):
    program("render", SCENE, "--size", "64x48", "--spp", "3", "--seed", "7", "--aov", "depth", "-q", "-o", tmp_path / "a.exr", "-o",
            tmp_path / "a.png")
    fathom.render(SCENE, size=(64, 48), spp=3, seed=7).save(tmp_path / "b.png")
    assert (tmp_path / "a.png").read_bytes() == (tmp_path / "b.png").read_bytes()


def test_same_bits_as_program(tmp_path, program):
    program("render", SCENE, "--size", "64x48", "--spp", "3", "--aov", "depth", "--mergeable", "--caustics", "off", "-q", "-o", tmp_path / "a.exr")
    expected = fathom.Film.load(tmp_path / "a.exr").image()
    image = fathom.render(SCENE, size=(64, 48), spp=3, mergeable=True, caustics=False)
    for layer in ("beauty", "depth"):
        assert np.array_equal(image.hdr[layer].view(np.uint32), expected.hdr[layer].view(np.uint32))


def test_model_gets_camera_and_light_as_in_program(tmp_path, program, scene, tetrahedron):
    plain = fathom.Scene()
    plain.add_mesh(*tetrahedron)
    plain.save(tmp_path / "m.glb")
    program("render", tmp_path / "m.glb", "--size", "64x48", "--spp", "2", "-q", "-o", tmp_path / "a.png")
    image = fathom.render(tmp_path / "m.glb", **SMALL)
    image.save(tmp_path / "b.png")
    assert (tmp_path / "a.png").read_bytes() == (tmp_path / "b.png").read_bytes()
    assert any("camera" in note for note in image.notes) and any("studio" in note for note in image.notes)


@pytest.mark.filterwarnings("ignore::fathom.scene.SceneWarning")
def test_bytes_of_a_glb(tmp_path, scene):
    scene.save(tmp_path / "m.glb")
    by_path, by_bytes = (fathom.render(x, **SMALL) for x in (tmp_path / "m.glb", (tmp_path / "m.glb").read_bytes()))
    assert np.array_equal(by_path.hdr["beauty"], by_bytes.hdr["beauty"])


def test_time_limit(scene):
    image = scene.render(size=(16, 16), time=0.2)
    assert image.film.samples_per_pixel >= 1


def test_layers(scene):
    image = scene.render(**SMALL, aov=["albedo", "normal", "depth", "position", "instance", "material", "samples", "variance"])
    assert list(image.hdr) == ["beauty", "albedo", "normal", "depth", "position", "instance", "material", "variance", "samples"]
    assert image.hdr["position"].shape == (48, 64, 3) and (image.hdr["samples"] == 2).all()
    assert np.isinf(image.hdr["depth"]).any() and 1 < image.hdr["depth"].min() < 5


def test_alpha(scene):
    image = scene.render(**SMALL, background="transparent")
    assert image.hdr["beauty"].shape == (48, 64, 4) and image.rgba[0, 0, 3] == 0


def test_display_options(scene, tmp_path):
    bright, dark = (scene.render(**SMALL, exposure=stops).rgb.mean() for stops in (1, -2))
    assert bright > dark + 30
    image = scene.render(**SMALL, exposure=-2)
    image.save(tmp_path / "a.png")
    image.save(tmp_path / "b.png", exposure=1)
    assert (tmp_path / "a.png").read_bytes() != (tmp_path / "b.png").read_bytes()


def test_rgb_is_what_png_contains(scene, tmp_path):
    image = scene.render(**SMALL)
    image.save(tmp_path / "a.png")
    shown = pytest.importorskip("PIL.Image").open(tmp_path / "a.png")
    assert np.array_equal(np.asarray(shown.convert("RGB")), image.rgb)


def test_description_of_options():
    assert "spp: samples per pixel" in fathom.options.describe() and "turntable" not in fathom.options.describe()


def test_caustics_seen_through_glass(tmp_path):
    square = lambda material, y: {"material": material, "rectangle": {"corner": [-2, y, 2], "edge_u": [4, 0, 0], "edge_v": [0, 0, -4]}}
    pool = {"fathom": 1, "camera": {"position": [0, 4, 0.1], "look_at": [0, 0, 0]},
            "materials": {"floor": {"kind": "diffuse"}, "water": {"kind": "glass", "ior": 1.33}},
            "lights": {"bulb": {"kind": "point", "position": [0, 2, 0], "intensity": 5}}, "scene": [square("floor", 0), square("water", 0.5)]}
    (tmp_path / "pool.json").write_text(json.dumps(pool))
    options = dict(size=(16, 12), spp=16, guiding=False)
    with pytest.warns(UserWarning, match="seen through glass or in mirrors are missing"):
        dark = fathom.render(tmp_path / "pool.json", caustics=True, **options)
    merged = fathom.render(tmp_path / "pool.json", caustics="merged", **options)
    assert merged.hdr["beauty"].mean() > 10 * dark.hdr["beauty"].mean()
