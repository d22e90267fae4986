# SPDX-License-Identifier: Apache-2.0
"""Results of a render."""
from __future__ import annotations

import os
import pathlib
from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

from . import _fathom, options
from .png import encode_png


class Interrupted(KeyboardInterrupt):
    """Rendering was interrupted, by Ctrl-C for example. ``image`` is the image so far; None if there is none yet."""

    image: Image | None = None


class HdrLayers(Mapping):
    """The layers of an image by name: read-only float32 arrays that share the memory of the image."""

    def __init__(self, layers: _fathom.Layers):
        self._layers = layers

    def __getitem__(self, name: str) -> np.ndarray:
        if name not in self:
            raise KeyError(f"the image has no layer '{name}', only {', '.join(self)}; render with aov='{name}'")
        return self._layers.layer("" if name == "beauty" else name)

    def __contains__(self, name: object) -> bool:
        return name in list(self)

    def __iter__(self) -> Iterator[str]:
        return iter([name or "beauty" for name in self._layers.names()])

    def __len__(self) -> int:
        return len(self._layers.names())

    def channels(self, name: str) -> list[str]:
        """Names of the channels of a layer, such as ``["R", "G", "B"]``."""
        return self._layers.channels("" if name == "beauty" else name)

    def __repr__(self) -> str:
        return f"<layers {', '.join(self)}>"


class Image:
    """An image, with its scene and film as long as those are needed to add samples."""

    def __init__(self, layers: _fathom.Layers, run: _fathom.Run | None = None, display: Mapping[str, Any] | None = None):
        self._layers, self._run = layers, run
        self._display = dict(display or {})

    @property
    def width(self) -> int:
        """Width in pixels."""
        return self._layers.width

    @property
    def height(self) -> int:
        """Height in pixels."""
        return self._layers.height

    @property
    def rgba(self) -> np.ndarray:
        """Display values (H, W, 4), uint8, as in PNG files: exposure and tone map applied, sRGB, alpha not multiplied."""
        return self._layers.rgba(options.words(self._display))

    @property
    def rgb(self) -> np.ndarray:
        """Display values (H, W, 3), uint8, as in PNG files: exposure and tone map applied, sRGB."""
        return np.ascontiguousarray(self.rgba[..., :3])

    @property
    def hdr(self) -> HdrLayers:
        """Layers by name: ``beauty`` is linear Rec.709 radiance (H, W, 3), or (H, W, 4) with alpha, premultiplied.

        Others are ``denoised``, and those that ``aov`` asks for: ``albedo`` and ``normal`` (H, W, 3), ``position``
        (H, W, 3) in meters, ``depth`` (H, W) along the view axis in meters, infinite where nothing is hit, ``instance``,
        ``material`` and ``samples`` (H, W), ``variance`` of the mean (H, W, 3)."""
        return HdrLayers(self._layers)

    @property
    def attributes(self) -> dict[str, str]:
        """Settings and statistics of the render by name, as in EXR files."""
        return self._layers.attributes

    @property
    def notes(self) -> list[str]:
        """What was added to the scene or decided for the render, in sentences."""
        return list(self._run.notes) if self._run else []

    def save(self, path: str | os.PathLike, **how: Any) -> None:
        """Writes the image: ``.exr`` with all layers, ``.png``, ``.jpg``, ``.webp``, ``.avif`` or ``.hdr``.

        how : options of the command line for images, such as ``exposure``, ``tonemap``, ``png_bits``, ``quality``
        """
        options.check_names(how, options.IMAGE, "save")
        with options.named_as_in_python():
            self._layers.save(pathlib.Path(path), options.words({**self._display, **how}))

    def more(self, spp: int | None = None, time: float | None = None, *, progress: Any = None, callback: Any = None) -> Image:
        """Adds `spp` samples per pixel, or as many as fit into `time` seconds, to this image, and returns it.

        The result has the same bits as a render with all samples at once (with the same guiding). Arrays that were taken
        from the image before keep their values. Raises fathom.Error once the scene was rendered anew after a change."""
        from .progress import Watcher
        if (spp is None) == (time is None):
            raise TypeError("more() takes spp or time")
        if spp is not None and (isinstance(spp, bool) or int(spp) != spp or spp < 1):
            raise ValueError(f"spp: expected a whole number above 0, found {spp}")
        if time is not None and not time > 0:
            raise ValueError(f"time: expected seconds above 0, found {time}")
        if self._run is None:
            raise _fathom.Error("no more samples can be added to this image: it has no scene")
        run = self._run
        with Watcher(progress, callback, None, run.film.samples_per_pixel, None if spp is None else int(spp)) as watcher:
            stopped = run.more(None if spp is None else int(spp), time, watcher.callback)
        self._layers = run.layers()
        finish(self, stopped)
        return self

    @property
    def film(self) -> Film:
        """The exact sums of the samples, to be saved, merged or continued."""
        if self._run is None:
            raise _fathom.Error("the image has no film")
        return Film(self._run.film)

    @property
    def error(self) -> _fathom.ImageError | None:
        """Estimated relative error of the image; see :meth:`Film.error`."""
        return self.film.error()

    def detach(self) -> Image:
        """Forgets scene and film, which frees their memory, and returns the image."""
        if self._run is not None:
            self._run.forget_scene()
            self._run = None
        return self

    def _repr_png_(self) -> bytes:
        pixels = self.rgba
        return encode_png(pixels if self.hdr.channels("beauty")[-1] == "A" else pixels[..., :3])

    def __repr__(self) -> str:
        return f"<fathom.Image {self.width}x{self.height}: {', '.join(self.hdr)}>"


