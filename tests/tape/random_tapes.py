"""Random tapes and boxes for the tests of the runtime."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from hypothesis import strategies as st
from numpy.typing import NDArray

from distal.tape.operations import OPERATIONS
from distal.tape.tape import Tape, TapeBuilder

LANES = 64
# Sums of extremes overflow, products of them underflow; 1e-40 is denormal.
NUMBERS = (0.0, -0.0, 1.0, -1.0, 0.5, 3.0, -7.25, 1e-40, 1e-30, -1e-30, 1e30, -1e30, 3e38)
_INNER = [row for row in OPERATIONS if row.operands]
# Choices decide what is pruned, so half of the operations are choices.
_CHOICES = [row for row in _INNER if row.chooses]


@dataclass(frozen=True)
class Case:
    tape: Tape
    low: NDArray[np.float32]
    high: NDArray[np.float32]
    points: NDArray[np.float32]

    def __repr__(self) -> str:
        return str(self.tape)


@st.composite
def tapes(draw: st.DrawFn, most: int = 40, elementary: bool = True) -> Tape:
    """Return a tape whose operands are mostly among its last values."""
    builder = TapeBuilder()
    values = [builder.operation(axis) for axis in "xyz"]
    numbers = draw(st.lists(st.sampled_from(NUMBERS), min_size=1, max_size=4))
    values += [builder.constant(number) for number in numbers]
    bools: list[int] = []
    rows = [row for row in _INNER if elementary or row.trend is None]
    for _ in range(draw(st.integers(1, most))):
        row = draw(st.sampled_from(_CHOICES if draw(st.booleans()) else rows))
        back = st.integers(1, min(len(values), 12))
        operands = [values[-draw(back)] for _ in range(row.operands)]
        if row.name == "select":
            if not bools:
                bools.append(builder.operation("less", operands[0], operands[1]))
            operands[0] = bools[-1]
        made = builder.operation(row.name, *operands)
        if row.name in ("less", "less_equal", "equal"):
            bools.append(made)
        values.append(made)
    return builder.tape(values[-1])


@st.composite
def cases(draw: st.DrawFn, elementary: bool = True) -> Case:
    """Return a tape, 64 boxes of very different sizes, and points in them, corners included."""
    tape = draw(tapes(elementary=elementary))
    rng = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    center = rng.choice([1.0, 1.0, 10.0, 1e4, 1e30], (LANES, 3)) * rng.normal(size=(LANES, 3))
    size = rng.choice([0.0, 1e-6, 0.01, 1.0, 30.0], (LANES, 3)) * rng.uniform(size=(LANES, 3))
    scale = draw(st.sampled_from([1.0, 1.0, 1e-3, 1e20]))
    most = 3e38
    low = np.clip(scale * (center - size), -most, most).astype(np.float32)
    high = np.maximum(low, np.clip(scale * (center + size), -most, most).astype(np.float32))
    t = rng.choice([0.0, 1.0, 0.5, rng.uniform()], (LANES, LANES, 3))
    ends = [end[:, None].astype(np.float64) for end in (low, high)]
    points = (ends[0] * (1.0 - t) + ends[1] * t).astype(np.float32)
    points = np.clip(points, low[:, None], high[:, None])
    return Case(tape, low, high, points)


def bits(values: NDArray[np.float32]) -> NDArray[np.int32]:
    """Return the bits of floats, all NaN equal."""
    plain = np.where(np.isnan(values), np.float32(np.nan), values).astype(np.float32)
    return plain.view(np.int32)
