"""A row of the field library, ready to be asked at points.

Input: a declared row's functions, values of their numbers and choices. What flows out:
values and gradients in 64 or 32 bits from the CPU device or the reference, the slope's bound, the
box. Knows nothing of what is checked.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from distal.devices import cpu, reference
from distal.fields.guarantees import UNBOUNDED, Guarantee, Primitive
from distal.frontend import Assembly, lower
from distal.frontend.signatures.annotations import to_type
from distal.frontend.signatures.signatures import MISSING, FunctionSignature, read_signature
from distal.ir.build import number as constant_number
from distal.ir.nodes import Call, Construct, Expr, FunctionRef, Gradient, Param, Read, Return
from distal.ir.types import BOOL, FLOAT, INT, VEC2, VEC3, FunctionType, Type, Vector, tuple_type
from distal.lang import Func
from distal.lang.composed import Composed
from distal.lang.resources import Buffer, TextureValue

Doubles = NDArray[np.float64]
PLACE: Final = ("p", "cell")


@dataclass(frozen=True, slots=True)
class Slot:
    """A number or choice of a shape: its name, type and default (or ``MISSING``)."""

    name: str
    type: Type
    default: Any

    @property
    def is_choice(self) -> bool:
        """Whether it is fixed when the shape is compiled."""
        return self.type is not FLOAT and not isinstance(self.type, Vector)


def header_of(func: Func) -> FunctionSignature:
    """The first line of a function."""
    header = read_signature(func.overloads[0])
    assert not header.problems, header.problems
    return header


@cache
def slots_of(func: Func) -> tuple[Slot, ...]:
    """The numbers and choices of a shape's function."""
    slots = (Slot(s.name, to_type(s.annotation), s.default) for s in header_of(func).parameters)
    return tuple(s for s in slots if s.name not in PLACE)


@cache
def dimension_of(func: Func) -> int:
    """2 for a flat shape, 3 for a solid."""
    point = to_type(next(s.annotation for s in header_of(func).parameters if s.name == "p"))
    assert isinstance(point, Vector)
    return point.size


def _constant(assembly: Assembly, name: str, value: Any) -> Expr:
    if isinstance(value, TextureValue | Buffer):
        return assembly.resource(value, name)
    if isinstance(value, bool):
        return assembly.constant(value, BOOL)
    assert isinstance(value, int), f"{name} is {value!r}"
    return assembly.constant(value, INT)


class FieldFunction(Composed):
    """``(p, *numbers) -> (distance, gradient)`` with the choices fixed."""

    def __init__(self, func: Func, choices: Mapping[str, Any]) -> None:
        self._func, self._choices = func, choices
        self.name = func.name
        self._point = VEC2 if dimension_of(func) == 2 else VEC3
        self._numbers = [Param(s.name, s.type) for s in slots_of(func) if not s.is_choice]
        self.signature = (("p", self._point), *((n.name, n.type) for n in self._numbers))
        self.result = tuple_type((FLOAT, self._point))

    def compose(self, assembly: Assembly) -> str:
        """The function in a program."""
        given = {n.name: Read(n.name, n.type) for n in self._numbers}
        given |= {n: _constant(assembly, n, v) for n, v in self._choices.items()}
        place = {"p": Read("p", self._point), "cell": constant_number(0.0, VEC3)}
        params = (Param("p", self._point), *self._numbers)
        value = assembly.call(self._func, {**given, **place})
        inner = assembly.define("distance", params, FLOAT, (Return(value),))
        captures = tuple(given[n.name] for n in self._numbers)
        field = FunctionRef(inner, captures, FunctionType((self._point,), FLOAT))
        result = Gradient(field, place["p"], True, self.result)
        return assembly.define("with_gradient", params, self.result, (Return(result),))


class BoundsFunction(Composed):
    """``(unused, *numbers) -> (slope, low, high, growth, side_growth)``, the choices fixed."""

    def __init__(self, row: Primitive, choices: Mapping[str, Any]) -> None:
        self._row, self._choices = row, choices
        self.name = f"promise of {row.name}"
        self._point = VEC2 if dimension_of(row.distance) == 2 else VEC3
        self._numbers = [Param(s.name, s.type) for s in slots_of(row.distance) if not s.is_choice]
        self.signature = (("unused", FLOAT), *((n.name, n.type) for n in self._numbers))
        self.result = tuple_type((FLOAT, self._point, self._point, FLOAT, FLOAT))

    def compose(self, assembly: Assembly) -> str:
        """The function in a program."""
        given: dict[str, Expr] = {n.name: Read(n.name, n.type) for n in self._numbers}
        given |= {n: _constant(assembly, n, v) for n, v in self._choices.items()}
        row = self._row
        exact = Guarantee.EXACT_OUTSIDE in row.claims or row.bounds is None
        growth = (1.0 if exact else UNBOUNDED) if row.growth is None else row.growth
        side_growth = growth if row.side_growth is None else row.side_growth
        slope, *growths = (
            assembly.call(rule, given) if isinstance(rule, Func) else constant_number(float(rule))
            for rule in (row.slope, growth, side_growth)
        )
        low = constant_number(-UNBOUNDED, self._point)
        high = constant_number(UNBOUNDED, self._point)
        if self._row.bounds is not None:
            box = assembly.call(self._row.bounds, given)
            assert isinstance(box, Call)
            low, high = (_corner(box, name, self._point) for name in ("low", "high"))
        params = (Param("unused", FLOAT), *self._numbers)
        result = Construct((slope, low, high, *growths), self.result)
        return assembly.define("promise", params, self.result, (Return(result),))


