# SPDX-License-Identifier: Apache-2.0
"""Scenes that are made in Python or read from files."""
from __future__ import annotations

import json
import os
import pathlib
import tempfile
import warnings
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from . import _fathom, arrays, options
from .parameters import Camera, Environment, Light, Material, checked, has_reference, to_json

if TYPE_CHECKING:
    from .image import Image


class SceneWarning(UserWarning):
    """Something is missing from the image, or different in it, than the scene says."""


def warn(counts: Mapping[str, int], depth: int = 3) -> None:
    """Issues warnings of the library; `depth` is the stack level of the caller's caller."""
    for message, count in counts.items():
        warnings.warn(message + (f" ({count} times)" if count > 1 else ""), SceneWarning, stacklevel=depth)


class Node:
    """An object of a scene, placed by a transform."""

    def __init__(self, scene: Scene, index: int):
        self._scene, self._index = scene, index

    @property
    def transform(self) -> np.ndarray:
        """Matrix (4, 4), float64, from the space of the object to that of its parent; columns are vectors, meters.

        The first change of an object makes the next render compile the whole scene; later ones are quick."""
        return self._scene._core.transform(self._index)

    @transform.setter
    def transform(self, value: Any) -> None:
        self._scene._core.set_transform(self._index, arrays.matrix(value))

    @property
    def world_transforms(self) -> list[np.ndarray]:
        """Matrices (4, 4) to world space, one for each place where the object is."""
        return self._scene._core.world_transforms(self._index)

    def set_motion(self, keys: Sequence[tuple[float, Any]]) -> None:
        """Sets keys (time in seconds, matrix) between which the object moves; the camera's ``shutter`` blurs it."""
        self._scene._core.set_motion(self._index, [(float(time), arrays.matrix(value)) for time, value in keys])


class Mesh(Node):
    """A triangle mesh in a scene. Arrays that it returns are copies."""

    def __init__(self, scene: Scene, node: int, shape: int, mesh: int, name: str):
        super().__init__(scene, node)
        self._shape, self._mesh, self.name = shape, mesh, name

    @property
    def vertices(self) -> np.ndarray:
        """Positions (n, 3), float32, in meters, before the transform. An assigned array has as many rows; it makes
        triangles flat, see :meth:`set_vertices` for normals."""
        return _rows(self._scene._core.positions(self._mesh), 3)

    @vertices.setter
    def vertices(self, value: Any) -> None:
        self.set_vertices(value)

    def set_vertices(self, vertices: Any, normals: Any = None) -> None:
        """Moves the vertices: positions (n, 3), and normals if the mesh has some."""
        vertices = arrays.float_rows(vertices, "vertices", 3, len(self.vertices))
        if normals is not None:
            normals = arrays.float_rows(normals, "normals", 3, len(vertices))
        self._scene._core.set_vertices(self._mesh, vertices, normals)

    def set_vertex_motion(self, keys: Sequence[tuple[float, Any]]) -> None:
        """Sets keys (time in seconds, positions (n, 3)) between which vertices move; for meshes without normals."""
        count = len(self.vertices)
        self._scene._core.set_vertex_motion(
            self._mesh, [(float(time), arrays.float_rows(value, "vertices", 3, count)) for time, value in keys])

    @property
    def faces(self) -> np.ndarray:
        """Vertex indices (n, 3), uint32; counterclockwise seen from outside."""
        return self._scene._core.indices(self._mesh)

    @property
    def normals(self) -> np.ndarray | None:
        """Shading normals (n, 3), float32; None: those of the triangles."""
        return self._scene._core.normals(self._mesh)

    @property
    def uvs(self) -> np.ndarray | None:
        """Texture coordinates (n, 2), float32; v grows downwards in the image, as in glTF."""
        return self._scene._core.uvs(self._mesh)

    @property
    def colors(self) -> np.ndarray | None:
        """Vertex colors (n, 4), float32, linear RGBA."""
        return self._scene._core.colors(self._mesh)

    @property
    def material(self) -> Material | None:
        """The material; None: diffuse gray. Its parameters can be changed; another material can be assigned."""
        index = self._scene._core.shape_material(self._index, self._shape)
        return None if index < 0 else self._scene._material_at(index)

    @material.setter
    def material(self, value: Material | None) -> None:
        index = -1 if value is None else self._scene._material_index(value)
        self._scene._core.set_shape_material(self._index, self._shape, index)

    def __repr__(self) -> str:
        return f"<fathom.Mesh {self.name!r}: {len(self.vertices)} vertices, {len(self.faces)} faces>"


def _rows(array: np.ndarray | None, columns: int) -> np.ndarray:
    return np.empty((0, columns), np.float32) if array is None else array


