# SPDX-License-Identifier: Apache-2.0
"""fathom.render()."""
from __future__ import annotations

import os
from typing import Any

from . import _fathom, options, sources
from .denoiser import point_to_denoiser
from .image import Film, Image, finish
from .progress import Watcher
from .scene import Scene, load

_OWN = {"aov", "film", "progress", "callback", "live"}


def render(x: Any, size: Any = None, spp: int | None = None, time: Any = None, denoise: Any = None, **settings: Any) -> Image:
    """Renders a scene, model or mesh.

    x : path of a file; bytes of a GLB; ``(vertices, faces)``; a mesh or scene of trimesh; a data set of PyVista, with
        ``scalars``, ``cmap`` and ``clim``; a mesh of Open3D; or a :class:`Scene`
    size : ``(width, height)`` in pixels, or ``"960x540"``
    spp : samples per pixel (256)
    time : seconds, or text such as ``"10m"``: as many samples as fit
    denoise : True, or ``"auto"`` for denoising where Open Image Denoise is installed
    aov : layers, ``"depth,normal"`` or a list (``"depth"``)
    film : a :class:`Film` or film file whose samples are not rendered again
    progress : True for a progress bar by tqdm, or a bar
    callback : function that gets a :class:`Progress` several times a second
    live : show the image while rendering, in a notebook; by default from 1.5 seconds on

    Other options are those of ``fathom render`` with underscores, such as ``camera``, ``orbit=(45, 20)``, ``env``,
    ``light``, ``seed``, ``exposure``; ``fathom.options.describe()`` lists them. Defaults are those of the program: a
    model without camera and light gets both.

    Ctrl-C raises :class:`Interrupted`, a KeyboardInterrupt whose ``image`` is the image so far. Raises fathom.Error for
    what is wrong with files and scenes, TypeError and ValueError for arguments. Other threads run while it renders.
    """
    settings.update(size=size, spp=spp, time=time, denoise=denoise)
    if isinstance(x, Scene):
        return render_scene(x, settings, take=False)
    if isinstance(x, (str, os.PathLike, bytes, bytearray, memoryview)):
        how = {name: settings.pop(name) for name in list(settings) if name in options.LOAD}
        check(settings)
        return render_scene(load(x, **how), settings, take=True)
    how = {name: settings.pop(name) for name in list(settings) if name in sources.OPTIONS}
    check(settings)
    return render_scene(sources.to_scene(x, **how), settings, take=True)


def check(settings: dict[str, Any]) -> None:
    """Raises TypeError for unknown options."""
    options.check_names(settings, options.render_names() | _OWN, "render")


def render_scene(scene: Scene, settings: dict[str, Any], take: bool) -> Image:
    """Renders a scene; `take`: nobody uses the scene afterwards, so its data need not be copied."""
    check(settings)
    progress, callback, live = (settings.pop(name, None) for name in ("progress", "callback", "live"))
    film = settings.pop("film", None)
    if film is not None and not isinstance(film, Film):
        film = Film.load(film)
    settings["aov"] = settings.get("aov", "depth") or None
    words = options.words(settings)
    if settings["denoise"]:
        point_to_denoiser()
    with Watcher(progress, callback, live, film.samples_per_pixel if film else 0) as watcher, options.named_as_in_python():
        run, stopped = _fathom.render(scene._core, words, take, film._core if film else None, watcher.callback)
    shown = {name: value for name, value in settings.items() if name in options.IMAGE}
    image = Image(run.layers(), run, shown)
    finish(image, stopped)
    return image
