"""A mistake found while lowering, on its way from an expression to its statement.

An expression raises a ``SceneError``; the statement around it records the diagnostic and lowering
goes on with the next statement. ``FollowupError`` is raised for a name whose own definition failed:
its mistake was reported already.
"""

from __future__ import annotations

import difflib
from collections.abc import Iterable

from distal.diagnostics import Diagnostic, Span


class SceneError(Exception):
    """A mistake of the author at a place."""

    def __init__(self, message: str, span: Span | None, hint: str | None = None) -> None:
        super().__init__(message)
        self.diagnostic = Diagnostic(message, span, hint)


class FollowupError(Exception):
    """The consequence of a mistake that was reported elsewhere."""


def did_you_mean(name: str, known: Iterable[str]) -> str | None:
    """A hint with the known name closest to ``name``, if one is close."""
    close = difflib.get_close_matches(name, list(known), n=1, cutoff=0.7)
    return f"did you mean '{close[0]}'?" if close else None
