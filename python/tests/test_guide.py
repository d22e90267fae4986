# SPDX-License-Identifier: Apache-2.0
"""Runs the code blocks of docs/python.md in order, as one program."""
import re

import numpy as np
import pytest

import fathom
from conftest import ROOT


@pytest.mark.filterwarnings("ignore::fathom.scene.SceneWarning")
def test_blocks_of_the_guide(tmp_path, monkeypatch, scene):
    scene.save(tmp_path / "model.glb")
    monkeypatch.chdir(tmp_path)
    text = (ROOT / "docs" / "python.md").read_text()
    blocks = re.findall(r"^```python\n(.*?)^```$", text, re.S | re.M)
    assert len(blocks) >= 10
    names = {}
    for block in blocks:
        line = text[:text.index(block)].count("\n")
        exec(compile("\n" * line + block, str(ROOT / "docs" / "python.md"), "exec"), names)
    assert names["film"].samples == [(0, 16)] and isinstance(names["image"], fathom.Image)
    assert names["whole"].hdr["beauty"].dtype == np.float32
    assert {"model.png", "bright.png", "all-layers.exr", "film.exr", "changed.json"} <= {file.name for file in tmp_path.iterdir()}