class Scene:
    """A scene: meshes, other objects, materials, lights, a camera and an environment.

    Units are meters and seconds, y is up. A scene without a camera gets one that frames it; without light it gets studio
    lights. Camera, light and exposure that were added are kept while the scene is edited, until objects, lights or
    options of the scene change.
    """

    def __init__(self) -> None:
        self._adopt(_fathom.Scene())

    def _adopt(self, core: _fathom.Scene) -> None:
        self._core = core
        self._materials: dict[int, Material] = {}
        self._kept: list[Any] = []  # lights, and parameters whose changes reach this scene
        self._camera: Camera | None = None
        self._environment: Environment | None = None

    # Contents ---------------------------------------------------------------------------------------------------------

    def add_mesh(self, vertices: Any, faces: Any, *, normals: Any = None, uvs: Any = None, colors: Any = None,
                 material: Material | None = None, transform: Any = None, name: str = "") -> Mesh:
        """Adds a triangle mesh. float32 and uint32 arrays in C order are copied once, into the scene.

        vertices : (n, 3) positions in meters
        faces : (m, 3) integer indices, counterclockwise seen from outside
        normals : (n, 3) shading normals; without them triangles are flat
        uvs : (n, 2) texture coordinates; v grows downwards in the image, as in glTF
        colors : (n, 3) or (n, 4) vertex colors; uint8 are sRGB codes, floats are linear. Without a material, they are
            the color of the surface; a material uses them with ``use_vertex_color=True``
        transform : (4, 4) matrix to world space
        """
        vertices = arrays.float_rows(vertices, "vertices", 3)
        faces = arrays.triangles(faces, len(vertices))
        rows = len(vertices)
        if rows < 3 or len(faces) < 1:
            raise ValueError(f"a mesh has at least one triangle, found {rows} vertices and {len(faces)} faces")
        normals = None if normals is None else arrays.float_rows(normals, "normals", 3, rows)
        uvs = None if uvs is None else arrays.float_rows(uvs, "uvs", 2, rows)
        colors = None if colors is None else arrays.colors(colors, rows)
        if material is None and colors is not None:
            material = Material("diffuse", color=1, use_vertex_color=True)
        index = -1 if material is None else self._material_index(material)
        node = self._core.add_mesh(name, vertices, faces, normals, uvs, colors, index, arrays.matrix(transform))
        return Mesh(self, node, 0, self._core.counts()["meshes"] - 1, name)

    def add(self, **node: Any) -> Node:
        """Adds a node as in scene files: a shape, a model, or children, with a material and a transform.

        >>> scene.add(sphere={"center": (0, 1, 0), "radius": 0.5}, material=fathom.Material("glass"))
        >>> scene.add(model="chair.glb", transform={"translate": (1, 0, 0)})
        """
        index = checked(self._core.add_node, self._json(node))
        warn(self._core.take_warnings())
        return Node(self, index)

    def add_instance(self, mesh: Mesh, transform: Any = None, material: Material | None = None) -> Node:
        """Places a mesh once more, without a copy of its data."""
        return self.add(mesh=f"#{mesh._mesh}", material=material or mesh.material,
                        transform={"matrix": arrays.matrix(transform).tolist()})

    def add_light(self, light: Light | str, /, **parameters: Any) -> Light:
        """Adds a light: a :class:`Light`, or its kind and parameters. Its parameters can be changed later."""
        if not isinstance(light, Light):
            light = Light(light, **parameters)
        elif parameters:
            raise TypeError("add_light() takes a Light, or the kind of a light and its parameters")
        if self in light._uses:
            raise ValueError("the light is in this scene already; make another one")
        light._uses[self] = checked(self._core.add_light, self._json(light), "")
        self._kept.append(light)
        return light

    @property
    def meshes(self) -> list[Mesh]:
        """All meshes, one for each object that shows one."""
        return [Mesh(self, *placed) for placed in self._core.placed_meshes()]

    @property
    def materials(self) -> list[Material]:
        """All materials of the scene."""
        return [self._material_at(i) for i in range(self._core.counts()["materials"])]

    @property
    def lights(self) -> list[Light]:
        """The lights that :meth:`add_light` added."""
        return [kept for kept in self._kept if isinstance(kept, Light)]

    @property
    def camera(self) -> Camera | None:
        """The camera, in world space. An assigned one becomes the first of the scene; None: the scene has none."""
        if self._camera is None and self._core.counts()["cameras"] > 0:
            return Camera(**json.loads(self._core.camera_json(0)))
        return self._camera

    @camera.setter
    def camera(self, value: Camera) -> None:
        if not isinstance(value, Camera):
            raise TypeError(f"camera: expected a fathom.Camera, found {type(value).__name__}")
        checked(self._core.set_camera, to_json(value))
        if self._camera is not None:
            self._camera._uses.pop(self, None)
        self._camera = value
        value._uses[self] = 0

    @property
    def environment(self) -> Environment | None:
        """Light from outside: an :class:`Environment`; an assigned path or array (H, W, 3) is an equirectangular image."""
        if self._environment is None:
            values = json.loads(self._core.environment_json())
            if not values:
                return None
            return Environment(values.pop("kind"), **values)
        return self._environment

    @environment.setter
    def environment(self, value: Any) -> None:
        if value is None:
            value = Environment("none")
        if not isinstance(value, Environment):
            value = Environment("image", image=value)
        checked(self._core.set_environment, self._json(value))
        if self._environment is not None:
            self._environment._uses.pop(self, None)
        self._environment = value
        value._uses[self] = 0

    def set_render(self, **settings: Any) -> None:
        """Replaces render settings that the scene contains, such as ``exposure`` or ``samples`` (docs/scene-format.md).

        Options of :meth:`render` override them. ``own_light=False`` treats the scene like a model of another format."""
        checked(self._core.set_render, to_json(settings))

    # Rendering --------------------------------------------------------------------------------------------------------

    def render(self, size: Any = None, spp: int | None = None, time: Any = None, denoise: Any = None, **settings: Any) -> Image:
        """Renders the scene. Parameters and result are those of :func:`fathom.render`.

        A scene that was rendered before is only compiled where it has changed."""
        from .rendering import render_scene
        return render_scene(self, dict(size=size, spp=spp, time=time, denoise=denoise, **settings), take=False)

    def save(self, path: str | os.PathLike) -> None:
        """Writes the scene as Fathom's JSON with files beside it, or as ``.glb``."""
        warn(self._core.save(pathlib.Path(path)))

    # Pickling ---------------------------------------------------------------------------------------------------------

    def __reduce__(self):
        self._core.embed_images(lambda path: pathlib.Path(path).read_bytes())
        with tempfile.TemporaryDirectory(prefix="fathom-") as folder:
            self._core.save(pathlib.Path(folder) / "scene.json")
            files = {str(file.relative_to(folder)): file.read_bytes()
                     for file in sorted(pathlib.Path(folder).rglob("*")) if file.is_file()}
        return _from_files, (files,)

    # Private ----------------------------------------------------------------------------------------------------------

    def _json(self, values: Any) -> str:
        return to_json(values, self)

    def _material_index(self, material: Material) -> int:
        if not isinstance(material, Material):
            raise TypeError(f"material: expected a fathom.Material, found {type(material).__name__}")
        if self not in material._uses:
            if has_reference(material._values):
                raise ValueError("the material has textures of the scene that it belongs to; it can't be used in another")
            index = checked(self._core.add_material, self._json(material), str(material._values.get("name", "")))
            material._uses[self] = index
            self._materials[index] = material
        return material._uses[self]

    def _material_at(self, index: int) -> Material:
        if index not in self._materials:
            material = Material(**json.loads(self._core.material_json(index)))
            material._uses[self] = index
            self._materials[index] = material
        return self._materials[index]

    def _set_material(self, index: int, material: Material) -> None:
        self._core.set_material(index, self._json(material))

    def __repr__(self) -> str:
        counts = self._core.counts()
        return f"<fathom.Scene: {counts['meshes']} meshes, {counts['materials']} materials, {counts['lights']} lights>"


