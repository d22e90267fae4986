# SPDX-License-Identifier: Apache-2.0
"""Runs the Python code blocks of the README, docs/python.md, docs/datasets.md and docs/diff.md in order, as one program each."""
import re

import numpy as np
import pytest

import fathom
from conftest import ROOT


@pytest.fixture
def run_blocks(tmp_path, monkeypatch, scene):
    """Runs the blocks of a page in a folder with model.glb, and returns their number and variables."""
    scene.save(tmp_path / "model.glb")
    monkeypatch.chdir(tmp_path)

    def run(page):
        text = page.read_text()
        blocks = re.findall(r"^```python\n(.*?)^```$", text, re.S | re.M)
        names = {}
        for block in blocks:
            line = text[:text.index(block)].count("\n")
            exec(compile("\n" * line + block, str(page), "exec"), names)
        return len(blocks), names

    return run


@pytest.mark.filterwarnings("ignore::fathom.scene.SceneWarning")
def test_block_of_the_readme(tmp_path, run_blocks):
    count, _ = run_blocks(ROOT / "README.md")
    assert count == 1 and (tmp_path / "model.png").stat().st_size > 1000


@pytest.mark.filterwarnings("ignore::fathom.scene.SceneWarning")
def test_blocks_of_the_guide(tmp_path, run_blocks):
    count, names = run_blocks(ROOT / "docs" / "python.md")
    assert count >= 10
    assert names["film"].samples == [(0, 16)] and isinstance(names["image"], fathom.Image)
    assert names["whole"].hdr["beauty"].dtype == np.float32
    assert {"model.png", "bright.png", "all-layers.exr", "film.exr", "changed.json"} <= {file.name for file in tmp_path.iterdir()}


@pytest.mark.filterwarnings("ignore::fathom.scene.SceneWarning")
def test_blocks_on_data_sets(tmp_path, run_blocks, capsys):
    count, names = run_blocks(ROOT / "docs" / "datasets.md")
    assert count == 1 and names["view"].index == 3
    assert {"0.png", "1.png", "2.png", "3.png"} <= {file.name for file in tmp_path.iterdir()}
    assert "pixels are visible" in capsys.readouterr().out


@pytest.mark.filterwarnings("ignore::fathom.scene.SceneWarning")
def test_blocks_on_differences(tmp_path, run_blocks):
    for name, seed in (("new.png", 1), ("old.png", 2)):
        fathom.render("model.glb", size=(32, 24), spp=2, seed=seed).save(tmp_path / name)
    count, names = run_blocks(ROOT / "docs" / "diff.md")
    assert count == 1 and not names["difference"].same
    assert (tmp_path / "diff.png").stat().st_size > 100
