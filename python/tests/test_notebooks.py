# SPDX-License-Identifier: Apache-2.0
"""Runs the example notebooks, and the live image, in a Jupyter kernel."""
import pytest

from conftest import ROOT

nbclient = pytest.importorskip("nbclient")
nbformat = pytest.importorskip("nbformat")
pytest.importorskip("ipykernel")


def run(notebook):
    nbclient.NotebookClient(notebook, timeout=120, kernel_name="python3").execute()
    return [output for cell in notebook.cells if cell.cell_type == "code" for output in cell.outputs]


@pytest.mark.parametrize("name", ["first_images", "scene", "samples"])
def test_notebook(name):
    outputs = run(nbformat.read(ROOT / "python" / "notebooks" / f"{name}.ipynb", as_version=4))
    assert any("image/png" in output.get("data", {}) for output in outputs)


def test_live_image():
    code = """
import fathom, IPython.display
from fathom.progress import LiveImage
LiveImage.first_s = LiveImage.interval_s = 0
seen = []
scene = fathom.Scene()
scene.add(sphere={"radius": 1})
image = scene.render(size=(32, 24), spp=8, callback=lambda progress: seen.append(1))
"""
    notebook = nbformat.v4.new_notebook(cells=[nbformat.v4.new_code_cell(code)])
    output, = run(notebook)
    assert output.output_type == "display_data" and output.data == {"text/html": "", "text/plain": output.data["text/plain"]}
