# SPDX-License-Identifier: Apache-2.0
"""Options of ``fathom render`` as keyword arguments.

Names, values and checks are those of the command line: ``look_from=(1, 2, 3)`` becomes ``--look-from 1,2,3``.
"""
from __future__ import annotations

import contextlib
import difflib
import functools
import os
import re
from collections.abc import Iterable, Iterator, Mapping
from typing import Any

from . import _fathom

#: Options that say how a file is read.
LOAD = {"scene", "variant", "up_axis", "define", "confine"}
#: Options that say how an image is shown or stored.
IMAGE = {"exposure", "white_balance", "tonemap", "ocio", "ocio_display", "ocio_view", "ocio_look", "ocio_input", "png_bits",
         "quality", "exr", "exr_primaries"}
#: Options that only make sense for a program: Python has other means.
_PROGRAM = {
    "output": "use Image.save()",
    "frames": "render with at= in a loop, or use render_views()",
    "turntable": "render with orbit= in a loop",
    "views": "use render_views()",
    "on": "use render_views()",
    "cameras": "use render_views()",
    "dataset": "use render_views(), or the program",
    "models": "use render_views() in a loop, or the program",
    "checkpoint": "use Image.film and film=",
    "every": "use Image.film and film=",
    "quiet": "use progress=",
    "stats": "use the program",
    "mpi": "use the program",
    "nice": "use os.nice()",
    "only_sample": "use the program",
    "reference": "use fathom.diff()",
    "tolerance": "use fathom.diff()",
    "help": "see docs/python.md",
}


@functools.lru_cache(maxsize=None)
def table() -> dict[str, tuple[str, str, str, str]]:
    """All options: name in Python -> (name on the command line, form of the value, meaning, default)."""
    rows = {}
    for names, value, meaning, default in _fathom.render_options():
        word = names.split(",")[-1]
        rows[word.lstrip("-").replace("-", "_")] = (word, value, meaning, default)
    return rows


def describe() -> str:
    """Returns a list of all options of :func:`fathom.render` with their meaning, for people."""
    lines = []
    for name, (_, value, meaning, default) in table().items():
        if name not in _PROGRAM:
            lines.append(f"{name}: {meaning}" + (f" [{value}]" if value else "") + (f" (default: {default})" if default else ""))
    return "\n".join(lines)


def check_names(names: Iterable[str], allowed: set[str], function: str) -> None:
    """Raises TypeError for the first name that the function doesn't have."""
    for name in names:
        if name in allowed:
            continue
        if name in _PROGRAM:
            raise TypeError(f"{function}() has no option '{name}': {_PROGRAM[name]}")
        close = difflib.get_close_matches(name, allowed, 1)
        hint = f"; did you mean '{close[0]}'?" if close else ""
        raise TypeError(f"{function}() got an unexpected option '{name}'{hint}")


def render_names() -> set[str]:
    """Names of the options of a render, without those for reading files and for stored images."""
    return set(table()) - set(_PROGRAM) - LOAD - {"png_bits", "quality", "exr", "exr_primaries", "progress"}


def words(options: Mapping[str, Any]) -> list[str]:
    """Returns the options as words of a command line. None stands for an option that is not given."""
    result: list[str] = []
    for name, value in options.items():
        if value is None:
            continue
        word, form, _, _ = table()[name]
        if name == "define":
            for key, text in value.items():
                result += [word, f"{key}={text}"]
        elif not form:
            if value is not False:
                result.append(word if value is True else f"{word}={value}")
        else:
            result.append(f"{word}={_text(name, value, form)}")
    return result


@contextlib.contextmanager
def named_as_in_python() -> Iterator[None]:
    """Names options in messages of ValueError as keyword arguments: ``look_from`` for ``--look-from``."""
    try:
        yield
    except ValueError as error:
        if isinstance(error, _fathom.Error):
            raise
        raise ValueError(re.sub(r"--([a-z][a-z-]*)", lambda word: word[1].replace("-", "_"), str(error))) from None


def _text(name: str, value: Any, form: str) -> str:
    if isinstance(value, (bool,)):
        if "off" not in (choices := form.split("|")) or not {"on", "auto"} & set(choices):
            raise TypeError(f"{name}: expected {form}, found {value}")
        return "on" if value else "off"
    if isinstance(value, (str, os.PathLike)):
        return os.fspath(value)
    if isinstance(value, Iterable):
        separator = {"size": "x", "samples": ":", "part": "/", "frames": ":"}.get(name, ",")
        return separator.join(_number(name, part) for part in value)
    return _number(name, value)


def _number(name: str, value: Any) -> str:
    if isinstance(value, str):
        return value
    try:
        number = value.item() if hasattr(value, "item") else value
        return repr(number) if isinstance(number, (int, float)) else repr(float(number))
    except (TypeError, ValueError):
        raise TypeError(f"{name}: expected a number or text, found {type(value).__name__}") from None
