"""Where the parity tests sample: for each case, one list of numbers for each argument.

Input: a row's name, its domain and the kinds of its arguments. Output: ``SAMPLES``
bit patterns for each argument; sample i of all arguments belongs together, so that edges meet the
edges they are meant to meet. Vectors take neighboring samples for their other components.
"""

from __future__ import annotations

import random
from collections.abc import Sequence
from typing import Final

import numpy as np
from numpy.typing import NDArray

from distal.ir.types import Kind

SAMPLES: Final = 64
COMPONENT_STRIDE: Final = 13  # component c of sample i is number i + 13 c: odd, so all differ

Bits = NDArray[np.uint32]

INT_MIN, INT_MAX, UINT_MAX = -(2**31), 2**31 - 1, 2**32 - 1
FLOAT_EDGES: Final = (0.0, -0.0, 1.0, -1.0, 0.5, -0.5, 1.5, -1.5, 2.5, -2.5, 3.0, -3.0, 0.25)
INT_EDGES: Final = (0, 1, -1, 2, -2, 7, -7, 31, 32, 33, INT_MIN, INT_MAX, INT_MIN + 1, 65535)
UINT_EDGES: Final = (0, 1, 2, 3, 7, 31, 32, 33, 2**31, UINT_MAX, UINT_MAX - 1, 65535, 65536)
NAN, INFINITY = float("nan"), float("inf")

# Arguments that belong together, by row; the rest of the samples is drawn from the domain.
MEETINGS: Final[dict[str, tuple[tuple[float, ...], ...]]] = {
    "pow": (
        *((0.0, 0.0), (0.0, 2.0), (0.0, 0.5), (-1.0, 2.0), (-1.0, 0.0), (1.0, 5.0), (2.0, 8.0)),
        *((8.0, 8.0), (0.5, 8.0), (8.0, 0.0), (1e-6, 0.5), (1e-6, 2.0), (1.0, 0.0)),
    ),
    "atan2": (
        *((0.0, 0.0), (1.0, 0.0), (-1.0, 0.0), (0.0, 1.0), (0.0, -1.0), (1.0, 1.0), (1.0, -1.0)),
        *((-1.0, 1.0), (-1.0, -1.0), (1e-3, -8.0), (-1e-3, -8.0), (8.0, 1e-3), (8.0, -1e-3)),
    ),
    "isnan": ((NAN,), (-NAN,), (INFINITY,), (-INFINITY,), (0.0,), (1.0,), (3e38,), (1e-30,)),
    "isinf": ((NAN,), (-NAN,), (INFINITY,), (-INFINITY,), (0.0,), (1.0,), (3e38,), (1e-30,)),
    "mod": ((-3.0, 2.0), (3.0, 2.0), (-0.25, 1.0), (4.0, 4.0), (-4.0, 4.0), (0.0, 1.0), (5.5, 0.5)),
    "round": ((0.5,), (1.5,), (2.5,), (-0.5,), (-1.5,), (-2.5,), (0.49999997,), (8388609.0,)),
    "smoothstep": ((-1.0, 1.0, -1.0), (-1.0, 1.0, 1.0), (-2.0, 2.0, 0.0)),
    "step": ((1.0, 1.0), (0.0, 0.0), (1.0, 0.5), (-1.0, -1.0)),
    "refract": ((0.0, -1.0, 1.0),),
    "//": ((INT_MIN, -1), (INT_MIN, 0), (7, -2), (-7, 2)),
    "%": ((INT_MIN, -1), (INT_MIN, 0), (7, -2), (-7, 2)),
    "truncated_quotient": ((7, 2), (-7, 2), (7, -2), (-7, -2), (INT_MIN, 1), (INT_MAX, -1), (0, 5)),
}


def samples(
    name: str, kinds: Sequence[Kind], domain: Sequence[tuple[float, float]] | None
) -> list[Bits]:
    """``SAMPLES`` bit patterns for each argument; the same in every run."""
    source = random.Random(f"samples of {name} {[kind.value for kind in kinds]}")
    rows: list[tuple[float, ...]] = [
        meeting
        for meeting in MEETINGS.get(name, ())
        if all(kind is not Kind.UINT or x >= 0 for kind, x in zip(kinds, meeting, strict=True))
    ]
    edges = [_edges(kind, domain[i] if domain else None) for i, kind in enumerate(kinds)]
    # Every edge of one argument meets random edges of the others.
    for position, own in enumerate(edges):
        for edge in own:
            drawn = [source.choice(others) for others in edges]
            rows.append((*drawn[:position], edge, *drawn[position + 1 :]))
    while len(rows) < SAMPLES:
        rows.append(
            tuple(
                _drawn(source, kind, domain[i] if domain else None) for i, kind in enumerate(kinds)
            )
        )
    return [_bits([row[i] for row in rows[:SAMPLES]], kind) for i, kind in enumerate(kinds)]


def _edges(kind: Kind, interval: tuple[float, float] | None) -> list[float]:
    """Edges inside the interval, and its ends; ints without one take their whole range."""
    match kind:
        case Kind.FLOAT:
            low, high = interval or (-100.0, 100.0)
            return [x for x in FLOAT_EDGES if low <= x <= high] + [low, high]
        case Kind.INT if interval is None:
            return list(INT_EDGES)
        case Kind.UINT if interval is None:
            return list(UINT_EDGES)
        case Kind.INT | Kind.UINT:
            assert interval is not None
            low, high = interval
            least = max(low, 0.0) if kind is Kind.UINT else low
            return [float(np.ceil(least)), float(np.floor(high))]
        case Kind.BOOL:
            return [0, 1]


def _drawn(source: random.Random, kind: Kind, interval: tuple[float, float] | None) -> float:
    match kind:
        case Kind.FLOAT:
            return source.uniform(*(interval or (-100.0, 100.0)))
        case Kind.BOOL:
            return source.randint(0, 1)
        case Kind.INT if interval is None:
            # Half of them small: an operator's answer for large ones is often 0.
            return source.randint(INT_MIN, INT_MAX) >> source.choice((0, 8, 16, 24))
        case Kind.UINT if interval is None:
            return source.randint(0, UINT_MAX) >> source.choice((0, 8, 16, 24))
        case Kind.INT | Kind.UINT:
            assert interval is not None
            least = 0.0 if kind is Kind.UINT else interval[0]
            return source.randint(int(max(least, interval[0])), int(interval[1]))


def _bits(numbers: list[float], kind: Kind) -> Bits:
    match kind:
        case Kind.FLOAT:
            return np.array(numbers, np.float32).view(np.uint32)
        case Kind.INT:
            return np.array([int(n) for n in numbers], np.int64).astype(np.int32).view(np.uint32)
        case Kind.UINT | Kind.BOOL:
            return np.array([int(n) for n in numbers], np.int64).astype(np.uint32)


def component(bits: Bits, index: int) -> Bits:
    """A component of a vector, or of a matrix counted column by column, in each sample."""
    return np.roll(bits, -COMPONENT_STRIDE * index)
