# SPDX-License-Identifier: Apache-2.0
import pickle
import warnings

import numpy as np
import pytest

import fathom
from conftest import ROOT, SMALL


def moved(x):
    matrix = np.eye(4)
    matrix[0, 3] = x
    return matrix


def compiled_whole(scene):
    return scene._core.was_compiled_whole()


@pytest.fixture
def room(scene):
    """The scene on a floor, so that its extent doesn't depend on the mesh."""
    scene.add(box={"min": (-5, -1, -5), "max": (5, -0.9, 5)})
    return scene


def test_later_moves_compile_only_the_mesh(room):
    scene = room
    before = scene.render(**SMALL).hdr["beauty"]
    scene.mesh.transform = moved(0.2)
    scene.render(**SMALL)
    scene.mesh.transform = moved(0.4)
    after = scene.render(**SMALL).hdr["beauty"]
    assert not compiled_whole(scene) and not np.array_equal(before, after)
    assert np.array_equal(scene.mesh.transform, moved(0.4))


def test_moves_compile_only_the_mesh_while_old_images_exist(room):
    scene = room
    images = [scene.render(**SMALL)]
    for x in (0.1, 0.2, 0.3):
        scene.mesh.transform = moved(x)
        images.append(scene.render(**SMALL))
    assert not compiled_whole(scene) and len(images) == 4


def test_edited_scene_has_the_bits_of_a_new_one(scene, tetrahedron):
    scene.render(**SMALL)
    for x in (0.2, 0.4):
        scene.mesh.transform = moved(x)
        scene.mesh.material.color = (0.1, x, 0.3)
        edited = scene.render(**SMALL).hdr["beauty"]
    new = pickle.loads(pickle.dumps(scene))
    new.meshes[0].transform = new.meshes[0].transform  # movable, as in the edited scene
    assert np.array_equal(new.render(**SMALL).hdr["beauty"], edited)


def test_material_changes(scene):
    red = scene.render(**SMALL).hdr["beauty"]
    scene.mesh.material.color = (0.1, 0.1, 0.8)
    blue = scene.render(**SMALL).hdr["beauty"]
    assert not compiled_whole(scene)
    assert red[..., 0].mean() > blue[..., 0].mean() and red[..., 2].mean() < blue[..., 2].mean()
    scene.mesh.material = fathom.Material("glass")
    assert scene.mesh.material.kind == "glass"
    scene.render(**SMALL)


def test_material_shared_by_two_scenes(scene, tetrahedron):
    other = fathom.Scene()
    other.environment = fathom.Environment("constant")
    other.add_mesh(*tetrahedron, material=scene.mesh.material)
    scene.mesh.material.update(color=0)
    for each in (scene, other):
        image = each.render(**SMALL, aov="albedo,depth")
        assert image.hdr["albedo"][np.isfinite(image.hdr["depth"])].max() == 0


def test_vertices(scene):
    before = scene.render(**SMALL).hdr["depth"]
    for scale in (0.5, 0.4):
        scene.mesh.vertices = scene.mesh.vertices * scale
        after = scene.render(**SMALL).hdr["depth"]
    assert not compiled_whole(scene) and np.isfinite(after).sum() < np.isfinite(before).sum()


def test_camera_and_lights(scene):
    scene.environment = None
    lamp = scene.add_light("point", position=(2, 3, 2), intensity=30)
    first = scene.render(**SMALL, exposure=0).hdr["beauty"]
    lamp.intensity = 60
    second = scene.render(**SMALL, exposure=0).hdr["beauty"]
    assert np.allclose(second, 2 * first, rtol=1e-3, atol=1e-6) and first.max() > 0
    scene.camera.update(position=(0.3, 0.3, 9))
    assert scene.render(**SMALL).hdr["depth"].min() > 7
    scene.camera = fathom.Camera("orthographic", position=(0, 0, 5), look_at=(0, 0, 0), height=3)
    assert scene.camera.kind == "orthographic" and scene.render(**SMALL).hdr["depth"].min() < 6
    assert scene.lights == [lamp]


def test_camera_moves_without_compiling(scene):
    scene.render(**SMALL)
    prepared = scene.render(**SMALL)
    scene.camera.position = (2, 2, 4)
    moved_camera = scene.render(**SMALL)
    assert prepared.more(1) and not np.array_equal(prepared.hdr["depth"], moved_camera.hdr["depth"])


