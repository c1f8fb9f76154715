"""Mistakes of a lesson's author, at their line with a fix.

Input: a message, a line and a hint. Output: a ``CompileError``.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from difflib import get_close_matches

from distal.diagnostics import CompileError, Diagnostic, Span
from distal.error_codes import ErrorCode


def mistake(
    file: str, lines: Sequence[str], line: int, message: str, hint: str | None = None
) -> CompileError:
    """Return the error at a line, counted from 1."""
    text = lines[line - 1] if 0 < line <= len(lines) else ""
    start = len(text) - len(text.lstrip())
    span = Span(file, line, start, max(len(text.rstrip()), start + 1), text, line)
    return CompileError([Diagnostic(ErrorCode.LESSON, message, span, hint)])


def choice_hint(given: str, known: Iterable[str]) -> str:
    """Return the hint for a name that is not among the known ones."""
    names = list(known)
    close = get_close_matches(given, names, 1)
    return f"did you mean '{close[0]}'?" if close else f"known: {', '.join(names) or 'none'}"
