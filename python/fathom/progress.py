# SPDX-License-Identifier: Apache-2.0
"""Progress of a render: callbacks, tqdm, and a live image in notebooks."""
from __future__ import annotations

import sys
import time
from typing import Any

import numpy as np

from . import _fathom
from .png import encode_png


class Progress:
    """State of a render, for callbacks; it can be read until the callback returns."""

    def __init__(self, state: _fathom.Pass, begin: int, total: int | None, elapsed: float):
        self._state = state
        #: Samples per pixel that this call has rendered.
        self.samples: int = state.samples - begin
        #: Samples per pixel that this call renders; None if a time limits it.
        self.total: int | None = total if total is not None else max(int(state.planned) - begin, 0) or None
        #: Seconds since rendering began.
        self.elapsed: float = elapsed

    @property
    def rgb(self) -> np.ndarray:
        """The image so far, display values (H, W, 3), uint8; not denoised."""
        return np.ascontiguousarray(self._state.rgba()[..., :3])


def in_notebook() -> bool:
    """Whether a notebook runs this process."""
    shell = sys.modules.get("IPython") and sys.modules["IPython"].get_ipython()
    return shell is not None and hasattr(shell, "kernel")


class LiveImage:
    """An image in a notebook's output that is replaced while rendering, and removed at the end."""

    first_s, interval_s = 1.5, 1.0

    def __init__(self) -> None:
        self._handle: Any = None
        self._next_s = self.first_s

    def update(self, progress: Progress) -> None:
        from IPython.display import Image as Shown, display
        if progress.elapsed < self._next_s:
            return
        begin = time.monotonic()
        shown = Shown(data=encode_png(progress.rgb, level=1))
        if self._handle is None:
            self._handle = display(shown, display_id=True)
        else:
            self._handle.update(shown)
        # Showing takes at most a tenth of the time.
        self._next_s = progress.elapsed + max(self.interval_s, 10 * (time.monotonic() - begin))

    def remove(self) -> None:
        if self._handle is not None:
            from IPython.display import HTML
            self._handle.update(HTML(""))


class Watcher:
    """Passes the progress of a render on to what the caller asked for. `callback` is None if that is nothing."""

    def __init__(self, progress: Any, callback: Any, live: bool | None, begin: int = 0, total: int | None = None):
        if callback is not None and not callable(callback):
            raise TypeError(f"callback: expected a function, found {type(callback).__name__}")
        self._user, self._begin, self._total = callback, begin, total
        self._bar = _tqdm(progress)
        self._live = LiveImage() if live or (live is None and in_notebook()) else None
        self._start_s = time.monotonic()
        self.callback = self._report if callback or self._bar is not None or self._live else None

    def _report(self, state: _fathom.Pass) -> None:
        now = Progress(state, self._begin, self._total, time.monotonic() - self._start_s)
        if self._bar is not None:
            self._bar.total = now.total
            self._bar.update(now.samples - self._bar.n)
        if self._live:
            self._live.update(now)
        if self._user:
            self._user(now)

    def __enter__(self) -> Watcher:
        return self

    def __exit__(self, *exception: object) -> None:
        if self._bar is not None:
            if exception[0] is None and self._bar.total:
                self._bar.update(self._bar.total - self._bar.n)
            self._bar.close()
        if self._live:
            self._live.remove()


def _tqdm(progress: Any) -> Any:
    """The bar for the parameter `progress`: True makes one; a bar of the caller is used; None and False are none."""
    if progress is None or progress is False:
        return None
    if progress is not True:
        return progress
    from tqdm.auto import tqdm
    return tqdm(unit=" samples", desc="rendering")
