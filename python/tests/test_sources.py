# SPDX-License-Identifier: Apache-2.0
import types

import numpy as np
import pytest

import fathom
from conftest import SMALL


def seen(image, name="albedo"):
    return image.hdr[name][np.isfinite(image.hdr["depth"])]


def test_arrays_with_up_axis(tetrahedron):
    y, z = (fathom.render(tetrahedron, **SMALL, up_axis=axis).hdr["depth"] for axis in "yz")
    assert not np.array_equal(y, z)


def test_open3d_like(tetrahedron):
    mesh = types.SimpleNamespace(vertices=tetrahedron[0].astype(float), triangles=tetrahedron[1].astype(np.int32),
                                 vertex_colors=np.tile([1.0, 0, 0], (4, 1)), vertex_normals=np.zeros((0, 3)))
    image = fathom.render(mesh, **SMALL, aov="albedo,depth", ground="none")
    assert np.allclose(np.median(seen(image), axis=0), (1, 0, 0), atol=0.02)


def test_open3d(tetrahedron):
    open3d = pytest.importorskip("open3d", exc_type=ImportError)
    mesh = open3d.geometry.TriangleMesh(open3d.utility.Vector3dVector(tetrahedron[0]), open3d.utility.Vector3iVector(tetrahedron[1]))
    plain = fathom.render(tetrahedron, **SMALL).hdr["beauty"]
    tensors = open3d.t.geometry.TriangleMesh.from_legacy(mesh)
    for form in mesh, tensors:
        assert np.array_equal(fathom.render(form, **SMALL).hdr["beauty"], plain), type(form)
    mesh.compute_vertex_normals()
    normals = np.asarray(mesh.vertex_normals)
    assert len(normals) == 4
    scene = fathom.Scene()
    scene.add_mesh(*tetrahedron, normals=normals)
    assert np.array_equal(fathom.sources.to_scene(mesh).meshes[0].normals, scene.meshes[0].normals)
    mesh.paint_uniform_color((188 / 255, 0, 0))  # half of 1 in sRGB
    image = fathom.render(mesh, **SMALL, aov="albedo,depth", ground="none")
    assert np.allclose(np.median(seen(image), axis=0), (0.503, 0, 0), atol=0.02)


def test_trimesh(tmp_path, tetrahedron, program):
    trimesh = pytest.importorskip("trimesh")
    mesh = trimesh.Trimesh(*tetrahedron, process=False)
    mesh.export(tmp_path / "a.ply")
    program("render", tmp_path / "a.ply", "--size", "64x48", "--spp", "2", "--up-axis", "y", "-q", "-o", tmp_path / "a.png")
    fathom.render(mesh, **SMALL).save(tmp_path / "b.png")
    assert (tmp_path / "a.png").read_bytes() == (tmp_path / "b.png").read_bytes()


def test_trimesh_colors_and_scenes(tetrahedron):
    trimesh = pytest.importorskip("trimesh")
    mesh = trimesh.Trimesh(*tetrahedron, process=False, face_colors=[[0, 0, 188, 255]] * 4)
    image = fathom.render(mesh, **SMALL, aov="albedo,depth", ground="none")
    assert np.allclose(np.median(seen(image), axis=0), (0, 0, 0.503), atol=0.01)  # 188 is half of 255 in sRGB
    scene = trimesh.Scene([trimesh.Trimesh(*tetrahedron), trimesh.Trimesh(tetrahedron[0] + 1, tetrahedron[1])])
    assert fathom.render(scene, **SMALL).rgb.any()


def test_pyvista():
    pyvista = pytest.importorskip("pyvista")
    data = pyvista.Sphere(theta_resolution=12, phi_resolution=12)
    data["height"] = data.points[:, 2]
    image = fathom.render(data, **SMALL, scalars="height", cmap="viridis", aov="albedo,depth", ground="none")
    assert seen(image).std() > 0.05
    cells = pyvista.ImageData(dimensions=(3, 3, 3))
    cells.cell_data["n"] = np.arange(8)
    assert fathom.render(cells, **SMALL).rgb.any()
    with pytest.raises(ValueError, match="height"):
        fathom.render(data, **SMALL, scalars="none")
