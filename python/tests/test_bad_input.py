# SPDX-License-Identifier: Apache-2.0
"""Each wrong argument raises one exception of the right type with one clear line, and changes nothing."""
import numpy as np
import pytest

import fathom
from conftest import SMALL

V = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], np.float32)
F = np.array([[0, 2, 1], [0, 1, 3]], np.uint32)


def nan(rows):
    rows = rows.copy()
    rows[2, 1] = np.nan
    return rows


@pytest.mark.parametrize("arguments, kind, message", [
    (dict(vertices=V[:, :2]), ValueError, r"vertices: expected shape \(n, 3\), found \(4, 2\)"),
    (dict(vertices=V.reshape(-1)), ValueError, "vertices: expected shape"),
    (dict(vertices=V.astype(str)), TypeError, "vertices: expected numbers"),
    (dict(vertices=V.astype(complex)), TypeError, "vertices: expected numbers"),
    (dict(vertices=[[object()] * 3]), TypeError, "vertices: expected numbers"),
    (dict(vertices=nan(V)), ValueError, "vertices: row 2 has a value that is NaN"),
    (dict(vertices=V.astype(float) * 1e300), ValueError, "vertices: row 1 .*too large for float32"),
    (dict(vertices=V[:0]), ValueError, "but there are 0 vertices"),
    (dict(faces=F[:0]), ValueError, "at least one triangle"),
    (dict(faces=F.astype(float)), TypeError, "faces: expected integers"),
    (dict(faces=F + 2), ValueError, r"faces: row 0 is \[2, 4, 3\], but there are 4 vertices"),
    (dict(faces=F.astype(int) - 1), ValueError, "faces: row 0 is"),
    (dict(faces=np.zeros((2, 4), int)), ValueError, "split polygons"),
    (dict(normals=V[:3]), ValueError, "normals: expected 4 rows"),
    (dict(normals=nan(V)), ValueError, "normals: row 2"),
    (dict(uvs=V), ValueError, r"uvs: expected shape \(n, 2\)"),
    (dict(colors=V[:, :2]), ValueError, "colors: expected shape"),
    (dict(colors=np.zeros((3, 3), np.uint8)), ValueError, "colors: expected 4 rows"),
    (dict(transform=np.eye(3)), ValueError, r"transform: expected shape \(4, 4\)"),
    (dict(transform=np.ones((4, 4))), ValueError, "the last row"),
    (dict(transform=np.diag([1, np.inf, 1, 1])), ValueError, "NaN or infinite"),
    (dict(material="red"), TypeError, "material: expected a fathom.Material"),
])
def test_add_mesh(scene, arguments, kind, message):
    before = scene._core.counts(), scene.render(**SMALL).hdr["beauty"]
    with pytest.raises(kind, match=message) as raised:
        scene.add_mesh(**{**dict(vertices=V, faces=F), **arguments})
    assert "\n" not in str(raised.value)
    assert (scene._core.counts()) == before[0] and np.array_equal(scene.render(**SMALL).hdr["beauty"], before[1])


@pytest.mark.parametrize("vertices, faces", [
    (np.asfortranarray(V), np.asfortranarray(F)),
    (np.repeat(V, 2, axis=0)[::2], np.repeat(F, 2, axis=1)[:, ::2]),
    (V[::-1][::-1], F.astype(np.int8)),
    (V.astype(np.float64), F.astype(np.int64)),
    (V.astype(">f4"), F.astype(">u4")),
    (V.tolist(), F.tolist()),
    (V.astype(int), F),
])
def test_layouts_give_the_same_mesh(vertices, faces):
    mesh = fathom.Scene().add_mesh(vertices, faces)
    assert np.array_equal(mesh.vertices, V) and np.array_equal(mesh.faces, F)


@pytest.mark.parametrize("make, message", [
    (lambda: fathom.Material(colr=1), "unknown key 'colr'.*did you mean 'color'"),
    (lambda: fathom.Material("glas"), "did you mean 'glass'"),
    (lambda: fathom.Material(roughness=2), "roughness: must be between 0 and 1"),
    (lambda: fathom.Material(roughness=float("nan")), "roughness"),
    (lambda: fathom.Material(color=(1, 2)), "color"),
    (lambda: fathom.Material(color={"value": 1, "textur": "a"}), "textur"),
    (lambda: fathom.Texture("a.png", wrap_u="repeatt"), "wrap_u.*did you mean .repeat"),
    (lambda: fathom.Light("point", intensiti=3), "intensity"),
    (lambda: fathom.Light("spot", inner_angle_deg=50, outer_angle_deg=40), "outer_angle_deg"),
    (lambda: fathom.Camera.look_at((1, 1, 1), (1, 1, 1)), "same point"),
    (lambda: fathom.Camera(fov_y_deg=200), "fov_y_deg"),
    (lambda: fathom.Environment("skyy"), "sky"),
])
def test_parameters(make, message):
    with pytest.raises(fathom.ParameterError, match=message) as raised:
        make()
    assert isinstance(raised.value, ValueError) and isinstance(raised.value, fathom.Error) and raised.value.file


