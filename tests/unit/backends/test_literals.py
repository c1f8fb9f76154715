"""Decimals of emitted text read back as the very same 32-bit floats."""

from __future__ import annotations

import struct

import pytest
from hypothesis import given
from hypothesis import strategies as st

from distal.backends.clike.literals import float_literal, int_literal
from distal.diagnostics import CompileError


def single(value: float) -> float:
    return struct.unpack("<f", struct.pack("<f", value))[0]


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (0.0, "0.0"),
        (-0.0, "-0.0"),
        (1.0, "1.0"),
        (-2.5, "-2.5"),
        (0.1, "0.1"),
        (single(0.1), "0.1"),
        (1e-7, "1e-7"),
        (1.5e-7, "1.5e-7"),
        (0.00003, "0.00003"),
        (1e20, "1e20"),
        (-1.25e30, "-1.25e30"),
        (16777216.0, "16777216.0"),
        (100.0, "100.0"),
        (3.4028234663852886e38, "3.4028235e38"),
        (1.401298464324817e-45, "1e-45"),
    ],
)
def test_spelling(value: float, text: str) -> None:
    assert float_literal(value) == text


@given(st.floats(width=32, allow_nan=False, allow_infinity=False))
def test_reads_back(value: float) -> None:
    text = float_literal(value)
    assert single(float(text)) == value
    assert "." in text or "e" in text


@given(st.floats(min_value=-3e38, max_value=3e38))
def test_rounds_once(value: float) -> None:
    assert single(float(float_literal(value))) == single(value)


def test_too_large() -> None:
    with pytest.raises(CompileError, match=r"1e\+39 is too large for a 32-bit float"):
        float_literal(1e39)


def test_ints() -> None:
    assert int_literal(-5) == "-5"
    assert int_literal(-(2**31)) == "-2147483647 - 1"
