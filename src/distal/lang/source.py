"""Capture the source text of a decorated function when it is decorated.

Input: a Python function. Output: its file, its line, and all lines of the file as they are now, so
that a later edit has no effect. Nothing is parsed here, so decorating is cheap. All functions of a
file share one list of lines.
"""

from __future__ import annotations

import linecache
import os
from collections.abc import Sequence
from dataclasses import dataclass
from types import FunctionType


def folder_of(file: str) -> str:
    """Return the folder of a file of code, also where the code has left the working folder."""
    entry = linecache.cache.get(file)  # ``distal.load`` puts the path of a scene's file there
    folder = os.path.dirname(os.path.abspath(file))
    loaded_from = folder if entry is None or len(entry) < 4 else os.path.dirname(entry[3])
    return os.path.dirname(file) if loaded_from in (folder, "") else loaded_from


@dataclass(frozen=True, slots=True)
class Source:
    """The source text of a function and its place.

    Attributes:
        file: The name of the file in Python; a notebook cell has one too.
        lines: All lines of the file with their newlines; empty if the text is not available.
        first_line: The line of the first decorator, or of ``def``; counted from 1.
    """

    file: str
    lines: Sequence[str]
    first_line: int


def capture(function: FunctionType) -> Source:
    """Return the text of the file that ``function`` was just loaded from."""
    code = function.__code__
    # If a file was edited and loaded again, linecache must not return the old lines.
    linecache.checkcache(code.co_filename)
    lines = linecache.getlines(code.co_filename, function.__globals__)
    return Source(code.co_filename, lines, code.co_firstlineno)
