"""Wrap long lines of C-like text at readable places.

Input: one line. Output: the same tokens on several lines, broken after a comma or before an
operator, inside as few brackets as possible.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator

from distal.backends.clike.code import Line

WIDTH = 100
_INDENT = " " * 8
# After ", " and before an operator such as " + "; never inside the header of a for loop.
_BREAK = re.compile(r"(?<=, )|(?<= )(?=(?:[-+*/?:|&]|&&|\|\||==|!=|<=?|>=?) )")
_LOOSENESS = {"?": 3, ":": 3, "|": 2, "&": 2, "+": 1, "-": 1}


def wrapped(lines: Iterable[Line]) -> Iterator[Line]:
    """Yield lines of at most ``WIDTH`` characters, as far as they can be broken."""
    for line in lines:
        if len(line.text) <= WIDTH or "//" in line.text or line.text.lstrip().startswith("for "):
            yield line
        else:
            for text in _pieces(line.text):
                yield Line(text, line.span)


def _pieces(text: str) -> Iterator[str]:
    indent = text[: len(text) - len(text.lstrip())]
    while len(text) > WIDTH:
        at = _best_break(text, len(indent) + len(_INDENT))
        if at is None:
            break
        yield text[:at].rstrip()
        text = indent + _INDENT + text[at:]
    yield text


def _best_break(text: str, first: int) -> int | None:
    """Return the best break: the fewest brackets, then the loosest operator, then the last."""
    best: tuple[int, int, int] | None = None
    depths = _depths(text)
    for match in _BREAK.finditer(text, first + 1, WIDTH):
        at = match.start()
        looseness = 4 if text[at - 2] == "," else _LOOSENESS.get(text[at], 0)
        here = (-depths[at], looseness, at)
        if best is None or here > best:
            best = here
    return None if best is None else best[2]


def _depths(text: str) -> list[int]:
    depths, depth = [], 0
    for char in text:
        if char in ")]":
            depth -= 1
        depths.append(depth)
        if char in "([":
            depth += 1
    return [*depths, depth]
