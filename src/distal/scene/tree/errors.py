"""Errors in the construction of a scene object, reported at the author's line.

Input: a message, a hint, and a place (by default the innermost call outside this package). Output:
an exception that is printed like every other error in a scene, and that ``except ValueError`` or
``except TypeError`` catches.
"""

from __future__ import annotations

import warnings
from typing import NoReturn

from distal.diagnostics import CompileError, Diagnostic, Span
from distal.error_codes import ErrorCode
from distal.lang.source_places import author_place


class SceneValueError(CompileError, ValueError):
    """A scene object does not accept this value."""


class SceneTypeError(CompileError, TypeError):
    """A scene object does not accept a value of this type."""


class SceneWarningError(CompileError, UserWarning):
    """A warning about a scene object, which a filter of Python's makes an error."""


def warn(message: str, place: Span | None) -> None:
    """Warn of a scene object at the author's line.

    Args:
        message: What may be wrong, and what to write instead.
        place: The author's line, if it is known.

    Raises:
        SceneWarningError: A filter makes warnings errors.
    """
    try:
        if place is None:
            warnings.warn(message, stacklevel=3)
        else:
            warnings.warn_explicit(message, UserWarning, place.file, place.line)
    except UserWarning:
        raise SceneWarningError([Diagnostic(ErrorCode.OBJECT, message, place)]) from None


def refuse(message: str, hint: str | None = None, place: Span | None = None) -> NoReturn:
    """Raise an error about a value.

    Args:
        message: What is wrong.
        hint: What to write instead.
        place: The author's line; the innermost call outside this package by default.

    Raises:
        SceneValueError: Always.
    """
    raise SceneValueError([Diagnostic(ErrorCode.OBJECT, message, place or author_place(), hint)])


def refuse_kind(message: str, hint: str | None = None, place: Span | None = None) -> NoReturn:
    """Raise an error about a value of the wrong type; arguments as for ``refuse``.

    Raises:
        SceneTypeError: Always.
    """
    raise SceneTypeError([Diagnostic(ErrorCode.OBJECT, message, place or author_place(), hint)])
