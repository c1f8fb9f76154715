"""The place in the author's source where a scene object is made.

Input: the running frames. Output: a ``Span`` of the innermost call outside this
package (examples are outside). Called for every shape, light and material, so that a mistake found
later still points at the line; a place costs a microsecond or two, not a look at the file.
"""

from __future__ import annotations

import linecache
import os
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from types import CodeType, FrameType
from typing import Final, TypeAlias

import distal
from distal.diagnostics import Span

# First and last line, first and last column in bytes of UTF-8; None where Python kept none.
_Position: TypeAlias = tuple[int | None, int | None, int | None, int | None]

_PACKAGE: Final = os.path.dirname(os.path.abspath(distal.__file__)) + os.sep
_GALLERY: Final = os.path.join(_PACKAGE, "gallery") + os.sep
# A scene of a thousand lines has a table of 100 kB; a few codes take turns, as loops call helpers.
_REMEMBERED: Final = 16


@dataclass(frozen=True, slots=True)
class _CodeText:
    """What is known of a code object: where each instruction stands, and the file's lines."""

    code: CodeType  # kept alive: it is known by its id
    positions: tuple[_Position, ...]
    lines: Sequence[str]


_texts: dict[int, _CodeText] = {}
_inside: dict[str, bool] = {}


def author_place() -> Span | None:
    """The innermost call outside this package, or None where there is none."""
    frame: FrameType | None = sys._getframe(1)
    while frame is not None and _is_inside(frame):
        frame = frame.f_back
    return None if frame is None else _span(frame)


def _is_inside(frame: FrameType) -> bool:
    file = frame.f_code.co_filename
    found = _inside.get(file)
    if found is None:
        if file.startswith("<"):
            # Code made at run time, as dataclasses do, belongs to whose globals it has; one name
            # ("<string>") stands for many files, so nothing is remembered.
            module = str(frame.f_globals.get("__name__", ""))
            return module.partition(".")[0] == "distal"
        path = os.path.abspath(file)
        found = path.startswith(_PACKAGE) and not path.startswith(_GALLERY)
        _inside[file] = found
    return found


def _span(frame: FrameType) -> Span:
    text = _text(frame)
    index = frame.f_lasti // 2  # one position for each unit of two bytes
    known: _Position = (None, None, None, None)
    if 0 <= index < len(text.positions):
        known = text.positions[index]
    line = known[0] or frame.f_lineno
    content = text.lines[line - 1].rstrip("\r\n") if 1 <= line <= len(text.lines) else ""
    end_line = known[1] or line
    if known[0] is None or known[2] is None or known[3] is None:
        start, end = len(content) - len(content.lstrip()), len(content)
    else:
        start = _characters(content, known[2])
        end = _characters(content, known[3]) if end_line == line else len(content)
    return Span(frame.f_code.co_filename, line, start, end, content, end_line)


def _text(frame: FrameType) -> _CodeText:
    code = frame.f_code
    found = _texts.get(id(code))
    if found is None:
        # A file edited and loaded again in one process must not show its old lines.
        linecache.checkcache(code.co_filename)
        lines = linecache.getlines(code.co_filename, frame.f_globals)
        if len(_texts) >= _REMEMBERED:
            del _texts[next(iter(_texts))]
        found = _texts[id(code)] = _CodeText(code, tuple(code.co_positions()), lines)
    return found


def _characters(line: str, column: int) -> int:
    """A column in characters, of one in bytes of UTF-8."""
    if line.isascii():
        return min(column, len(line))
    return len(line.encode()[:column].decode(errors="ignore"))
