"""The place of an object in its author's file, as plain values for editors.

Input: a span. Output: the values in the schema of ``docs/guide/checking.md``.
"""

from __future__ import annotations

from typing import Any

from distal.diagnostics import Span


def place_json(span: Span | None) -> dict[str, Any] | None:
    """Return a place with lines and columns counted from 1, as in editors."""
    if span is None:
        return None
    return {
        "file": span.file,
        "line": span.line,
        "column": span.col + 1,
        "end_line": span.end_line or span.line,
        "end_column": span.end_col + 1,
    }
