"""The text of a decorated function, captured when it is decorated.

Input: a Python function. Output: where it was written and the lines of the whole
file as they are now, so that a later edit never mixes in. Nothing is parsed here: decorating must
cost next to nothing. The lines of a file are one shared list, however many functions it has.
"""

from __future__ import annotations

import linecache
from collections.abc import Sequence
from dataclasses import dataclass
from types import FunctionType


@dataclass(frozen=True, slots=True)
class Source:
    """Where a function was written.

    Attributes:
        file: The file's name as Python knows it; a notebook cell has one too.
        lines: All lines of the file, newlines included; empty when there is no text.
        first_line: The line of the first decorator, or of ``def``; counted from 1.
    """

    file: str
    lines: Sequence[str]
    first_line: int


def capture(function: FunctionType) -> Source:
    """Take the text of the file that ``function`` was just loaded from."""
    code = function.__code__
    # A file edited and loaded again in one process must not give its old lines.
    linecache.checkcache(code.co_filename)
    lines = linecache.getlines(code.co_filename, function.__globals__)
    return Source(code.co_filename, lines, code.co_firstlineno)
