"""Long lines are broken, and say the same."""

from __future__ import annotations

from distal.backends.clike.code import Line
from distal.backends.clike.wrapping import WIDTH, wrapped

TERM = "scene(p + vec3(0.001, 0.0, 0.0), time) - here"


def texts(text: str) -> list[str]:
    return [line.text for line in wrapped([Line(text)])]


def test_short_lines_stay() -> None:
    assert texts("    float d = 1.0;") == ["    float d = 1.0;"]


def test_breaks_after_commas_first() -> None:
    found = texts(f"    return normalize(vec3({TERM}, {TERM}, {TERM}));")
    assert found[0] == f"    return normalize(vec3({TERM},"
    assert all(len(line) <= WIDTH for line in found)
    assert found[1].startswith("            scene")


def test_no_token_changes() -> None:
    text = f"    vec3 x = {' * '.join([TERM] * 5)} + {TERM};"
    found = texts(text)
    assert " ".join(line.strip() for line in found).split() == text.split()
    assert all(len(line) <= WIDTH for line in found)


def test_for_headers_and_comments_stay_whole() -> None:
    header = f"    for (int i = {'a' * 80}; i < {'b' * 80}; i++) {{"
    comment = "// " + "word, " * 40
    assert texts(header) == [header]
    assert texts(comment) == [comment]


def test_what_cannot_be_broken_stays() -> None:
    text = "    " + "x" * 200 + ";"
    assert texts(text) == [text]
