"""Errors in how a scene object is made, at the author's own line.

Input: what is wrong, a hint, and where (by default the innermost call outside this
package). Output: an exception that prints as every other mistake in a scene does, and that
``except ValueError`` or ``except TypeError`` catches as Python's own.
"""

from __future__ import annotations

from typing import NoReturn

from distal.diagnostics import CompileError, Diagnostic, Span
from distal.scene.tree.source_places import author_place


class SceneValueError(CompileError, ValueError):
    """A value that a scene object cannot take."""


class SceneTypeError(CompileError, TypeError):
    """A thing of another kind than a scene object takes."""


def refuse(message: str, hint: str | None = None, place: Span | None = None) -> NoReturn:
    """Refuse a value.

    Raises:
        SceneValueError: Always.
    """
    raise SceneValueError([Diagnostic(message, place or author_place(), hint)])


def refuse_kind(message: str, hint: str | None = None, place: Span | None = None) -> NoReturn:
    """Refuse a thing that is not of the kind asked for.

    Raises:
        SceneTypeError: Always.
    """
    raise SceneTypeError([Diagnostic(message, place or author_place(), hint)])