def _corner(box: Expr, name: str, point: Type) -> Expr:
    from distal.ir.build import field as field_of  # noqa: PLC0415

    found = field_of(box, name)
    assert found.type is point, f"bounds have {found.type} corners, the shape's point is {point}"
    return found


@dataclass(frozen=True, slots=True)
class Sample:
    """A row with values of its numbers and choices.

    Attributes:
        row: The declared row.
        numbers: Floats and tuples of floats, by name.
        choices: Ints, bools, buffers and textures, by name.
    """

    row: Primitive
    numbers: Mapping[str, Any]
    choices: Mapping[str, Any]

    def __str__(self) -> str:
        shown = {
            n: v if not isinstance(v, Buffer | TextureValue) else f"{len(v.data)} values"
            for n, v in {**self.numbers, **self.choices}.items()
        }
        return f"{self.row.name}({', '.join(f'{n}={_short(v)}' for n, v in shown.items())})"

    def kernel(self, *, precision: int = 64, device: str = "cpu") -> Any:
        """The compiled distance with gradient."""
        return _kernel(self.row, self._key(), self, precision, device)

    def _key(self) -> tuple[Any, ...]:
        """Samples with equal keys share a kernel: buffers are bound when it runs."""
        return tuple(
            (n, type(v).__name__ if isinstance(v, Buffer | TextureValue) else v)
            for n, v in self.choices.items()
        )

    def evaluate(
        self, points: NDArray[Any], *, precision: int = 64, device: str = "cpu"
    ) -> tuple[NDArray[Any], NDArray[Any]]:
        """Distances (n,) and gradients (n, 2 or 3) at points."""
        dtype = np.float64 if precision == 64 else np.float32
        kernel, resources = self.kernel(precision=precision, device=device)
        bound = {name: self.choices[wish] for name, wish in resources.items()}
        numbers = [
            np.asarray([self.numbers[s.name]], dtype)
            for s in slots_of(self.row.distance)
            if not s.is_choice
        ]
        rows = [np.ascontiguousarray(points, dtype), *numbers]
        # One thread: tests run side by side already.
        d, g = kernel.evaluate(rows, {}, bound, threads=1)
        return np.broadcast_to(d, len(points)), np.broadcast_to(g, points.shape)

    def promise(self) -> tuple[float, Doubles, Doubles, float, float]:
        """The slope's bound, the box's corners, the growths, from the reference in 64 bits."""
        module = lower(BoundsFunction(self.row, self.choices))
        resources = {r.name: r.source for r in module.resources}
        kernel = reference.prepare(module, precision=64)
        numbers = [
            np.asarray([self.numbers[s.name]], np.float64)
            for s in slots_of(self.row.distance)
            if not s.is_choice
        ]
        found = kernel.evaluate([np.zeros(1), *numbers], {}, resources)
        slope, low, high, *growths = (part[0] for part in found)
        growth, side_growth = map(float, growths)
        return float(slope), endless(low), endless(high), growth, side_growth


def _short(value: Any) -> str:
    if isinstance(value, float):
        return f"{value:.6g}"
    if isinstance(value, tuple):
        return f"({', '.join(map(_short, value))})"
    return str(value)


def endless(corner: Sequence[float]) -> Doubles:
    found = np.array(corner, np.float64)
    found[np.abs(found) > UNBOUNDED / 1000.0] *= np.inf
    return found


_KERNELS: dict[Any, Any] = {}


def _kernel(row: Primitive, key: Any, sample: Sample, precision: int, device: str) -> Any:
    whole = (id(row), key, precision, device)
    if whole not in _KERNELS:
        module = lower(FieldFunction(row.distance, sample.choices))
        kept = {id(v): n for n, v in sample.choices.items()}
        resources = {r.name: kept[id(r.source)] for r in module.resources}
        room = cpu if device == "cpu" else reference
        # The row is kept too, so that its id stays its own.
        _KERNELS[whole] = (room.prepare(module, precision=precision), resources), row
    return _KERNELS[whole][0]


def default_of(slot: Slot) -> Any:
    """A slot's default as plain numbers, or None."""
    if slot.default is MISSING:
        return None
    if isinstance(slot.type, Vector):
        size = slot.type.size
        value = slot.default
        return tuple(float(v) for v in (value if np.ndim(tuple(value)) else [value] * size))
    return float(slot.default) if slot.type is FLOAT else slot.default
