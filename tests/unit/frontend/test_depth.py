"""Calls deeper than Python's stack are one error with a place."""

from __future__ import annotations

import sys
from collections.abc import Iterator

import pytest

from distal.diagnostics import CompileError
from distal.frontend import lower
from tests.unit.frontend.evaluation import from_text


def chain(length: int) -> str:
    """Functions that call one another, the last one first."""
    first = "@func\ndef g0(x: float) -> float:\n    return x\n"
    return first + "".join(
        f"@func\ndef g{i}(x: float) -> float:\n    return g{i - 1}(x + 1.0)\n"
        for i in range(1, length)
    )


@pytest.fixture
def usual_limit() -> Iterator[None]:
    """Python's own limit of recursion: deep trees raise it for the rest of a process."""
    before = sys.getrecursionlimit()
    sys.setrecursionlimit(1000)
    yield
    sys.setrecursionlimit(before)


@pytest.mark.usefixtures("usual_limit")
def test_a_long_chain_of_calls_is_one_error() -> None:
    with pytest.raises(CompileError) as caught:
        lower(from_text(chain(500), "g499"))
    (found,) = caught.value.diagnostics
    assert found.message.startswith("functions call one another too many levels deep")
    assert "'g499'" in found.message and found.span is not None and found.hint


def test_forty_calls_deep_is_fine() -> None:
    assert len(lower(from_text(chain(40), "g39")).functions) == 40