def finish(image: Image, stopped: BaseException | None) -> None:
    """Issues the warnings of a run, and raises what ended it early."""
    from .scene import warn
    warn(image._run.take_warnings(), 4)
    if isinstance(stopped, KeyboardInterrupt):
        interrupted = Interrupted("rendering was interrupted; .image is the image so far")
        interrupted.image = image if image._run.film.samples_per_pixel > 0 else None
        raise interrupted
    if stopped is not None:
        raise stopped


class Film:
    """Exact sums of the samples of an image. Films of other samples of the same image can be merged in any order."""

    def __init__(self, core: _fathom.Film):
        self._core = core

    @classmethod
    def load(cls, path: str | os.PathLike) -> Film:
        """Reads a film file, as :meth:`save`, ``--mergeable`` and ``--checkpoint`` write it."""
        return cls(_fathom.load_film(pathlib.Path(path)))

    def error(self, metric: str = "relative") -> _fathom.ImageError | None:
        """Estimated error by noise, with ``low`` and ``high``, the ends of its interval of 95 % confidence.

        ``relative``: root of the mean of (x - r)^2 / (r^2 + 0.01), where r is the image x without noise; ``absolute``: of
        (x - r)^2; ``worst-block``: the relative error of the block of 32x32 pixels where it is largest. None below two
        samples per pixel, in very small images, and if the film was rendered with ``error="off"``."""
        if metric not in ("relative", "absolute", "worst-block"):
            raise ValueError(f"metric: expected relative, absolute or worst-block, found {metric!r}")
        return self._core.error(metric)

    @property
    def samples(self) -> list[tuple[int, int]]:
        """Ranges of sample indices: the first, and one past the last."""
        return self._core.samples

    @property
    def samples_per_pixel(self) -> int:
        """Number of samples per pixel."""
        return self._core.samples_per_pixel

    def merge(self, other: Film | str | os.PathLike) -> Film:
        """Adds the samples of another film or film file, and returns this film.

        Raises fathom.Error, without a change, if a sample is in both, or scene or settings differ."""
        self._core.merge((other if isinstance(other, Film) else Film.load(other))._core)
        return self

    def image(self) -> Image:
        """Returns the image of the samples, with exposure 0 unless the display options of save() say otherwise."""
        return Image(self._core.image())

    def save(self, path: str | os.PathLike) -> None:
        """Writes an EXR that shows the image and keeps the sums."""
        self._core.save(pathlib.Path(path))

    def __repr__(self) -> str:
        return f"<fathom.Film {self._core.width}x{self._core.height}: {self.samples_per_pixel} samples per pixel>"
