# SPDX-License-Identifier: Apache-2.0
import json
import math
import re
import subprocess

import numpy as np
import pytest

import fathom
from conftest import ROOT, SMALL


def codes(*shape):
    return np.random.default_rng(1).integers(0, 200, shape, np.uint8)


def test_numbers_of_arrays():
    a = np.full((6, 8, 3), 0.5, np.float32)
    b = a.copy()
    b[4, 7, 1] = 0.75
    found = fathom.diff(a, b)
    assert not found.same and found.different_pixels == 1 and found.largest == 0.25 and found.largest_at == (7, 4)
    assert found.mse == pytest.approx(0.25**2 / a.size)
    assert found.psnr == pytest.approx(10 * math.log10(0.75**2 / found.mse))
    assert found.relmse == pytest.approx(0.25**2 / (0.75**2 + 0.01) / a.size)
    assert found.flip == pytest.approx(found.flip_map.mean()) and found.flip_map.shape == (6, 8)
    assert found.map[4, 7] == 0.25 and np.count_nonzero(found.map) == 1 and not found.map.flags.writeable
    assert found.explained_by_noise is None and found.changed_blocks == []
    assert "largest difference 0.25 in G of pixel 7,4" in str(found)
    assert fathom.diff(a, b, tolerance=0.25).same


def test_equal_arrays():
    a = codes(5, 4, 3)
    found = fathom.diff(a, a)
    assert found.same and found.psnr == math.inf and found.flip == 0 and found.largest == 0


def test_display_values_are_scaled():
    a = codes(5, 4, 4)
    assert fathom.diff(a, a.astype(np.uint16) * 257).same
    b = a.copy()
    b[..., 0] += 51
    assert fathom.diff(a, b).largest == pytest.approx(0.2)
    gray = codes(5, 4)
    assert fathom.diff(gray, np.dstack([gray] * 3)).same


def test_the_program_finds_the_same(tmp_path, scene, program):
    one, two = scene.render(**SMALL, seed=1), scene.render(**SMALL, seed=2)
    one.save(tmp_path / "1.exr"), two.save(tmp_path / "2.exr")
    try:
        text = program("diff", tmp_path / "1.exr", tmp_path / "2.exr", "--json").stdout
    except subprocess.CalledProcessError as different:
        assert different.returncode == 1
        text = different.stdout
    theirs, ours = json.loads(text), fathom.diff(tmp_path / "1.exr", tmp_path / "2.exr").numbers
    assert ours == theirs
    in_memory = fathom.diff(one, two)
    assert in_memory.numbers["flip"] == theirs["flip"] and in_memory.different_pixels == theirs["different_pixels"] > 0
    arrays = fathom.diff(one.hdr["beauty"], two.hdr["beauty"])
    assert arrays.relmse == in_memory.relmse


def test_noise_and_change(scene):
    settings = dict(size=(64, 48), spp=64)
    one, two = scene.render(**settings), scene.render(**{**settings, "spp": 16}, seed=1)
    assert fathom.diff(two, one).explained_by_noise is True
    scene.mesh.material.color = (0.6, 0.1, 0.1)
    found = fathom.diff(scene.render(**settings, seed=2), one)
    assert found.explained_by_noise is False
    assert "noise does not explain" in str(found)


def test_layers(scene):
    one, two = (scene.render(**SMALL, seed=seed, aov="depth") for seed in (1, 2))
    found = fathom.diff(one, two, layer="depth")
    assert found.flip is None and found.flip_map is None and found.psnr is None and found.map.shape == (48, 64)
    with pytest.raises(fathom.Error, match="reference: it has no layer 'depth'"):
        fathom.diff(one, two.hdr["beauty"], layer="depth")


def test_save(tmp_path):
    a = codes(40, 300, 3)
    b = a.copy()
    b[:10] += 50
    found = fathom.diff(a, b)
    found.save(tmp_path / "d.png"), found.save(tmp_path / "d.exr")
    assert fathom.diff(tmp_path / "d.exr", found.flip_map).same


@pytest.mark.parametrize("value, error, message", [
    (np.zeros((3, 4, 2), np.uint8), ValueError, r"image: expected shape .* found \(3, 4, 2\)"),
    (np.zeros((0, 4, 3), np.uint8), ValueError, "image: expected shape"),
    (np.zeros(4), ValueError, "image: expected shape"),
    (np.zeros((3, 4), np.int64), TypeError, "image: expected .* found int64"),
    (np.zeros((3, 4), bool), TypeError, "image: expected .* found bool"),
    (object(), TypeError, "image: expected .* found object"),
    (np.zeros((3, 5, 3), np.uint8), fathom.Error, "the image is 5x3, but reference is 4x3"),
    (np.zeros((3, 4, 3), np.float32), fathom.Error, "the image is linear radiance, but reference is tone mapped"),
    ("missing.png", fathom.Error, "missing.png"),
])
def test_bad_input(value, error, message):
    with pytest.raises(error, match=message):
        fathom.diff(value, np.zeros((3, 4, 3), np.uint8))


def test_values_that_are_not_numbers():
    a, b = np.ones((3, 4, 3)), np.ones((3, 4, 3))
    a[1, 2, 0] = np.nan
    assert fathom.diff(a, a).same
    found = fathom.diff(a, b, tolerance=10)
    assert not found.same and found.largest == math.inf and found.numbers["invalid_pixels"] == 1 and found.flip_map[1, 2] == 1
    with pytest.raises(ValueError, match="tolerance"):
        fathom.diff(a, b, tolerance=math.nan)


def test_block_of_the_guide(tmp_path, monkeypatch, scene):
    monkeypatch.chdir(tmp_path)
    for name, seed in (("new", 1), ("old", 2)):
        scene.render(**SMALL, seed=seed).save(f"{name}.png")
    block, = re.findall(r"^```python\n(.*?)^```$", (ROOT / "docs" / "diff.md").read_text(), re.S | re.M)
    names = {}
    exec(block, names)
    assert names["difference"].flip > 0 and (tmp_path / "diff.png").exists()


def test_render_refuses_the_options_of_the_program(scene):
    with pytest.raises(TypeError, match="fathom.diff"):
        scene.render(**SMALL, reference="a.png")
