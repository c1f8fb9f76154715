"""Parse texts of the command line.

Input: texts. Output: plain values, or ``UsageError`` with one clear message. Does not depend on
typer or on rendering.
"""

from __future__ import annotations

import math
import re
import unicodedata
from collections.abc import Iterable, Sequence
from difflib import get_close_matches
from pathlib import Path

from distal.example_files import EXAMPLE_PREFIX
from distal.ir.limits import LARGEST_TIME
from distal.lang.parameter_values import LARGEST_FLOAT, Value
from distal.lang.parameters import Parameter
from distal.loading import split_source
from distal.scene.steering import Steering


class UsageError(Exception):
    """The command line is invalid."""


def read_scene(text: str) -> tuple[str, str | None]:
    """Split FILE[:NAME] or example:NAME[:NAME] into the path for ``distal.load`` and the name.

    Raises:
        UsageError: There is no file or example in it.
    """
    path, name = split_source(text)
    if path in ("", EXAMPLE_PREFIX):
        raise UsageError(f"'{text}' names no {'example' if path else 'file'}")
    return path, name


def check_is_not_scene(output: Path, scene: str) -> None:
    """Check that a file to write is not the scene's own.

    Raises:
        UsageError: It is.
    """
    if output.resolve() == Path(read_scene(scene)[0]).resolve():
        raise UsageError(f"'{output}' is the scene itself")


def check_lengths(**lengths: float | None) -> None:
    """Check that lengths are above 0 and finite.

    Raises:
        UsageError: One is not.
    """
    for name, length in lengths.items():
        if length is not None and not 0.0 < length < float("inf"):
            raise UsageError(f"--{name} is a length above 0, not {length:g}")


def read_size(text: str, largest: int) -> tuple[int, int]:
    """Parse WIDTHxHEIGHT; each side is from 1 to ``largest`` pixels.

    Raises:
        UsageError: The text is not a size, or a side is out of range.
    """
    match = re.fullmatch(r"\s*([0-9]{1,9})\s*[xX]\s*([0-9]{1,9})\s*", text)
    if match is None:
        raise UsageError(f"a size is WIDTHxHEIGHT in pixels, like 640x480, not '{text:.40}'")
    width, height = int(match[1]), int(match[2])
    if not (1 <= width <= largest and 1 <= height <= largest):
        raise UsageError(f"each side has 1 to {largest} pixels, not {width}x{height}")
    return width, height


def read_time(text: str) -> float:
    """Parse a finite number of seconds.

    Raises:
        UsageError: The text is not a number, or is out of range.
    """
    try:
        time = float(text)
    except ValueError:
        raise UsageError(f"a time is a number of seconds, not '{text:.40}'") from None
    if not math.isfinite(time):
        raise UsageError(f"a time is finite, not {time}")
    if abs(time) > LARGEST_TIME:
        raise UsageError(
            f"a time is within {LARGEST_TIME:.0f} seconds (12 days) of 0, not {time:g}"
        )
    return time


def read_steering(text: str) -> Steering:
    """Parse NAME=NUMBER,NAME=NUMBER: how a person has moved the camera.

    Raises:
        UsageError: The text is not of this form, or a name or number is invalid.
    """
    numbers: dict[str, float] = {}
    for part in text.split(","):
        name, equals, number = (piece.strip() for piece in part.partition("="))
        try:
            value = float(number) if equals else math.nan
        except ValueError:
            value = math.nan
        if not math.isfinite(value) or name in numbers:
            raise UsageError(
                f"--steering takes names and numbers, like yaw=0.3,zoom=0.8, not '{text:.60}'"
            )
        numbers[name] = value
    try:
        return Steering.of(numbers)
    except ValueError as error:
        raise UsageError(f"--steering: {error}") from None


def read_plane(text: str) -> tuple[tuple[float, float, float], float]:
    """Parse AXIS=OFFSET; return the plane's normal and its distance from the origin.

    Raises:
        UsageError: The text is not of this form.
    """
    axis, equals, offset = (part.strip() for part in text.partition("="))
    normals = {"x": (1.0, 0.0, 0.0), "y": (0.0, 1.0, 0.0), "z": (0.0, 0.0, 1.0)}
    try:
        distance = float(offset)
    except ValueError:
        distance = math.nan
    if not equals or axis not in normals or not abs(distance) <= LARGEST_FLOAT:
        raise UsageError(f"a slice is AXIS=OFFSET, like y=0.5, not '{text:.40}'")
    return normals[axis], distance


def read_pixel(text: str, size: tuple[int, int]) -> tuple[int, int]:
    """Parse X,Y; return column and row of a pixel, counted from 0 at the upper left.

    Raises:
        UsageError: The text is not of this form, or the pixel is outside the picture.
    """
    match = re.fullmatch(r"\s*([0-9]{1,9})\s*,\s*([0-9]{1,9})\s*", text)
    if match is None:
        raise UsageError(f"a pixel is X,Y from the upper left, like 320,240, not '{text:.40}'")
    x, y = int(match[1]), int(match[2])
    if x >= size[0] or y >= size[1]:
        width, height = size
        raise UsageError(f"a picture of {width}x{height} ends at {width - 1},{height - 1}")
    return x, y


def read_assignments(texts: Iterable[str], parameters: Sequence[Parameter]) -> dict[str, Value]:
    """Parse ``name=value`` texts; each value is checked by its parameter.

    Raises:
        UsageError: A text is invalid. The message lists the parameters, because the user may not
            know the scene.
    """
    known = {parameter.name: parameter for parameter in parameters}
    values: dict[str, Value] = {}
    for text in texts:
        name, equals, value = text.partition("=")
        name = unicodedata.normalize("NFKC", name.strip())  # some keyboards decompose letters
        if not equals or not name:
            raise UsageError(f"--set takes name=value, not '{text:.60}'\n{_listing(parameters)}")
        if name not in known:
            close = get_close_matches(name, known, 1)
            meant = f"; did you mean '{close[0]}'?" if close else ""
            raise UsageError(f"there is no parameter '{name:.60}'{meant}\n{_listing(parameters)}")
        if name in values:
            raise UsageError(f"--set gives '{name}' twice")
        try:
            values[name] = known[name].parse(value)
        except ValueError as error:
            raise UsageError(f"--set {name}: {error}\n{_listing(parameters)}") from None
    return values


def _listing(parameters: Sequence[Parameter]) -> str:
    if not parameters:
        return "this scene has no parameters"
    width = max(len(p.name) for p in parameters)
    rows = (f"  {p.name.ljust(width)}  {p.describe()}" for p in parameters)
    return "\n".join(("parameters:", *rows))
