# SPDX-License-Identifier: Apache-2.0
"""render_views(): cameras, ground truth and errors. tests/apps/dataset compares ground truth with other programs."""
import numpy as np
import pytest

import fathom
from conftest import SMALL


def center_rays(view):
    k, pose = view.intrinsics, view.world_from_camera
    height, width = view.depth.shape
    x, y = np.meshgrid(np.arange(width) + 0.5, np.arange(height) + 0.5)
    d = np.stack([(x - k[0, 2]) / k[0, 0], -(y - k[1, 2]) / k[1, 1], -np.ones_like(x)], -1) @ pose[:3, :3].T
    return pose[:3, 3], d / np.linalg.norm(d, axis=-1, keepdims=True)


def test_views_are_made_one_by_one(scene):
    views = fathom.render_views(scene, 3, "ring", **SMALL)
    first = next(views)
    assert first.index == 0 and first.image.rgba.shape == (48, 64, 4)
    beauty = first.image.hdr["beauty"]
    assert beauty[0, 0, 3] == 0 and (beauty[beauty[..., 3] == 0] == 0).all(), "the background is not transparent"
    scene.mesh.transform = np.diag([9, 9, 9, 1.0])
    rest = list(views)
    assert [view.index for view in rest] == [1, 2]
    assert np.isfinite(rest[0].depth).sum() < 0.9 * rest[0].depth.size
    heights = {round(view.world_from_camera[1, 3], 6) for view in [first, *rest]}
    assert len(heights) == 1


def test_arrays_belong_together(tetrahedron):
    for view in fathom.render_views(tetrahedron, 4, "sphere", flow=True, **SMALL):
        hit = view.instance > 0
        assert hit.any() and not hit.all()
        assert np.isinf(view.depth[~hit]).all() and (view.normal[~hit] == 0).all() and (view.material[~hit] == 0).all()
        origin, d = center_rays(view)
        np.testing.assert_allclose(view.position[hit], (origin + d * view.distance[..., None])[hit], atol=1e-4)
        forward = -view.world_from_camera[:3, 2]
        np.testing.assert_allclose(view.depth[hit], (view.distance * (d @ forward))[hit], rtol=1e-5)
        np.testing.assert_allclose(view.camera_normal[hit], view.normal[hit] @ view.world_from_camera[:3, :3], atol=1e-5)
        assert list(view.masks) == [1] and view.objects[0].transform.shape == (4, 4)
        assert (view.masks[1].visible == hit).all() and (view.masks[1].whole == hit).all()
        assert (view.flow_backward is None) == (view.index == 0)
        assert (view.flow_forward is None) == (view.index == 3)
        flow = view.flow_forward if view.flow_forward is not None else view.flow_backward
        assert (np.isnan(flow[..., 0]) == ~hit).all()


def test_layers_outlive_views(tetrahedron):
    depth = next(fathom.render_views(tetrahedron, 1, **SMALL)).depth
    assert np.isfinite(depth).any()
    with pytest.raises(ValueError):
        depth[0, 0] = 1


def test_given_cameras(scene):
    pose = np.eye(4)
    pose[:3, 3] = 0.2, 0.3, 4
    views = list(fathom.render_views(scene, cameras=[pose, pose], fov=30, size=(64, 48), spp=1))
    assert len(views) == 2
    np.testing.assert_allclose(views[0].world_from_camera, pose, atol=1e-9)
    np.testing.assert_allclose(views[0].intrinsics[1, 1], 24 / np.tan(np.radians(15)), rtol=1e-6)
    again = list(fathom.render_views(scene, cameras=np.stack([view.world_from_camera for view in views]), fov=30, size=(64, 48), spp=1))
    np.testing.assert_allclose(again[1].depth, views[1].depth, rtol=1e-5)


def test_equal_npz_files(program, tmp_path, tetrahedron):
    """The program's NPZ files have the same bits."""
    scene = fathom.Scene()
    scene.add_mesh(*tetrahedron, name="it")
    scene.save(tmp_path / "it.glb")
    program("render", tmp_path / "it.glb", "--views", 2, "--size", "64x48", "--spp", 2, "--dataset", "npz", "-o", tmp_path / "out")
    for view in fathom.render_views(tmp_path / "it.glb", 2, flow=True, **SMALL):
        file = np.load(tmp_path / f"out/{view.index:06}.npz")
        for name in ("depth", "distance", "normal", "position", "instance", "material", "intrinsics", "world_from_camera"):
            np.testing.assert_array_equal(file[name], getattr(view, name))
        np.testing.assert_array_equal(file["rgba"], view.image.rgba)


def test_ground_truth_of_render(scene):
    image = fathom.render(scene, ground_truth="depth,instance", **SMALL)
    depth = image.hdr["truth.depth"]
    assert depth.shape == (48, 64) and (np.isfinite(depth) == (image.hdr["truth.instance"] == 1)).all()
    filtered = image.hdr["depth"]
    assert (np.isfinite(depth) & np.isfinite(filtered)).any() and not np.array_equal(depth, filtered)


def test_errors(scene, tmp_path):
    with pytest.raises(TypeError, match="views, cameras and frames"):
        fathom.render_views(scene)
    with pytest.raises(TypeError, match="views, cameras and frames"):
        fathom.render_views(scene, 3, frames="0:1")
    with pytest.raises(TypeError, match="orbit"):
        fathom.render_views(scene, 3, orbit=(1, 2))
    with pytest.raises(TypeError, match=r"render_views\(\)"):
        fathom.render(scene, views=3)
    with pytest.raises(ValueError, match="on: expected sphere"):
        next(fathom.render_views(scene, 3, "cube"))
    with pytest.raises(ValueError, match="4, 4"):
        next(fathom.render_views(scene, cameras=np.zeros((3, 4))))
    with pytest.raises(ValueError, match="not finite"):
        next(fathom.render_views(scene, cameras=[np.full((4, 4), np.nan)]))
    with pytest.raises(fathom.Error, match="rotation"):
        next(fathom.render_views(scene, cameras=[np.zeros((4, 4))]))
    with pytest.raises(fathom.Error, match="nowhere"):
        next(fathom.render_views(scene, cameras=tmp_path / "nowhere.json"))
    with pytest.raises(fathom.Error, match="no animation"):
        next(fathom.render_views(scene, frames=(0, 1)))
