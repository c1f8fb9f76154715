"""Exceptions for errors that are found while lowering.

Lowering an expression raises a ``SceneError``. The enclosing statement records its diagnostic, and
lowering continues with the next statement. ``FollowupError`` is raised for a name whose definition
failed: that error was reported already.
"""

from __future__ import annotations

import difflib
from collections.abc import Iterable

from distal.diagnostics import Diagnostic, Span


class SceneError(Exception):
    """An error in the author's code, with its source place.

    Attributes:
        diagnostic: The message, the span and a hint.
    """

    def __init__(self, message: str, span: Span | None, hint: str | None = None) -> None:
        super().__init__(message)
        self.diagnostic = Diagnostic(message, span, hint)


class FollowupError(Exception):
    """The consequence of an error that was reported already."""


def did_you_mean(name: str, known: Iterable[str]) -> str | None:
    """Return a hint with the known name most similar to ``name``; None if none is similar."""
    # One letter of three is another one: 'fow' is 'fov'.
    cutoff = 0.7 if len(name) > 3 else 0.66
    close = difflib.get_close_matches(name, list(known), n=1, cutoff=cutoff)
    return f"did you mean '{close[0]}'?" if close else None