def test_textures_from_arrays(scene):
    pixels = np.zeros((2, 2, 3), np.uint8)
    pixels[..., 1] = 255
    uvs = np.array([[0, 0], [1, 0], [0, 1], [1, 1]], np.float32)
    mesh = scene.add_mesh(scene.mesh.vertices * 1.1, scene.mesh.faces, uvs=uvs,
                          material=fathom.Material(color=fathom.Texture(pixels, lookup="nearest"), roughness=1))
    image = scene.render(**SMALL, aov="albedo,depth")
    seen = image.hdr["albedo"][np.isfinite(image.hdr["depth"])]
    assert np.allclose(np.median(seen, axis=0), (0, 1, 0), atol=0.02)
    images = scene._core.counts()["images"]
    mesh.material.color = pixels.copy()  # an equal image is stored once
    assert scene._core.counts()["images"] == images
    scene.environment = np.ones((2, 4, 3), np.float32)
    assert scene.render(**SMALL).hdr["beauty"].max() > 0.5


def test_environment_from_file(scene, tmp_path):
    fathom.render(ROOT / "scenes" / "cornell-box.json", **SMALL).save(tmp_path / "a.hdr")
    scene.environment = tmp_path / "a.hdr"
    assert scene.render(**SMALL).rgb.any()


def test_nodes_of_scene_files(scene):
    scene.add(sphere={"center": (0, 0, -1), "radius": 0.5}, material=fathom.Material("metal", conductor="gold"))
    node = scene.add(children=[{"box": {"min": (-3, -1, -3), "max": (3, -0.9, 3)}}])
    scene.add_instance(scene.mesh, moved(1.5))
    assert len(node.world_transforms) == 1
    ids = scene.render(**SMALL, aov="instance").hdr["instance"]
    assert len(np.unique(ids)) >= 3


def test_motion_blur(scene):
    still = scene.render(**SMALL).hdr["beauty"]
    scene.mesh.set_motion([(0, moved(0)), (1, moved(1))])
    scene.camera.shutter = (0, 1)
    assert not np.array_equal(scene.render(**SMALL).hdr["beauty"], still)
    scene.mesh.set_motion([])
    scene.mesh.set_vertex_motion([(0, scene.mesh.vertices), (1, scene.mesh.vertices * 2)])
    assert not np.array_equal(scene.render(**SMALL).hdr["beauty"], still)


def test_load_gives_arrays_back(scene, tmp_path, tetrahedron):
    scene.mesh.transform = moved(2)
    scene.save(tmp_path / "a.json")
    loaded = fathom.load(tmp_path / "a.json")
    mesh, = loaded.meshes
    assert np.array_equal(mesh.vertices, tetrahedron[0]) and np.array_equal(mesh.faces, tetrahedron[1])
    assert mesh.normals is None and mesh.uvs is None and np.array_equal(mesh.world_transforms[0], moved(2))
    assert mesh.material.color == [0.8, 0.1, 0.1] and loaded.camera["look_at"] == [0.3, 0.3, 0.3]
    assert loaded.environment.kind == "constant" and loaded.materials == [mesh.material]
    mesh.material.color = 0.5
    assert loaded.render(**SMALL).rgb.any()


def test_pickle(scene):
    scene.add_mesh(scene.mesh.vertices + 1, scene.mesh.faces, uvs=np.zeros((4, 2)),
                   material=fathom.Material(color=np.full((2, 2, 3), 200, np.uint8)))
    scene.add_light("spot", position=(0, 4, 0), direction=(0, -1, 0), intensity=5)
    expected = scene.render(**SMALL).hdr["beauty"]
    copy = pickle.loads(pickle.dumps(scene))
    assert np.array_equal(copy.render(**SMALL).hdr["beauty"], expected)
    material = pickle.loads(pickle.dumps(scene.mesh.material))
    assert material == scene.mesh.material


def test_pickle_contains_image_files(scene, tmp_path):
    scene.render(**SMALL).save(tmp_path / "a.png")
    scene.mesh.material.color = fathom.Texture(tmp_path / "a.png")
    data = pickle.dumps(scene)
    (tmp_path / "a.png").unlink()
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert pickle.loads(data).render(**SMALL).rgb.any()


def test_textures_of_a_loaded_scene_stay_there(scene, tmp_path, tetrahedron):
    scene.mesh.material.color = np.full((2, 2, 3), 200, np.uint8)
    scene.save(tmp_path / "a.json")
    loaded = fathom.load(tmp_path / "a.json")
    material = loaded.meshes[0].material
    material.roughness = 0.5
    with pytest.raises(fathom.ParameterError):
        material.roughness = 5
    assert material.roughness == 0.5
    with pytest.raises(ValueError, match="another"):
        fathom.Scene().add_mesh(*tetrahedron, material=material)


def test_warnings_of_the_library(tmp_path):
    with pytest.warns(fathom.SceneWarning):
        scene = fathom.Scene()
        scene.add_mesh(np.eye(3), [[0, 1, 2]], uvs=np.zeros((3, 2)), material=fathom.Material(color=fathom.Texture(tmp_path / "none.png")))
        scene.render(**SMALL)
