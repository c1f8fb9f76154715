"""How errors are shown as text and as JSON: places, labels, hints."""

from __future__ import annotations

from distal.diagnostics import Diagnostic, Label, LoadError, Span
from distal.error_codes import ErrorCode

LATE = Span("scene.py", 1207, 4, 9, "\tq = p.x", 1207)
EARLY = Span("parts.py", 6, 4, 9, "    q = p", 6)
FOUND = Diagnostic(
    ErrorCode.TYPE, "'q' must be vec3", LATE, "write vec3(...)", (Label(EARLY, "a vec3 here"),)
)


def test_a_label_is_shown_below_with_its_place():
    assert str(FOUND) == (
        "error: 'q' must be vec3\n"
        "    --> scene.py:1207:5\n"
        "     |\n"
        "1207 | \tq = p.x\n"
        "     | \t   ^^^^\n"
        "    ::: parts.py:6:5\n"
        "     |\n"
        "   6 |     q = p\n"
        "     |     ----- a vec3 here\n"
        "     = hint: write vec3(...)"
    )


def test_an_error_without_a_place_may_have_labels():
    found = Diagnostic(ErrorCode.TARGET, "no buffers", None, None, (Label(EARLY, "read here"),))
    assert found.text("warning") == (
        "warning: no buffers\n  ::: parts.py:6:5\n   |\n 6 |     q = p\n   |     ----- read here"
    )


def test_the_json_has_the_places_as_editors_count_them():
    assert FOUND.to_json() == {
        "code": "type",
        "message": "'q' must be vec3",
        "hint": "write vec3(...)",
        "file": "scene.py",
        "line": 1207,
        "column": 5,
        "end_line": 1207,
        "end_column": 10,
        "excerpt": "\tq = p.x",
        "labels": [
            {
                "text": "a vec3 here",
                "file": "parts.py",
                "line": 6,
                "column": 5,
                "end_line": 6,
                "end_column": 10,
                "excerpt": "    q = p",
            }
        ],
    }


def test_the_json_of_an_unknown_place_has_no_numbers():
    (found,) = LoadError("there is no file", hint="look there").diagnostics
    assert found.to_json() == {
        "code": "file",
        "message": "there is no file",
        "hint": "look there",
        **dict.fromkeys(("file", "line", "column", "end_line", "end_column", "excerpt")),
        "labels": [],
    }
