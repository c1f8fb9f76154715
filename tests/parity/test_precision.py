"""The same source in 64 bits: vector code against the reference, far closer than 32 bits allow."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from distal.ir import build
from distal.ir.types import FLOAT, Kind, Scalar, kind_of
from tests.parity import targets
from tests.parity.cases import table_cases
from tests.parity.comparing import disagreement
from tests.parity.programs import Case, program
from tests.parity.sampling import SAMPLES


def scalar_cases() -> list[Case]:
    """The rows on scalars, but those that see a float's 32 bits."""
    return [
        case
        for case in table_cases()
        if all(isinstance(t, Scalar) and kind_of(t) is Kind.FLOAT for t in case.args)
        and case.expression([build.read("x", t) for t in case.args]).type is FLOAT
    ]


@pytest.mark.parametrize("half", [0, 1])
def test_rows_in_64_bits(half: int) -> None:
    packed = program(scalar_cases()[half::2])
    args = (packed.module, packed.width, SAMPLES, packed.buffers, 64)
    expected, actual = targets.reference(*args), targets.cpu(*args)
    messages = []
    for (case, before), (_, after) in zip(
        packed.results(expected), packed.results(actual), strict=True
    ):
        # Both are rounded to 32 bits at the end: half a unit of the last place each.
        exact = replace(case, rtol=1.2e-7, atol=1e-30)
        messages.append(disagreement(exact, before, after, on_cpu=True).message)
    assert not any(messages), "\n".join(filter(None, messages))


def test_32_bits_are_not_64() -> None:
    """The test above could tell: in 32 bits the same rows differ from the 64 bit reference."""
    packed = program([case for case in scalar_cases() if case.name.startswith(("sin(", "pow("))])
    args = (packed.module, packed.width, SAMPLES, packed.buffers)
    assert not np.array_equal(targets.reference(*args, 64), targets.cpu(*args, 32))
