"""The codes of errors: declared in one table, all in use, at most 40, and listed in the docs."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from distal.diagnostics import CompileError
from distal.error_codes import MOST_CODES, ErrorCode
from distal.frontend import lower

from .test_errors import load

ROOT = Path(__file__).parents[2]
CASES = Path(__file__).parent / "cases"
PAGE = ROOT / "docs/reference/errors.md"


def test_there_are_at_most_40():
    assert len(ErrorCode) <= MOST_CODES == 40
    assert all(re.fullmatch(r"[a-z]+(-[a-z]+)*", code) for code in ErrorCode)
    assert len({code.meaning for code in ErrorCode}) == len(ErrorCode)


def test_each_is_in_use_and_each_in_use_is_declared():
    sources = (p.read_text("utf-8") for p in (ROOT / "src/distal").rglob("*.py"))
    used = {name for text in sources for name in re.findall(r"\bErrorCode\.([A-Z_]+)\b", text)}
    assert used == {code.name for code in ErrorCode}


def test_the_page_lists_them(update_golden: bool):
    rows = [f"| `{code}` | {code.meaning} |\n" for code in ErrorCode]
    table = "".join(["| code | meaning |\n", "|---|---|\n", *rows])
    text = PAGE.read_text("utf-8")
    head, heading, listed = text.partition("## Codes\n\n")
    if update_golden:
        PAGE.write_text(f"{head}{heading}{table}", "utf-8")
        listed = table
    assert listed == table, "run pytest tests/errors --update-golden"


CODES = {
    "lambda_as_func": {"definition"},
    "array_mixed": {"type", "size"},
    "dictionary": {"not-a-value"},
    "division_by_zero": {"number"},
    "index_negative": {"index"},
    "parameters_of_one_name": {"parameter-name"},
    "two_in_a_statement": {"type", "unknown-name"},
    "unpack_count": {"assignment", "type"},
    "loop_else": {"not-scene-code"},
}


@pytest.mark.parametrize(("name", "codes"), CODES.items())
def test_an_error_has_the_code_of_its_family(name: str, codes: set[str]):
    with pytest.raises(CompileError) as caught:
        lower(load(CASES / f"{name}.py").scene)
    assert {diagnostic.code for diagnostic in caught.value.diagnostics} == codes
