"""Where a function's text comes from, and where its mistakes are shown."""

from __future__ import annotations

import importlib.util
import linecache
import os
import sys
from pathlib import Path
from types import ModuleType

import pytest

from distal.diagnostics import CompileError
from distal.frontend import lower
from distal.frontend.source import parse_definition
from distal.lang.source import Source
from tests.unit.frontend.evaluation import from_text, printed


def run_file(path: Path) -> ModuleType:
    spec = importlib.util.spec_from_file_location("scene_of_a_test", path)
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_a_later_edit_never_mixes_in(tmp_path: Path) -> None:
    sys.dont_write_bytecode, before = True, sys.dont_write_bytecode
    path = tmp_path / "scene.py"
    text = "from distal.lang import func\n@func\ndef scene(x: float) -> float:\n    return x * {}\n"
    try:
        path.write_text(text.format("2.0"))
        first = run_file(path).scene
        path.write_text("# moved\n\n\n" + text.format("33.0"))
        os.utime(path, (1, 1))
        second = run_file(path).scene
    finally:
        sys.dont_write_bytecode = before
    assert "(mul x 2.0)" in printed(first)
    assert "(mul x 33.0)" in printed(second)


def test_without_text_there_is_a_mistake() -> None:
    scope: dict[str, object] = {}
    code = "from distal.lang import func\n@func\ndef scene(x: float) -> float:\n    return x\n"
    exec(compile(code, "<nowhere>", "exec", dont_inherit=True), scope)
    with pytest.raises(CompileError, match="the source text of 'scene' is not available"):
        lower(scope["scene"])  # type: ignore[arg-type]


def test_text_that_is_not_what_runs_is_refused() -> None:
    scene = from_text("@func\ndef scene(x: float) -> float:\n    return x\n", file="changed.py")
    lines = ["# another file\n"] * 8
    other = Source("changed.py", lines, scene.overloads[0].source.first_line)
    with pytest.raises(CompileError, match="is not what Python runs"):
        parse_definition(other, "scene")


def test_definitions_are_found_in_every_layout() -> None:
    scene = from_text('''
        def other(f):
            return f

        if True:
            @other
            @func
            # a comment
            def scene(
                p: vec3,
                r: float = 1.0,
            ) -> float:
                """A text with
        lines at the margin
                """

                d = (
        length(p)
                )
                # a comment at the end
                return d - r
            after = 1
        ''')
    assert "return (sub d r)" in printed(scene)


def test_one_line_and_tabs() -> None:
    scene = from_text("@func\ndef scene(x: float) -> float: return x + 1\nafter = 2\n")
    assert "(add x 1.0)" in printed(scene)
    tabs = "@func\ndef scene(x: float) -> float:\n\tif x > 0:\n\t\treturn y\n\treturn x\n"
    tabbed = from_text(tabs)
    with pytest.raises(CompileError) as caught:
        lower(tabbed)
    text, caret = str(caught.value).splitlines()[-2:]
    assert text.endswith("5 | \t\treturn y")
    assert caret.endswith(" | \t\t       ^")


def test_columns_are_counted_in_characters() -> None:
    scene = from_text("@func\ndef scene(größe: float) -> float:\n    return größe * oops\n")
    with pytest.raises(CompileError) as caught:
        lower(scene)
    (diagnostic,) = caught.value.diagnostics
    assert diagnostic.span is not None
    assert (diagnostic.span.col, diagnostic.span.end_col) == (19, 23)


def test_two_functions_on_one_line_of_decorators() -> None:
    scene = from_text("""
        @func
        def first(x: float) -> float:
            return x

        scene = first
        """)
    assert printed(scene).startswith("fn first")
    assert linecache.getlines("author.py")
