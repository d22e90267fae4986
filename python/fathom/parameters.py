# SPDX-License-Identifier: Apache-2.0
"""Materials, textures, lights, cameras and environments: parameters by name, as in scene files.

The names, ranges and defaults are those of docs/scene-format.md. The library checks them when an object is made or
changed.
"""
from __future__ import annotations

import functools
import hashlib
import json
import os
import weakref
from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from . import _fathom
from .arrays import matrix
from .png import encode_texture

if TYPE_CHECKING:
    from .scene import Scene


class ParameterError(_fathom.Error, ValueError):
    """A parameter is unknown, or its value is not allowed. The message says which one, and suggests a name."""


class Parameters:
    """Parameters by name. They are attributes and items: ``material.roughness``, ``material["roughness"]``.

    Objects can be used by several scenes; a change takes effect in all of them.
    """

    _aliases: Mapping[str, str] = {}
    _values: dict[str, Any]

    def __init__(self, kind: str | None, values: Mapping[str, Any]):
        object.__setattr__(self, "_uses", weakref.WeakKeyDictionary())
        object.__setattr__(self, "_values", {})
        if kind is not None:
            self._values["kind"] = kind
        self._values.update({self._aliases.get(name, name): value for name, value in values.items() if value is not None})
        # References to objects of a scene can be checked by that scene only.
        if not has_reference(self._values):
            self._check(self._values)

    def _check(self, values: Mapping[str, Any]) -> None:
        raise NotImplementedError

    def _apply(self, scene: Scene, index: int) -> None:
        """Passes the parameters on to a scene that uses the object."""

    def update(self, **values: Any) -> None:
        """Sets several parameters at once; None removes one, so that it has its default."""
        new = dict(self._values)
        for name, value in values.items():
            name = self._aliases.get(name, name)
            new.pop(name, None)
            if value is not None:
                new[name] = value
        if not has_reference(new):
            self._check(new)
        old = self._values
        object.__setattr__(self, "_values", new)
        try:
            for scene, index in list(self._uses.items()):
                checked(self._apply, scene, index)
        except Exception:
            object.__setattr__(self, "_values", old)
            raise

    def __getattr__(self, name: str) -> Any:
        try:
            return self._values[self._aliases.get(name, name)]
        except KeyError:
            raise AttributeError(f"{type(self).__name__} has no '{name}'; it has its default if there is such a parameter"
                                 ) from None

    def __setattr__(self, name: str, value: Any) -> None:
        self.update(**{name: value})

    def __getitem__(self, name: str) -> Any:
        return self._values[self._aliases.get(name, name)]

    def __setitem__(self, name: str, value: Any) -> None:
        self.update(**{name: value})

    def __contains__(self, name: str) -> bool:
        return self._aliases.get(name, name) in self._values

    def __iter__(self) -> Iterator[str]:
        return iter(self._values)

    def __repr__(self) -> str:
        return f"{type(self).__name__}({', '.join(f'{name}={value!r}' for name, value in self._values.items())})"

    def __eq__(self, other: object) -> bool:
        return type(self) is type(other) and to_json(self) == to_json(other)

    __hash__ = object.__hash__

    def __reduce__(self):
        return _restore, (type(self), self._values)


def _restore(kind: type, values: dict[str, Any]) -> Parameters:
    restored = kind.__new__(kind)
    Parameters.__init__(restored, None, values)
    return restored


class Material(Parameters):
    """A material. `kind` is ``"principled"`` (default), ``"diffuse"``, ``"glass"``, ``"metal"``, ``"plastic"``, ...

    A color is three linear Rec.709 numbers or one for gray; colors and numbers can be a :class:`Texture`, an image array
    (H, W) or (H, W, 3), or ``{"value": factor, "texture": texture, "channel": "g"}``. ``base_color`` is another name of
    ``color``.

    >>> fathom.Material(base_color=(0.8, 0.2, 0.1), roughness=0.3)
    >>> fathom.Material("glass", ior=1.5, roughness=0.05)
    """

    _aliases = {"base_color": "color"}

    def __init__(self, kind: str = "principled", /, **parameters: Any):
        super().__init__(parameters.pop("kind", kind), parameters)

    def _check(self, values: Mapping[str, Any]) -> None:
        checked(_fathom.Scene().add_material, to_json(values), str(values.get("name", "")))

    def _apply(self, scene: Scene, index: int) -> None:
        scene._set_material(index, self)


class Texture(Parameters):
    """A texture: an image, or a function such as ``"checker_uv"`` or ``"noise"``.

    image : path of an image file, or an array (H, W) or (H, W, 1 to 4), the top row first. uint8 and uint16 are sRGB
        codes if the texture is a color, and numbers otherwise; ``color_space`` says it explicitly. float32 is linear.
    """

    def __init__(self, image: str | os.PathLike | np.ndarray | None = None, /, kind: str | None = None, **parameters: Any):
        image = parameters.pop("image", image)
        if isinstance(image, os.PathLike):
            image = os.fspath(image)
        elif image is not None and not isinstance(image, str):
            image = ImageData(np.asarray(image))
        super().__init__(kind, {"image": image, **parameters})

    def _check(self, values: Mapping[str, Any]) -> None:
        checked(_fathom.Scene().add_material, json.dumps({"color": {"texture": json.loads(to_json(values))}}), "")


class ImageData:
    """An array encoded as an image file, named after its contents so that equal images are stored once."""

    def __init__(self, pixels: np.ndarray):
        self.bytes = encode_texture(pixels)
        self.name = f"array-{hashlib.sha256(self.bytes).hexdigest()[:32]}"

    def __repr__(self) -> str:
        return f"<{self.name}>"


