# SPDX-License-Identifier: Apache-2.0
"""Runs the code blocks of docs/python.md, and of docs/datasets.md, in order as one program."""
import re

import numpy as np
import pytest

import fathom
from conftest import ROOT


def run_blocks(name, tmp_path, monkeypatch, scene):
    """Runs the blocks of a document in a folder with model.glb; returns their number and their names."""
    scene.save(tmp_path / "model.glb")
    monkeypatch.chdir(tmp_path)
    path = ROOT / "docs" / name
    text = path.read_text()
    blocks = re.findall(r"^```python\n(.*?)^```$", text, re.S | re.M)
    names = {}
    for block in blocks:
        line = text[:text.index(block)].count("\n")
        exec(compile("\n" * line + block, str(path), "exec"), names)
    return len(blocks), names


@pytest.mark.filterwarnings("ignore::fathom.scene.SceneWarning")
def test_blocks_of_the_guide(tmp_path, monkeypatch, scene):
    count, names = run_blocks("python.md", tmp_path, monkeypatch, scene)
    assert count >= 10
    assert names["film"].samples == [(0, 16)] and isinstance(names["image"], fathom.Image)
    assert names["whole"].hdr["beauty"].dtype == np.float32
    assert {"model.png", "bright.png", "all-layers.exr", "film.exr", "changed.json"} <= {file.name for file in tmp_path.iterdir()}


@pytest.mark.filterwarnings("ignore::fathom.scene.SceneWarning")
def test_blocks_on_data_sets(tmp_path, monkeypatch, scene, capsys):
    count, names = run_blocks("datasets.md", tmp_path, monkeypatch, scene)
    assert count == 1 and names["view"].index == 3
    assert {"0.png", "1.png", "2.png", "3.png"} <= {file.name for file in tmp_path.iterdir()}
    assert "pixels are visible" in capsys.readouterr().out
