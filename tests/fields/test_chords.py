"""Every chord that a shape declares agrees with its field, also at extreme numbers and starts.

Numbers, starts and directions are drawn anew each day; a failure names the seed.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Final

import numpy as np
import pytest

from distal.devices import cpu, reference
from distal.fields.guarantees import Primitive
from distal.frontend import Assembly, lower
from distal.ir.build import number as constant_number
from distal.ir.nodes import Param, Read, Return
from distal.ir.types import VEC2, VEC3
from distal.lang.composed import Composed
from tests.fields.drawing import default_sample, random_sample, sample_with
from tests.fields.library import operators, primitives
from tests.fields.rows import Sample, _constant, slots_of
from tests.fields.seeds import seed_of, seeded

LINES: Final = 400
EPS: Final = {32: 2.0**-24, 64: 2.0**-53}
DECLARED: Final = {name: row for name, row in primitives().items() if row.chord is not None}
ROWS: Final = [pytest.param(row, id=name) for name, row in DECLARED.items()]
# Numbers far from the usual ones: huge, tiny, long, flat.
EXTREME: Final[Mapping[str, list[dict[str, Any]]]] = {
    "Sphere": [{"radius": 1e4}, {"radius": 1e-3}],
    "Ellipsoid": [{"radii": (0.05, 1.0, 8.0)}],
    "Box": [{"size": (1e3, 1e-3, 5.0)}],
    "Cylinder": [{"radius": 1e-2, "height": 50.0}, {"radius": 50.0, "height": 1e-2}],
    "Capsule": [{"radius": 0.3, "length": 0.0}, {"radius": 1e-2, "length": 100.0}],
    "CapsuleBetween": [{"start": (1.0, 2.0, 3.0), "end": (1.0, 2.0, 3.0), "radius": 0.5}],
    "CappedCone": [
        {"bottom": 0.0, "top": 2.0, "height": 0.1},
        {"bottom": 0.5, "top": 0.5, "height": 3.0},
        {"bottom": 0.1, "top": 0.0, "height": 40.0},
    ],
}


class ChordFunction(Composed):
    """``(p, direction, *numbers) -> chord``, with the choices fixed."""

    result = VEC2

    def __init__(self, row: Primitive, choices: Mapping[str, Any]) -> None:
        self._row, self._choices = row, choices
        self.name = f"chord of {row.name}"
        self._numbers = [Param(s.name, s.type) for s in slots_of(row.distance) if not s.is_choice]
        line = (("p", VEC3), ("direction", VEC3))
        self.signature = (*line, *((n.name, n.type) for n in self._numbers))

    def compose(self, assembly: Assembly) -> str:
        """The function in a program."""
        given = {name: Read(name, type) for name, type in self.signature}
        given |= {n: _constant(assembly, n, v) for n, v in self._choices.items()}
        assert self._row.chord is not None
        value = assembly.call(self._row.chord, {**given, "cell": constant_number(0.0, VEC3)})
        params = tuple(Param(name, type) for name, type in self.signature)
        return assembly.define("chord", params, VEC2, (Return(value),))


_KERNELS: dict[Any, Any] = {}


def _kernel(sample: Sample, precision: int, device: Any) -> tuple[Any, dict[str, Any]]:
    key = (sample.row.name, precision, device.__name__, *map(id, sample.choices.values()))
    if key not in _KERNELS:
        module = lower(ChordFunction(sample.row, sample.choices))
        resources = {r.name: r.source for r in module.resources}
        _KERNELS[key] = device.prepare(module, precision=precision), resources, sample
    return _KERNELS[key][:2]


def chords(sample: Sample, p: np.ndarray, d: np.ndarray, precision: int, device: Any = cpu) -> Any:
    """Where lines enter and leave a shape, (n, 2)."""
    kernel, resources = _kernel(sample, precision, device)
    dtype = np.float64 if precision == 64 else np.float32
    numbers = [
        np.asarray([sample.numbers[s.name]], dtype)
        for s in slots_of(sample.row.distance)
        if not s.is_choice
    ]
    rows = [np.ascontiguousarray(a, dtype) for a in (p, d)]
    found = kernel.evaluate([*rows, *numbers], {}, resources)
    return np.asarray(found[0] if isinstance(found, list | tuple) else found, np.float64)


def samples(row: Primitive) -> list[Sample]:
    """The default numbers, random ones, extreme ones."""
    rng = np.random.default_rng(seed_of(f"chords of {row.name}"))
    drawn = [default_sample(row)]
    if slots_of(row.distance):
        drawn += [s for s in (random_sample(row, rng) for _ in range(2)) if s is not None]
    return drawn + [sample_with(row, numbers) for numbers in EXTREME.get(row.name, [])]


def lines(sample: Sample, rng: np.random.Generator) -> tuple[np.ndarray, np.ndarray, float]:
    """Starts and unit directions of lines near a shape, and its size."""
    _, low, high, _, _ = sample.promise()
    low = np.where(np.isfinite(low), low, -2.0)
    high = np.where(np.isfinite(high), high, 2.0)
    size = float(np.max(high - low))
    targets = rng.uniform(low - 0.1 * (high - low), high + 0.1 * (high - low), (LINES, 3))
    # Lines to the axes and the middle: through tips, along axes.
    targets[::7] *= rng.integers(0, 2, targets[::7].shape)
    d = rng.normal(size=(LINES, 3))
    d[::3] *= rng.integers(0, 2, d[::3].shape)  # some components are 0
    d[1::9] *= np.array([1e-6, 1.0, 1e-6])  # almost along the axis
    d[np.all(d == 0.0, axis=1)] = (0.0, 1.0, 0.0)
    d /= np.linalg.norm(d, axis=1, keepdims=True)
    away = size * rng.choice([0.0, 1e-3, 0.3, 1.0, 10.0, 1e3], LINES)
    return targets - away[:, None] * d, d, size


def disagreements(sample: Sample, precision: int) -> list[str]:
    """What a chord says that the field does not."""
    rng = np.random.default_rng(seed_of(f"lines of {sample}"))
    p, d, size = lines(sample, rng)
    if precision == 32:  # the same numbers for both
        p, d = p.astype(np.float32), d.astype(np.float32)
        p, d = p.astype(np.float64), d.astype(np.float64)
    found = chords(sample, p, d, precision)
    if not np.isfinite(found).all():
        return [f"{sample}: not finite"]
    slope = sample.promise()[0]
    hit = found[:, 0] <= found[:, 1]
    # What rounding of the places on the line may change.
    reach = np.linalg.norm(p, axis=1) + size
    error = 24.0 * slope * EPS[precision] * reach + 1e-12 * size

    def field(t: np.ndarray) -> np.ndarray:
        return sample.evaluate(p + t[:, None] * d)[0]

    said = []

    def expect(condition: np.ndarray, what: str) -> None:
        for i in np.flatnonzero(~condition)[:2]:
            line = f"p={p[i].tolist()} d={d[i].tolist()} chord={found[i].tolist()}"
            said.append(f"{sample}, {precision} bits: {what}: {line}")

    near = np.abs(found) < 10.0 * reach[:, None]
    for side in range(2):
        t = np.where(near[:, side], found[:, side], 0.0)
        checked = hit & near[:, side]
        expect(~checked | (np.abs(field(t)) <= error), "an end is not on the surface")
    begin = np.maximum(found[:, 0], -10.0 * reach)
    end = np.minimum(found[:, 1], 10.0 * reach)
    for share in (0.1, 0.5, 0.9):
        t = np.where(hit, begin + share * (end - begin), 0.0)
        expect(~hit | (end < begin) | (field(t) <= error), "the middle is outside")
    # Beside the chord nothing is inside; beside a line that misses, nowhere.
    first, last = np.where(hit[:, None], found, 0.0).T
    middle = -np.sum(p * d, axis=1)
    for share in rng.uniform(-1.0, 1.0, 60):
        t = middle + share * np.where(np.arange(LINES) % 2, 1.0, 0.05) * 2.0 * size
        outside = ~hit | (t < first) | (t > last)
        expect(~outside | (field(t) >= -error), "a place outside is inside")
    return said


@pytest.mark.parametrize("row", ROWS)
def test_a_chord_agrees_with_its_field(row: Primitive):
    said = [w for s in samples(row) for bits in (64, 32) for w in disagreements(s, bits)]
    assert not said, seeded(said[:6])


def test_the_reference_has_the_same_chords():
    sample = default_sample(primitives()["CappedCone"])
    p, d, _ = lines(sample, np.random.default_rng(0))
    ours = chords(sample, p[:40], d[:40], 64)
    theirs = chords(sample, p[:40], d[:40], 64, reference)
    np.testing.assert_allclose(ours, theirs, rtol=1e-9, atol=1e-9)


def test_a_start_on_a_huge_ball_sees_it_as_close_as_its_field_says():
    ball = sample_with(primitives()["Sphere"], {"radius": 6371.0})
    above = np.float32(6371.0005)
    p = np.array([[0.0, above, 0.0]], np.float64)
    down = np.array([[0.0, -1.0, 0.0]])
    entry = chords(ball, p, down, 32)[0, 0]
    assert entry == pytest.approx(float(above) - 6371.0, abs=1e-6)


def test_only_solids_have_chords_and_only_rigid_moves_turn_them():
    assert {"Sphere", "Ellipsoid", "Box", "Plane", "HalfSpace", "Cylinder"} <= set(DECLARED)
    assert {"Capsule", "Cone", "CappedCone", "CylinderBetween"} <= set(DECLARED)
    assert all(row.signed and not row.flat for row in DECLARED.values())
    turning = {name for name, row in operators().items() if row.turn is not None}
    assert all(operators()[name].linear for name in turning)
