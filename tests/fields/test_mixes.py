"""How much of b's material shows: between 0 and 1, and all of one where only that one is near."""

from __future__ import annotations

from typing import Any, Final

import numpy as np
import pytest

from distal.devices import reference
from distal.fields.guarantees import Bounds, Bounds2, Operator
from distal.frontend import Assembly, lower
from distal.ir.nodes import Expr, Param, Read, Return
from distal.ir.types import BOOL, FLOAT, INT, VEC2, VEC3
from distal.lang.composed import Composed
from tests.fields.drawing import drawn, fits
from tests.fields.library import operators
from tests.fields.rows import header_of
from tests.fields.seeds import seed_of, seeded
from tests.fields.trees import operator_slots

ROWS: Final = [
    pytest.param(row, id=name) for name, row in operators().items() if row.mix is not None
]
COUNT: Final = 2000


class MixOf(Composed):
    """``(a, b, p, q) -> mix`` of an operator with its numbers fixed."""

    def __init__(self, row: Operator, numbers: dict[str, Any]) -> None:
        self.name = f"mix of {row.name}"
        self._row, self._numbers = row, numbers
        self.signature = (("a", FLOAT), ("b", FLOAT), ("p", VEC3), ("q", VEC2))
        self.result = FLOAT

    def compose(self, assembly: Assembly) -> str:
        """The function in a program."""
        assert self._row.mix is not None
        given: dict[str, Expr] = {n: Read(n, t) for n, t in self.signature}
        for slot in operator_slots(self._row):
            value = self._numbers[slot.name]
            kind = {bool: BOOL, int: INT}.get(type(value), slot.type)
            given[slot.name] = assembly.constant(value, kind)
        for slot in header_of(self._row.mix).parameters:
            if slot.name.startswith("slope"):
                given[slot.name] = assembly.constant(1.0, FLOAT)
        flat = any(
            str(s.annotation) == "vec2"
            for s in header_of(self._row.mix).parameters
            if s.name == "p"
        )
        if flat:
            given["p"] = given["q"]
        result = assembly.call(self._row.mix, given)
        params = tuple(Param(n, t) for n, t in self.signature)
        return assembly.define("mix", params, FLOAT, (Return(result),))


def _mixes(row: Operator, a: Any, b: Any, rng: np.random.Generator) -> Any:
    values = next(
        v for _ in range(500) if fits(row, v := drawn(operator_slots(row), row.limits, rng))
    )
    kernel = reference.prepare(lower(MixOf(row, values)), precision=64)
    p = rng.uniform(-1.5, 1.5, (len(a), 3))
    return np.broadcast_to(kernel.evaluate([a, b, p, p[:, :2]], {}, {}), len(a))


@pytest.mark.parametrize("row", ROWS)
def test_a_mix_is_a_share(row: Operator):
    if {s.annotation for s in header_of(row.mix).parameters} & {Bounds, Bounds2}:
        pytest.skip("asks for boxes; seen in pictures")
    rng = np.random.default_rng(seed_of(f"mix {row.name}"))
    scale = 10.0 ** rng.uniform(-4.0, 1.0, COUNT)
    a, b = rng.normal(size=(2, COUNT)) * scale
    a[:50], b[25:75] = 0.0, 0.0
    b[100:150] = a[100:150]
    for _ in range(3):
        mix = _mixes(row, a, b, rng)
        assert np.isfinite(mix).all(), seeded([])
        assert mix.min() >= 0.0, seeded([])
        assert mix.max() <= 1.0, seeded([])


@pytest.mark.parametrize("blend", ["quadratic", "cubic", "quartic", "circular", "chamfer", "round"])
def test_far_from_the_seam_one_of_a_union_shows(blend: str):
    row = operators()[f"union {blend}"]
    rng = np.random.default_rng(2)
    near, far = rng.uniform(-0.5, 0.5, 100), rng.uniform(50.0, 60.0, 100)
    assert _mixes(row, near, far, rng).max() == 0.0
    assert _mixes(row, far, near, rng).min() == 1.0
