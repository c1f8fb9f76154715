"""The grammar of SVG paths: the commands of an attribute ``d``, with absolute coordinates.

Input: a text. Output: calls of a pen. What is wrong is an error that names the place in the text.

Source: W3C, "Scalable Vector Graphics (SVG) 1.1", section 8.3 (the grammar) and appendix F.6
(arcs: a radius of 0 is a line, equal ends are nothing, radii that are too small are enlarged).
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import Any, Final

_SPACE: Final = re.compile(r"[ \t\r\n\f]*")
_SEPARATOR: Final = re.compile(r"[ \t\r\n\f]*,?[ \t\r\n\f]*")
_NUMBER: Final = re.compile(r"[+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?", re.ASCII)
_FLAG: Final = re.compile("[01]")
_NUMBERS: Final = {"M": 2, "L": 2, "H": 1, "V": 1, "C": 6, "S": 4, "Q": 4, "T": 2, "A": 7, "Z": 0}
_FLAGS: Final = (3, 4)  # among the numbers of an arc


class PathError(ValueError):
    """What is wrong with a path, and where."""

    def __init__(self, text: str, at: int, what: str) -> None:
        near = text[at : at + 12].split("\n")[0]
        where = f"at character {at + 1}, {near!r}" if near else "at its end"
        super().__init__(f"{what} {where}")


def commands(text: str) -> Iterator[tuple[str, int, list[float]]]:
    """Yield a path's commands: letter, place in the text, and numbers of one repetition.

    Repeated numbers are commands of their own; after a move they are lines.

    Raises:
        PathError: The text is no path.
    """
    at = _skip(_SPACE, text, 0)
    first = True
    while at < len(text):
        letter, start = text[at], at
        count = _NUMBERS.get(letter.upper())
        if count is None:
            raise PathError(text, at, "it has no command")
        if first and letter not in "Mm":
            raise PathError(text, at, "it does not start with M")
        first = False
        at = _skip(_SPACE, text, at + 1)
        if not count:
            yield letter, start, []
            continue
        repeated = False
        while not repeated or _NUMBER.match(text, at):
            numbers: list[float] = []
            for i in range(count):
                is_flag = letter in "Aa" and i in _FLAGS
                found = (_FLAG if is_flag else _NUMBER).match(text, at)
                if found is None:
                    kind = "the flag 0 or 1" if is_flag else "a number"
                    message = f"'{letter}' takes {count} numbers, and {kind} is missing"
                    raise PathError(text, at, message)
                numbers.append(float(found[0]))
                end = found.end()
                at = _skip(_SEPARATOR, text, end)
            yield letter, start, numbers
            letter = {"M": "L", "m": "l"}.get(letter, letter)
            repeated = True
        if "," in text[end:at]:
            raise PathError(text, text.index(",", end), "no number follows the comma")


def _skip(pattern: re.Pattern[str], text: str, at: int) -> int:
    found = pattern.match(text, at)
    assert found is not None
    return found.end()


def draw_path(text: str, pen: Any, arc: Any) -> None:
    """Draw a path.

    Args:
        text: The attribute ``d`` of a path.
        pen: A pen of fontTools.
        arc: fontTools' class of elliptical arcs.

    Raises:
        PathError: The text is no path.
    """
    here = start = control = 0j
    last, is_open = "", False
    for letter, _, numbers in commands(text):
        kind = letter.upper()
        base = here if letter.islower() else 0j
        if kind not in "MZ" and not is_open:  # after Z, the next subpath starts where this one did
            pen.moveTo(_pair(start))
            is_open = True
        if kind == "H":
            points = [complex(base.real + numbers[0], here.imag)]
        elif kind == "V":
            points = [complex(here.real, base.imag + numbers[0])]
        else:
            pairs = numbers[5:] if kind == "A" else numbers
            points = [base + complex(*pairs[i : i + 2]) for i in range(0, len(pairs), 2)]
        if kind in "ST":  # the control point is the mirror image of the last one
            mirrors = last in ("CS" if kind == "S" else "QT")
            points.insert(0, 2.0 * here - control if mirrors and last else here)
        control = points[-2] if kind in "CSQT" else here
        match kind:
            case "M":
                pen.moveTo(_pair(points[0]))
                start, is_open = points[0], True
            case "Z":
                if is_open:
                    pen.closePath()
                points, is_open = [start], False
            case "C" | "S":
                pen.curveTo(*map(_pair, points))
            case "Q" | "T":
                pen.qCurveTo(*map(_pair, points))
            case "A" if numbers[0] and numbers[1] and points[0] != here:
                _draw_arc(
                    pen,
                    arc(
                        here,
                        *map(abs, numbers[:2]),
                        numbers[2],
                        *map(bool, numbers[3:5]),
                        points[0],
                    ),
                )
            case _:
                if points[0] != here:
                    pen.lineTo(_pair(points[0]))
        here, last = points[-1], kind
    if is_open:
        pen.endPath()


def _draw_arc(pen: Any, arc: Any) -> None:
    """Draw an arc as curves; the last one ends exactly where the arc ends."""
    curves = list(arc._decompose_to_cubic_curves())
    for i, (first, second, end) in enumerate(curves, 1):
        end = arc.target_point if i == len(curves) else end
        pen.curveTo(*map(_pair, (first, second, end)))
    if not curves:
        pen.lineTo(_pair(arc.target_point))


def _pair(point: complex) -> tuple[float, float]:
    return point.real, point.imag
