"""A mistake in how an object is made points at the author's line."""

from __future__ import annotations

import linecache
from functools import cached_property

import pytest

from distal.diagnostics import CompileError, Span
from distal.lang.source_places import author_place
from distal.scene.tree.errors import refuse, refuse_kind


def place_in(source: str) -> Span:
    """The place that ``here()`` in a source gives."""
    name = f"<scene {hash(source)}>"
    linecache.cache[name] = (len(source), None, source.splitlines(keepends=True), name)
    names = {"here": author_place, "__name__": "scene"}
    exec(compile(source, name, "exec"), names)
    return names["found"]


def underlined(span: Span) -> str:
    return span.text[span.col : span.end_col]


def test_a_mistake_shows_the_authors_line():
    with pytest.raises(ValueError, match="must be above 0") as caught:
        refuse("x must be above 0", "try 1")
    assert isinstance(caught.value, CompileError)
    (diagnostic,) = caught.value.diagnostics
    assert underlined(diagnostic.span) == 'refuse("x must be above 0", "try 1")'
    assert "= hint: try 1" in str(caught.value)


def test_a_thing_of_another_kind_is_a_type_error_too():
    with pytest.raises(TypeError, match="takes a number") as caught:
        refuse_kind("x takes a number")
    assert isinstance(caught.value, CompileError)


def test_columns_count_characters_not_bytes():
    span = place_in('ü = "ß"; found = here()\n')
    assert (span.line, underlined(span)) == (1, "here()")


def test_a_call_over_several_lines_is_underlined_to_the_end_of_its_first():
    span = place_in("found = [\n    here(\n    ),\n][0]\n")
    assert (span.line, span.end_line, underlined(span)) == (2, 3, "here(")
    span = place_in("found = [\n    here(),\n][0]\n")
    assert (span.line, underlined(span)) == (2, "here()")


def test_the_innermost_line_of_the_author_counts():
    span = place_in("def make():\n    return here()\n\nfound = make()\n")
    assert span.line == 2


def test_a_source_without_text_has_its_line_at_least():
    names = {"here": author_place, "__name__": "scene"}
    exec("\nfound = here()", names)
    span = names["found"]
    assert (span.line, span.text) == (2, "")


def test_a_file_changed_in_the_meantime_is_read_again(tmp_path):
    scene = tmp_path / "scene.py"
    for text in ("found = here()  # first\n", "# second\nfound = here()\n"):
        scene.write_text(text)
        names = {"here": author_place, "__name__": "scene"}
        exec(compile(text, str(scene), "exec"), names)
        assert names["found"].text == text.splitlines()[names["found"].line - 1]


def test_a_cached_property_points_at_the_line_of_the_author_who_reads_it():
    inside = {"here": author_place, "cached_property": cached_property, "__name__": "distal.made"}
    exec("class Made:\n    @cached_property\n    def place(self):\n        return here()\n", inside)
    names = {"made": inside["Made"](), "__name__": "scene"}
    exec(compile("\n\nfound = made.place", "<a scene>", "exec"), names)
    assert (names["found"].file, names["found"].line) == ("<a scene>", 3)


def test_bytecode_without_positions_has_no_line():
    code = compile("found = here()", "<bytecode alone>", "exec").replace(co_linetable=b"")
    names = {"here": author_place, "__name__": "scene"}
    exec(code, names)
    assert (names["found"].line, names["found"].text) == (0, "")
