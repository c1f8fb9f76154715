"""The commands that make the files of the studio: their words.

Input: a request. Output: the arguments of ``distal``, without those that have their defaults. The
studio runs the command that it shows. Needs the standard library alone.
"""

from __future__ import annotations

import shlex
from collections.abc import Mapping, Sequence
from pathlib import PurePath
from typing import Any, Final

from distal.editor.messages import ExportRequest, PictureRequest, SourceRequest, Value

PAGE: Final = "page"  # the format of ``export`` that is no shader
_SIZE: Final = (640, 480)  # of a page that gives none
_WHOLE: Final = 2.0**53  # greater floats are written with an exponent


def shown(arguments: Sequence[str]) -> str:
    """Return a command for people, to be copied into a shell."""
    return shlex.join(["distal", *arguments])


def render_arguments(request: PictureRequest, output: str) -> list[str]:
    """Return the arguments that render a picture.

    Args:
        request: What is wanted.
        output: The file.
    """
    return [
        *("render", _source(request), "-o", output),
        *("--size", "{}x{}".format(*request.size)),
        *_given("--time", _number(request.time), wanted=request.time != 0.0),
        *_view(request),
        *_given("--time-limit", request.time_limit),
        *_given("--bits", request.bits),
        *_given("--look", request.look),
        *(["--transparent"] if request.transparent else []),
        *values(request.values),
    ]


def video_arguments(request: PictureRequest, output: str) -> list[str]:
    """Return the arguments that render a film.

    Args:
        request: What is wanted.
        output: The file.
    """
    return [
        *("video", _source(request), "-o", output),
        *("--duration", _number(request.duration), "--fps", request.fps),
        *("--size", "{}x{}".format(*request.size)),
        *_given("--start", _number(request.time), wanted=request.time != 0.0),
        *_view(request),
        *_given("--quality", request.quality),
        *(["--loop"] if request.loop else []),
        *values(request.values),
    ]


def export_arguments(request: ExportRequest, output: str) -> list[str]:
    """Return the arguments that write a page or a shader.

    Args:
        request: What is wanted.
        output: The file.
    """
    is_page = request.format == PAGE
    return [
        *("export", _source(request), "-o", output),
        *_given("--target", request.format, wanted=not is_page),
        *_given("--size", "{}x{}".format(*request.size), wanted=is_page and request.size != _SIZE),
        *_given("--view", request.view, wanted=request.view != "color"),
        *_given("--time", _number(request.time), wanted=request.time != 0.0),
        *_given("--look", request.look),
        *_given("--mode", request.mode, wanted=is_page),
        *(["--embed"] if request.embed else []),
        *_given("--title", request.title),
        *values(request.values),
    ]


def values(chosen: Mapping[str, Value]) -> list[str]:
    """Return the arguments that set parameters."""
    return [word for name, value in chosen.items() for word in ("--set", f"{name}={_text(value)}")]


def _source(request: SourceRequest) -> str:
    # A name that begins like an option is one of this folder all the same.
    name = f"./{request.main}" if request.main.startswith("-") else request.main
    return name if request.object is None else f"{name}:{request.object}"


def _view(request: PictureRequest) -> list[str]:
    """Return the arguments that pictures and films share."""
    moved = ",".join(f"{name}={_number(value)}" for name, value in request.steering.items())
    return [
        *_given("--view", request.view, wanted=request.view != "color"),
        *_given("--mode", request.mode),
        *_given("--samples", request.samples),
        *_given("--steering", moved, wanted=bool(moved)),
    ]


def _given(option: str, value: Any, *, wanted: bool = True) -> list[str]:
    if value is None or not wanted:
        return []
    return [option, _number(value) if isinstance(value, float) else str(value)]


def _text(value: Value) -> str:
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, tuple):
        return ",".join(map(_number, value))
    return _number(value)


def _number(value: float) -> str:
    """Return a number that is read back as the same; of a whole one no decimals."""
    return str(int(value)) if value == int(value) and abs(value) < _WHOLE else repr(value)


def file_stem(request: SourceRequest) -> str:
    """Return the name of a file made of the scene, without its suffix."""
    stem = PurePath(request.main).stem
    return stem if request.object is None else f"{stem}-{request.object}"