def wrap(core: _fathom.Scene) -> Scene:
    """Returns a Scene of a scene of the library."""
    scene = Scene.__new__(Scene)
    scene._adopt(core)
    return scene


def _from_files(files: dict[str, bytes]) -> Scene:
    with tempfile.TemporaryDirectory(prefix="fathom-") as folder:
        for name, data in files.items():
            path = pathlib.Path(folder, name)
            path.parent.mkdir(exist_ok=True)
            path.write_bytes(data)
        core, _ = _fathom.load(pathlib.Path(folder, "scene.json"), [])
        core.embed_images(lambda path: pathlib.Path(path).read_bytes())
    return wrap(core)


def load(path: str | os.PathLike | bytes, **how: Any) -> Scene:
    """Reads a scene or model file, or the bytes of one.

    path : glTF, GLB, Fathom's JSON, Mitsuba, pbrt, OBJ, PLY, STL, ...; bytes: GLB or PLY
    how : options of the command line that say how it is read: ``scene``, ``variant``, ``up_axis``, ``define`` (a dict),
        ``confine``

    Raises fathom.Error if the file can't be read.
    """
    options.check_names(how, options.LOAD, "load")
    if not isinstance(path, (bytes, bytearray, memoryview)):
        with options.named_as_in_python():
            core, found = _fathom.load(pathlib.Path(path), options.words(how))
        warn(found)
        return wrap(core)
    handle = os.memfd_create("fathom")
    try:
        with os.fdopen(os.dup(handle), "wb") as file:
            file.write(path)
        core, found = _fathom.load(pathlib.Path(f"/proc/self/fd/{handle}"), options.words(how))
    finally:
        os.close(handle)
    warn(found)
    return wrap(core)
