"""The line of the author's source where a scene object is made.

Input: the running frames. Output: a ``Span`` of the innermost call outside this package (examples
count as outside). Called for every shape, light and material, so that a mistake that is found later
is still reported at the right line. A call takes one or two microseconds and does not read the
file.
"""

from __future__ import annotations

import functools
import linecache
import os
import sys
from collections.abc import Sequence
from dataclasses import dataclass, field
from types import CodeType, FrameType
from typing import Final, TypeAlias

from distal.diagnostics import Span
from distal.session import SESSION

# First and last line, first and last column in bytes of UTF-8; None if Python did not record it.
_Position: TypeAlias = tuple[int | None, int | None, int | None, int | None]

_PACKAGE: Final = os.path.dirname(os.path.dirname(os.path.abspath(__file__))) + os.sep
_GALLERY: Final = os.path.join(_PACKAGE, "gallery") + os.sep
# A cached property is called by the standard library: its caller is meant.
_CACHING: Final = functools.cached_property.__get__.__code__.co_filename
# The table of a scene of a thousand lines takes 100 kB; a few code objects are enough, because
# loops call few functions.
_REMEMBERED: Final = 16


@dataclass(frozen=True, slots=True)
class _CodeText:
    """Cached facts about a code object: the position of each instruction, the file's lines.

    Attributes:
        code: The code object, kept alive, so that its id is not reused.
        positions: The position of each instruction.
        lines: The lines of the file.
        spans: The spans that were asked for, by instruction: a loop makes its parts at one place.
    """

    code: CodeType
    positions: tuple[_Position, ...]
    lines: Sequence[str]
    spans: dict[int, Span] = field(default_factory=dict)


_texts: dict[int, _CodeText] = SESSION.keep("texts of code", {})
_inside: dict[str, bool] = {}


def author_place() -> Span | None:
    """Return the innermost call outside this package, or None if there is none."""
    frame: FrameType | None = sys._getframe(1)
    while frame is not None:
        inside = _inside.get(frame.f_code.co_filename)
        if not (_is_inside(frame) if inside is None else inside):
            return _span(frame)
        frame = frame.f_back
    return None


def _is_inside(frame: FrameType) -> bool:
    file = frame.f_code.co_filename
    found = _inside.get(file)
    if found is None:
        if file.startswith("<"):
            # Code made at run time (by dataclasses, for example) belongs to the module of its
            # globals; the name "<string>" is not unique, so it is not cached.
            module = str(frame.f_globals.get("__name__", ""))
            return module.partition(".")[0] == "distal"
        found = is_library(file) or file == _CACHING
        _inside[file] = found
    return found


def is_library(file: str) -> bool:
    """Return whether a file is part of distal: no author edits it. Examples are no part."""
    path = os.path.abspath(file)
    return path.startswith(_PACKAGE) and not path.startswith(_GALLERY)


def _span(frame: FrameType) -> Span:
    text = _text(frame)
    found = text.spans.get(frame.f_lasti)
    if found is None:
        found = text.spans[frame.f_lasti] = _span_at(frame, text)
    return found


def _span_at(frame: FrameType, text: _CodeText) -> Span:
    index = frame.f_lasti // 2  # one position for each two bytes of bytecode
    known: _Position = (None, None, None, None)
    if 0 <= index < len(text.positions):
        known = text.positions[index]
    line = known[0] or frame.f_lineno or 0  # bytecode without positions has no line
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
        # If a file is edited and loaded again in one process, its new lines must be shown.
        linecache.checkcache(code.co_filename)
        lines = linecache.getlines(code.co_filename, frame.f_globals)
        if len(_texts) >= _REMEMBERED:
            _texts.clear()
        found = _texts[id(code)] = _CodeText(code, tuple(code.co_positions()), lines)
    return found


def _characters(line: str, column: int) -> int:
    """Convert a column in bytes of UTF-8 to a column in characters."""
    if line.isascii():
        return min(column, len(line))
    return len(line.encode()[:column].decode(errors="ignore"))
