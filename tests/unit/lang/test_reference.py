"""The page of built-ins: fresh, complete, and true about what a target refuses."""

from __future__ import annotations

import linecache
import re
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

import distal
from distal.ir.intrinsics import INTRINSICS
from distal.ir.types import Kind, kind_of
from distal.lang.names import FORMS

ROOT = Path(__file__).parents[3]
PAGE = ROOT / "docs/reference/builtins.md"
VISIBLE = [row for row in INTRINSICS.values() if not row.hidden]


def test_it_is_fresh() -> None:
    command = [sys.executable, ROOT / "tools/gen_reference.py", "--check"]
    done = subprocess.run(command, capture_output=True, text=True, timeout=60)
    assert done.returncode == 0, done.stderr


def test_every_name_is_in_it() -> None:
    text = PAGE.read_text()
    headings = re.findall(r"^### `(\w+)\(", text, re.MULTILINE)
    assert headings == [row.name for row in VISIBLE]
    assert all(f"| `{form.signature}` |" in text for form in FORMS)
    for page in ("docs/README.md", "docs/language.md"):
        assert "reference/builtins.md" in (ROOT / page).read_text()


def entry_of(name: str) -> str:
    return PAGE.read_text().partition(f"### `{name}(")[2].partition("\n#")[0]


@pytest.mark.parametrize("row", VISIBLE, ids=lambda row: row.name)
def test_a_row_is_refused_where_the_page_says(row: Any) -> None:
    instances = [i for s in row.signatures for i in s.instances()]
    # As an ES 1.00 text would like it best: without unsigned numbers.
    params, result = min(
        instances, key=lambda i: sum(kind_of(t) is Kind.UINT for t in (*i[0], i[1]))
    )
    arguments = ", ".join(f"{t}({_literal(kind_of(t))})" for t in params)
    text = (
        "from distal.lang import *\n\n@func\n"
        f"def used({', '.join(f'a{i}: {t}' for i, t in enumerate(params))}) -> {result}:\n"
        f"    return {row.name}({', '.join(f'a{i}' for i in range(len(params)))})\n\n"
        "@image\ndef picture(frame: Frame) -> vec3:\n"
        f"    value = used({arguments})\n"
        "    return vec3(1.0)\n"
    )
    file = f"reference_{row.name}.py"
    linecache.cache[file] = (len(text), None, text.splitlines(keepends=True), file)
    scope: dict[str, Any] = {"__name__": "reference"}
    exec(compile(text, file, "exec"), scope)
    refused = False
    try:
        distal.compile(scope["picture"], target="glsl-es100")
    except distal.CompileError as error:
        assert "glsl-es100 has no" in str(error), error
        refused = True
    assert refused == ("ES 1.00 *refused*" in entry_of(row.name))


def _literal(kind: Kind | None) -> str:
    return {Kind.INT: "1", Kind.UINT: "1", Kind.BOOL: "True"}.get(kind or Kind.FLOAT, "0.5")
