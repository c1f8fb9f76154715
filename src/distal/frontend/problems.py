"""Exceptions for errors that are found while lowering.

Lowering an expression raises a ``SceneError``. The enclosing statement records its diagnostic, and
lowering continues with the next statement. ``FollowupError`` is raised for a name whose definition
failed: that error was reported already.
"""

from __future__ import annotations

import difflib
from collections.abc import Iterable
from typing import Final

from distal.diagnostics import Diagnostic, Label, Span
from distal.error_codes import ErrorCode


class SceneError(Exception):
    """An error in the author's code, with its source place.

    Attributes:
        diagnostic: The code, the message, the span, a hint and labels.
    """

    def __init__(
        self,
        code: ErrorCode,
        message: str,
        span: Span | None,
        hint: str | None = None,
        labels: tuple[Label, ...] = (),
    ) -> None:
        super().__init__(message)
        self.diagnostic = Diagnostic(code, message, span, hint, labels)


class FollowupError(Exception):
    """The consequence of an error that was reported already."""


LOWERING_ERRORS: Final = (SceneError, FollowupError)


def must_be(what: str, wanted: object, *types: object) -> str:
    """Return the message of a value, or of several values, of the wrong type.

    Args:
        what: What has the wrong type; several values are plural.
        wanted: The type that it must have, or a description of the types that it may have.
        types: The type that it has; of several values, of each one.
    """
    *first, last = map(str, types)
    if not first:
        return f"{what} must be {wanted}, but this is {last}"
    return f"{what} must be {wanted}, but these are {', '.join(first)} and {last}"


def one_of(types: Iterable[str]) -> str:
    """Return types, of which a value has one, as text: "vec2, vec3 or vec4"."""
    *first, last = types
    return f"{', '.join(first)} or {last}" if first else last


def must_match(what: str, types: Iterable[object]) -> str:
    """Return the message of several values, described by ``what``, of different types."""
    return must_be(what, "of one type", *dict.fromkeys(map(str, types)))


def must_be_call(name: str, signatures: Iterable[str], types: Iterable[object]) -> str:
    """Return the message of a call that matches no signature of the function.

    Args:
        name: The function.
        signatures: Its signatures as text: ``name(p: vec3) -> float``.
        types: The types of the arguments.
    """
    call = f"{name}({', '.join(map(str, types))})"
    return must_be(f"a call of '{name}'", " or ".join(signatures), call)


def did_you_mean(name: str, known: Iterable[str]) -> str | None:
    """Return a hint with the known name most similar to ``name``; None if none is similar."""
    # One letter of three is another one: 'fow' is 'fov'.
    cutoff = 0.7 if len(name) > 3 else 0.66
    close = difflib.get_close_matches(name, list(known), n=1, cutoff=cutoff)
    return f"did you mean '{close[0]}'?" if close else None
