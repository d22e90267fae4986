# SPDX-License-Identifier: Apache-2.0
"""fathom.render_views(): many views of a scene, with ground truth."""
from __future__ import annotations

import json
import os
import pathlib
import tempfile
from collections.abc import Iterator, Sequence
from typing import Any, NamedTuple

import numpy as np

from . import _fathom, options, sources
from .denoiser import point_to_denoiser
from .image import Image
from .scene import Scene, load, warn

_Z_UP = np.array([[1, 0, 0, 0], [0, 0, -1, 0], [0, 1, 0, 0], [0, 0, 0, 1]], float)
_NOT_HERE = {"orbit", "view", "camera", "look_from", "look_at", "up", "time", "samples", "part"}


class ObjectMask(NamedTuple):
    """Masks of an object."""

    visible: np.ndarray
    whole: np.ndarray


ObjectMask.visible.__doc__ = "bool (H, W): pixels whose first surface is the object's."
ObjectMask.whole.__doc__ = "bool (H, W): pixels that it would cover if nothing were in front of it."


class SceneObject(NamedTuple):
    """An object of a scene: a node with shapes."""

    name: str
    transform: np.ndarray


SceneObject.name.__doc__ = "Name of the node."
SceneObject.transform.__doc__ = "(4, 4), from the space of the object to world space."


class View:
    """A view of a scene: its image, its camera, and ground truth from one ray through the center of each pixel.

    Arrays of ground truth are read-only and not filtered; docs/datasets.md explains each layer.
    """

    def __init__(self, index: int, arrays: _fathom.ViewArrays, display: dict[str, Any]):
        self._arrays = arrays
        #: Number of the view, from 0.
        self.index = index
        #: The image; it has alpha unless `background` was given.
        self.image = Image(arrays.layers(), None, display)

    @property
    def intrinsics(self) -> np.ndarray:
        """Matrix (3, 3) of the pinhole camera in pixels; the center of the top left pixel is at (0.5, 0.5)."""
        return self._arrays.intrinsics()

    @property
    def world_from_camera(self) -> np.ndarray:
        """Matrix (4, 4) of the camera's pose, with the axes of OpenGL: x right, y up, z towards the viewer. World: y up."""
        return self._arrays.world_from_camera()

    @property
    def depth(self) -> np.ndarray:
        """Distance along the view axis in meters, float32 (H, W); infinite where nothing is hit."""
        return self._arrays.depth()

    @property
    def distance(self) -> np.ndarray:
        """Distance along the ray in meters, float32 (H, W); infinite where nothing is hit."""
        return self._arrays.distance()

    @property
    def normal(self) -> np.ndarray:
        """Unit normal in world space, towards the camera, float32 (H, W, 3); 0 where nothing is hit."""
        return self._arrays.normal()

    @property
    def camera_normal(self) -> np.ndarray:
        """Unit normal in camera space, float32 (H, W, 3); 0 where nothing is hit."""
        return self._arrays.camera_normal()

    @property
    def position(self) -> np.ndarray:
        """World-space position in meters, float32 (H, W, 3); 0 where nothing is hit."""
        return self._arrays.position()

    @property
    def instance(self) -> np.ndarray:
        """Number of the object, uint32 (H, W): index in `objects` plus 1; 0 where nothing is hit."""
        return self._arrays.instance()

    @property
    def material(self) -> np.ndarray:
        """Number of the material, uint32 (H, W), from 1; 0 where nothing is hit."""
        return self._arrays.material()

    @property
    def flow_forward(self) -> np.ndarray | None:
        """Pixels to the right and down to the same point in the next view, float32 (H, W, 2); NaN where nothing is hit.

        None in the last view, and without ``flow=True``."""
        return self._arrays.flow_forward()

    @property
    def flow_backward(self) -> np.ndarray | None:
        """The flow to the previous view, as `flow_forward`; None in the first view."""
        return self._arrays.flow_backward()

    @property
    def masks(self) -> dict[int, ObjectMask]:
        """Masks by instance, of all objects in the image; empty with ``masks=False``."""
        return {instance: ObjectMask(*pair) for instance, pair in self._arrays.masks().items()}

    @property
    def objects(self) -> list[SceneObject]:
        """All objects of the scene."""
        return [SceneObject(*each) for each in self._arrays.objects()]

    def __repr__(self) -> str:
        return f"<fathom.View {self.index}: {self.image.width}x{self.image.height}>"