def test_scene_can_be_corrected_after_an_error(scene):
    expected = scene.render(**SMALL).hdr["beauty"]
    scene.mesh.set_motion([(0, np.eye(4)), (1, np.diag([-1, 1, 1, 1]))])
    with pytest.raises(fathom.Error):
        scene.render(**SMALL)
    scene.mesh.set_motion([])
    assert np.allclose(scene.render(**SMALL).hdr["beauty"], expected, atol=1e-3)


def test_wrong_change_keeps_the_old_value(scene):
    material = scene.mesh.material
    with pytest.raises(fathom.ParameterError):
        material.color = (2, 0, 0)
    with pytest.raises(fathom.ParameterError):
        material.shininess = 1
    assert material.color == (0.8, 0.1, 0.1)


@pytest.mark.parametrize("pixels, kind", [
    (np.zeros((2, 2, 5), np.uint8), ValueError),
    (np.zeros((0, 2, 3), np.uint8), ValueError),
    (np.zeros((2, 2, 4), np.float32), ValueError),
    (np.full((2, 2, 3), np.nan), ValueError),
    (np.zeros((2, 2, 3), np.int64), TypeError),
])
def test_texture_arrays(pixels, kind):
    with pytest.raises(kind, match="an image"):
        fathom.Texture(pixels)


@pytest.mark.parametrize("options, kind, message", [
    (dict(sp=3), TypeError, "unexpected option 'sp'; did you mean 'spp'"),
    (dict(turntable=3), TypeError, "orbit= in a loop"),
    (dict(output="a.png"), TypeError, r"Image.save\(\)"),
    (dict(up_axis="z"), TypeError, "up_axis"),
    (dict(spp=0), ValueError, "^spp: expected"),
    (dict(size="64"), ValueError, "^size"),
    (dict(size=(64, -1)), ValueError, "^size"),
    (dict(look_from=(1, 2)), ValueError, "look_from"),
    (dict(orbit=(0, 0), camera="x"), ValueError, "^orbit, view: .*look_from"),
    (dict(camera="none"), fathom.Error, "none"),
    (dict(spp=[[1]]), TypeError, "spp: expected a number"),
    (dict(seed=True), TypeError, "seed"),
    (dict(callback=3), TypeError, "callback"),
    (dict(aov="dept"), ValueError, "depth"),
])
def test_render_options(scene, options, kind, message):
    with pytest.raises(kind, match=message):
        scene.render(**{**SMALL, **options})
    assert scene.render(**SMALL).rgb.any()


@pytest.mark.parametrize("x", [3, None, object(), (V,), {"vertices": V}])
def test_unknown_things(x):
    with pytest.raises(TypeError, match="takes a path"):
        fathom.render(x)


def test_files(tmp_path):
    with pytest.raises(fathom.Error, match="no such file") as raised:
        fathom.render(tmp_path / "none.glb")
    assert raised.value.file == str(tmp_path / "none.glb")
    (tmp_path / "bad.json").write_text('{"fathom": 1, "camera": {"positoin": [0, 0, 0]}}')
    with pytest.raises(fathom.Error, match="position") as raised:
        fathom.load(tmp_path / "bad.json")
    assert raised.value.place == "/camera/positoin"
    with pytest.raises(fathom.Error):
        fathom.render(b"glTF\2\0\0\0 damaged")
    with pytest.raises(fathom.Error):
        fathom.render(b"")


def test_save_errors(scene, tmp_path):
    image = scene.render(**SMALL)
    with pytest.raises(fathom.Error, match="none"):
        image.save(tmp_path / "none" / "a.png")
    with pytest.raises(fathom.Error, match="xyz"):
        image.save(tmp_path / "a.xyz")
    with pytest.raises(TypeError, match="did you mean 'quality'"):
        image.save(tmp_path / "a.jpg", qualiti=3)
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("arguments, kind", [((), TypeError), ((0,), ValueError), ((1, 1), TypeError), ((1.5,), ValueError)])
def test_more(scene, arguments, kind):
    with pytest.raises(kind):
        scene.render(**SMALL).more(*arguments)