class Light(Parameters):
    """A light without a surface. `kind` is ``"point"``, ``"spot"``, ``"directional"``, ``"projector"``, ``"goniometric"``,
    ``"beam"`` or ``"tube"``.

    >>> fathom.Light("point", position=(0, 2, 0), intensity=100, unit="cd")
    """

    def __init__(self, kind: str, /, **parameters: Any):
        super().__init__(kind, parameters)

    def _check(self, values: Mapping[str, Any]) -> None:
        checked(_fathom.Scene().add_light, to_json(values), "")

    def _apply(self, scene: Scene, index: int) -> None:
        scene._core.set_light(index, scene._json(self))


class Environment(Parameters):
    """Light from outside the scene. `kind` is ``"constant"``, ``"gradient"``, ``"image"``, ``"sky"``, ``"studio"``, ...

    >>> fathom.Environment("sky", to_sun=(0.2, 0.6, 0.4))
    >>> fathom.Environment("image", image="studio.hdr")
    """

    def __init__(self, kind: str, /, **parameters: Any):
        image = parameters.get("image")
        if image is not None and not isinstance(image, (str, os.PathLike)):
            parameters["image"] = ImageData(np.asarray(image))
        super().__init__(kind, parameters)

    def _check(self, values: Mapping[str, Any]) -> None:
        checked(_fathom.Scene().set_environment, to_json(values))

    def _apply(self, scene: Scene, index: int) -> None:
        scene._core.set_environment(scene._json(self))


class _ConstructorAndParameter(classmethod):
    """``Camera.look_at(...)`` makes a camera; ``camera.look_at`` is the point that it looks at."""

    def __get__(self, camera: Camera | None, owner: type[Camera] | None = None) -> Any:
        if camera is not None:
            return camera["look_at"] if "look_at" in camera else (0, 0, -1)
        return super().__get__(camera, owner)


class Camera(Parameters):
    """A camera. `kind` is ``"perspective"`` (default), ``"orthographic"``, ``"spherical"`` or ``"equal-area"``.

    position, look_at, up : three numbers in meters, world space
    fov_y_deg : full vertical angle of view in degrees (40)
    """

    def __init__(self, kind: str | None = None, /, **parameters: Any):
        super().__init__(kind, parameters)

    @_ConstructorAndParameter
    def look_at(cls, position: Any, target: Any, up: Any = (0, 1, 0), **parameters: Any) -> Camera:
        """Returns a camera at `position` (meters) that looks at `target`; `up` is up in the image.

        Other parameters are those of :class:`Camera`, such as ``fov_y_deg``. The attribute ``look_at`` of a camera is
        the point that it looks at."""
        return cls(position=position, look_at=target, up=up, **parameters)

    def _check(self, values: Mapping[str, Any]) -> None:
        checked(_fathom.Scene().set_camera, to_json(values))

    def _apply(self, scene: Scene, index: int) -> None:
        scene._core.set_camera(to_json(self))


def checked(function: Any, *arguments: Any) -> Any:
    """Calls a function of the library that reads parameters; its errors become ParameterError."""
    try:
        return function(*arguments)
    except _fathom.Error as error:
        raised = ParameterError(str(error))
        raised.file, raised.place = error.file, error.place
        raise raised from None


def to_json(values: Any, scene: Scene | None = None) -> str:
    """Returns parameters as JSON. With a scene, its library gets the images and materials that they refer to."""
    return json.dumps(_plain(values, scene, ""))


def has_reference(value: Any) -> bool:
    """Whether parameters refer to an object of a scene by index, such as ``#3``."""
    if isinstance(value, str):
        return value.startswith("#")
    if isinstance(value, Mapping):
        return any(has_reference(item) for item in value.values())
    return False


def _plain(value: Any, scene: Scene | None, key: str) -> Any:
    if isinstance(value, Material) and key:
        return f"#{scene._material_index(value)}" if scene else _plain(value._values, None, "")
    if isinstance(value, Texture) and key not in ("", "texture", *_texture_parameters()):
        return {"texture": _plain(value, scene, "")}
    if isinstance(value, Parameters):
        value = value._values
    if isinstance(value, Mapping):
        return {name: _plain(item, scene, name) for name, item in value.items()}
    if isinstance(value, ImageData):
        if scene is not None:
            scene._core.add_image(value.name, value.bytes)
        return value.name
    if isinstance(value, os.PathLike):
        return os.fspath(value)
    if key in ("transform", "rotate") and np.shape(value) in ((4, 4), (3, 4)):
        return {"matrix": matrix(value).tolist()}
    if isinstance(value, np.ndarray):
        return _plain(Texture(value), scene, key) if value.ndim > 1 and not _is_rows(key) else value.tolist()
    if isinstance(value, (list, tuple)):
        return [_plain(item, scene, "") for item in value]
    if isinstance(value, np.generic):
        return value.item()
    if value is None or isinstance(value, (str, bool, int, float)):
        return value
    raise TypeError(f"{key or 'parameter'}: expected numbers, text or a texture, found {type(value).__name__}")


@functools.lru_cache(maxsize=None)
def _texture_parameters() -> tuple[str, ...]:
    return tuple(_fathom.texture_parameters())


def _is_rows(key: str) -> bool:
    """Whether an array of rows is meant, not an image."""
    return key in ("positions", "normals", "uvs", "indices", "colors", "tangents", "points", "curves", "stops")