def render_views(x: Any, views: int | None = None, on: str | None = None, *, cameras: Any = None, frames: Any = None,
                 masks: bool = True, flow: bool = False, size: Any = None, spp: int | None = None, **settings: Any) -> Iterator[View]:
    """Renders a scene from many places and returns an iterator of :class:`View`. Views are rendered when they are asked for.

    x : as in :func:`render`
    views : number of cameras around the model
    on : ``"sphere"``, ``"hemisphere"`` (default) or ``"ring"``; `seed` turns the cameras about the vertical axis
    cameras : instead of `views`: a transforms.json of NeRF or nerfstudio, or matrices (4, 4) as `View.world_from_camera`;
        `fov` is then their vertical angle in degrees (40)
    frames : instead of `views`: frames of the animation, such as ``"0:23"``, with ``fps`` and ``shutter``
    masks : also find the masks of objects
    flow : also compute optical flow to the next and the previous view
    size, spp : as in :func:`render`, like all other options

    The background is transparent, and no floor is added, unless `background` and `ground` say so. The scene is compiled
    once, at the first view; changes of a :class:`Scene` after that don't matter.
    """
    settings.update(views=views, on=on, frames=frames, size=size, spp=spp)
    how = {name: settings.pop(name) for name in list(settings) if name in options.LOAD | sources.OPTIONS and name not in ("size",)}
    allowed = options.render_names() - _NOT_HERE | {"views", "on", "frames", "fov", "ground_truth"}
    options.check_names(settings, allowed, "render_views")
    if sum(choice is not None for choice in (views, cameras, frames)) != 1:
        raise TypeError("render_views() takes one of views, cameras and frames")
    if isinstance(x, Scene) and not how:
        scene, take = x, False
    elif isinstance(x, (str, os.PathLike, bytes, bytearray, memoryview)):
        scene, take = load(x, **how), True
    else:
        scene, take = sources.to_scene(x, **how), True
    return _render(scene, take, cameras, masks, flow, settings)


def _render(scene: Scene, take: bool, cameras: Any, masks: bool, flow: bool, settings: dict[str, Any]) -> Iterator[View]:
    if settings.get("denoise"):
        point_to_denoiser()
    with tempfile.TemporaryDirectory() as folder:
        if cameras is not None:
            settings = {**settings, "cameras": _camera_file(cameras, settings, pathlib.Path(folder))}
            settings.pop("fov", None)
        with options.named_as_in_python():
            prepared, stopped = _fathom.prepare_views(scene._core, options.words(settings), take)
    _raise(stopped)
    warn(prepared.take_warnings(), 4)
    shown = {name: value for name, value in settings.items() if name in options.IMAGE}
    for index in range(prepared.count):
        arrays, stopped = prepared.render(index, masks, flow)
        _raise(stopped)
        yield View(index, arrays, shown)


def _raise(stopped: BaseException | None) -> None:
    if stopped is not None:
        raise stopped


def _camera_file(cameras: Any, settings: dict[str, Any], folder: pathlib.Path) -> pathlib.Path:
    """The file of cameras: a given one, or one with the given matrices."""
    if isinstance(cameras, (str, os.PathLike)):
        if settings.get("fov") is not None:
            raise TypeError("render_views(): the file of cameras says their fov")
        return pathlib.Path(cameras)
    matrices = _matrices(cameras)
    settings["size"] = settings.get("size") or (800, 800)
    size = settings["size"]
    width, height = map(int, size.split("x")) if isinstance(size, str) else map(int, size)
    focal = 0.5 * height / np.tan(np.radians(settings.get("fov") or 40) / 2)
    content = {"fl_x": focal, "fl_y": focal, "w": width, "h": height,
               "frames": [{"file_path": f"cameras[{i}]", "transform_matrix": (_Z_UP @ m).tolist()} for i, m in enumerate(matrices)]}
    path = folder / "cameras"
    path.write_text(json.dumps(content))
    return path


def _matrices(cameras: Sequence[Any]) -> np.ndarray:
    try:
        matrices = np.asarray(list(cameras), float)
    except (TypeError, ValueError):
        raise TypeError("cameras: expected a file or matrices (4, 4)") from None
    if matrices.ndim != 3 or matrices.shape[1:] != (4, 4) or len(matrices) == 0:
        raise ValueError(f"cameras: expected matrices (n, 4, 4) with n above 0, found an array {matrices.shape}")
    if not np.isfinite(matrices).all():
        raise ValueError("cameras: a number is not finite")
    return matrices
