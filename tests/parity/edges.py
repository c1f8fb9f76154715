"""What the table's rows give at their edges.

Input: the table. Output: cases, one for each row that takes and gives floats, of
every number that could lead out of the numbers, in all positions against each other; and numbers
that are known without any target: what the page on built-ins says.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import product
from typing import Final

import numpy as np

from distal.ir import limits
from distal.ir.build import builtin, components, compose, number
from distal.ir.intrinsics import INTRINSICS, Intrinsic
from distal.ir.nodes import Expr, Function, FunctionRef, Gradient, Param, Read, Return
from distal.ir.types import (
    FLOAT,
    MAT4,
    VEC3,
    VEC4,
    FunctionType,
    Kind,
    Matrix,
    Scalar,
    Type,
    kind_of,
    vector_of,
)
from tests.parity.cases import kinds_of
from tests.parity.programs import Case, Numbers
from tests.parity.sampling import COMPONENT_STRIDE, SAMPLES

# Prelude code and passes alone call these, with arguments that they have looked at.
LOOKED_AT: Final = frozenset(("raw_power", "raw_atan2", "saturated_int", "saturated_uint"))
# Bits become what they are the bits of; whether that is a number is not promised.
BIT_CASTS: Final = frozenset(("int_bits_to_float", "uint_bits_to_float"))

_SIZES: Final = (1e-30, 1e-19, 2.0**-64, 1e-9, 0.5, 1.0, 1.5707964, 9.5, 88.5, 129.0, 1e7)
_CENTRAL: Final = (0.0, 1e-30, -1e-30, 0.5, 1.0, -3.0)


def edge_cases() -> Iterator[tuple[Case, Numbers]]:
    """A case or two for each row of floats, and what its first samples are known to give.

    On the row's scalar form, or else its form of vectors of three (matrices of two): there the
    components are all equal first, since what is known is known of such.
    """
    for row in INTRINSICS.values():
        params = _params(row)
        if params is None or row.name in LOOKED_AT | BIT_CASTS:
            continue
        given = [args for n, args, _ in KNOWN if n == row.name]
        values = np.array([value for n, _, value in KNOWN if n == row.name])
        edges = _rows(row, len(params))
        if isinstance(params[0], Scalar):
            assert len(given) + len(edges) <= SAMPLES, row.name
            yield _case(row, params, [*given, *edges]), values
        else:
            same = [(x,) * len(params) for x in (0.0, 1e-30, 1e-19, 1.0, row.reach, -row.reach)]
            yield _case(row, params, _equal([*given, *same])), values
            yield _case(row, params, edges[:SAMPLES]), np.array([])


def _equal(rows: list[tuple[float, ...]]) -> list[tuple[float, ...]]:
    """Samples whose components are equal: the next component is so many samples further on."""
    assert len(rows) <= COMPONENT_STRIDE
    return ((rows * COMPONENT_STRIDE)[:COMPONENT_STRIDE] * SAMPLES)[:SAMPLES]


def _case(row: Intrinsic, params: tuple[Type, ...], rows: list[tuple[float, ...]]) -> Case:
    whole = np.array((rows * SAMPLES)[:SAMPLES], np.float32)
    bits = [np.ascontiguousarray(column).view(np.uint32) for column in whole.T]
    title = f"{row.name}({', '.join(map(str, params))})"
    return Case(title, params, lambda a: builtin(row.name, *a), bits, row.rtol, row.atol)


def _params(row: Intrinsic) -> tuple[Type, ...] | None:
    """The types of the row's shortest signature that takes and gives floats."""
    found = None
    for signature in row.signatures:
        for params, result in signature.instances():
            kinds = {*kinds_of(params), kind_of(result)}
            short = all(isinstance(p, Scalar) or p is VEC3 or _is_small(p) for p in params)
            if kinds == {Kind.FLOAT} and short and found is None:
                found = params
    return found


def _is_small(type: Type) -> bool:
    return isinstance(type, Matrix) and type.size == 2


def _rows(row: Intrinsic, count: int) -> list[tuple[float, ...]]:
    """Every edge alone where there is one argument, else central ones in all combinations."""
    if count == 1:
        return [(x,) for size in (0.0, *_SIZES, row.reach) for x in (size, -size)]
    found = list(product(_CENTRAL if count == 2 else (0.0, 1.0, -1.0), repeat=count))
    for size in (row.reach, -row.reach):
        found += [tuple(size if i == j else 1.0 for j in range(count)) for i in range(count)]
    return [*found, (row.reach,) * count]


# By hand: row, arguments (equal in all components), what each component of the result is.
_PI: Final = float(np.pi)
_LOWEST, _HIGHEST = limits.SMALLEST, limits.LARGEST_POWER
KNOWN: Final[tuple[tuple[str, tuple[float, ...], float], ...]] = (
    *(("sqrt", (x,), 0.0) for x in (0.0, -0.0, -1e-30, -4.0)),
    *(("inversesqrt", (x,), 2.0**63) for x in (0.0, -0.0, -1.0, 1e-39)),
    *(("log", (x,), -126.0 * float(np.log(2.0))) for x in (0.0, -0.0, -3.0, 1e-39)),
    *(("log2", (x,), -126.0) for x in (0.0, -0.0, -3.0, 1e-39)),
    *(("exp", (x,), float(np.exp(87.0))) for x in (87.0, 88.8, 1e18)),
    *(("exp", (x,), 0.0) for x in (-110.0, -1e18)),
    *(("exp2", (x,), 2.0**126) for x in (126.0, 128.0, 1e18)),
    *(("exp2", (x,), 0.0) for x in (-160.0, -1e18)),
    *(("pow", (x, -1.0), _HIGHEST) for x in (0.0, -0.0, -2.0, 1e-39)),
    *(("pow", (x, y), _HIGHEST) for x, y in ((1e18, 30.0), (0.0, -0.001), (1e-3, -1e18))),
    *(("pow", (x, y), e) for x, y, e in ((0.0, 0.0, 1.0), (-1.0, 0.0, 1.0), (0.0, 2.0, 0.0))),
    *(("asin", (x,), 0.5 * _PI) for x in (1.0, 1.0000001, 7.0)),
    *(("asin", (x,), -0.5 * _PI) for x in (-1.0, -1.0000001, -1e18)),
    *(("acos", (x,), 0.0) for x in (1.0, 1.0000001, 7.0)),
    *(("acos", (x,), _PI) for x in (-1.0, -1.0000001, -1e18)),
    *(("atan", (x,), 0.5 * _PI) for x in (1e9, 1e18)),
    *(("atan2", (y, x), e) for y, x, e in ((0.0, 0.0, 0.0), (1e18, 1e-18, 0.5 * _PI))),
    *(("tanh", (x,), 1.0) for x in (20.0, 50.0, 100.0, 1e18)),
    *(("tanh", (x,), -1.0) for x in (-20.0, -50.0, -100.0, -1e18)),
    *(("sinh", (x,), 0.5 * float(np.exp(87.0))) for x in (87.0, 90.0, 1e18)),
    *(("cosh", (x,), 0.5 * float(np.exp(87.0))) for x in (87.0, -90.0, -1e18)),
    *(("mod", (a, 0.0), 0.0) for a in (0.0, 1.0, -3.5, 1e18)),
    *(("smoothstep", (0.5, 0.5, x), e) for x, e in ((0.4, 0.0), (0.5, 1.0), (0.6, 1.0))),
    *(("smoothstep", (1.0, 0.0, x), e) for x, e in ((-1.0, 1.0), (0.5, 0.5), (2.0, 0.0))),
    *(("clamp", (x, 2.0, 1.0), 1.0) for x in (0.0, 1.5, 3.0)),
    ("normalize", (0.0,), 0.0),
    ("normalize", (1e-25,), 1e-25 * 2.0**63),
    ("normalize", (1e-17,), 3.0**-0.5),
    ("normalize", (1e18,), 3.0**-0.5),
    ("reflect", (0.0, 0.0), 0.0),
    ("reflect", (1.0, 0.0), 1.0),
    ("refract", (0.0, 0.0, 1.5), 0.0),
    ("faceforward", (0.0, 0.0, 0.0), 0.0),
    ("distance", (0.0, 0.0), 0.0),
    ("length", (0.0,), 0.0),
    ("inverse", (0.0,), 0.0),
    ("inverse", (1.0,), 0.0),
    ("determinant", (1.0,), 0.0),
    ("fract", (-1e-9,), 1.0),
    ("fract", (1e18,), 0.0),
    ("round", (1e18,), 1e18),
    ("trunc", (-1e18,), -1e18),
)


def constant_cases() -> Iterator[tuple[Case, Numbers]]:
    """The known numbers of rows of scalars with constants for arguments, sixteen in a matrix."""
    found = []
    for name, args, value in KNOWN:
        params = _params(INTRINSICS[name])
        if params is not None and all(p is FLOAT for p in params):
            found.append((builtin(name, *map(number, args)), value))
    found += found[: -len(found) % 16]
    for first in range(0, len(found), 16):
        calls = [call for call, _ in found[first : first + 16]]
        columns = [compose(VEC4, *calls[i : i + 4]) for i in range(0, 16, 4)]
        matrix = compose(MAT4, *columns)
        values = np.array([value for _, value in found[first : first + 16]])
        yield Case(f"constants from {first}", (), lambda _, m=matrix: m, []), values


def gradient_cases() -> tuple[list[Case], tuple[Function, ...]]:
    """The gradient of each row of scalars, and of one vector, at its edges; what they call."""
    cases, functions = [], []
    for row in INTRINSICS.values():
        params = _params(row)
        if params is None or row.hidden or row.name in BIT_CASTS:
            continue
        if isinstance(params[0], Scalar):
            point = vector_of(Kind.FLOAT, len(params))
            read = Read("p", point)
            value = builtin(row.name, *components(read))
        elif params == (VEC3,):
            point, read = VEC3, Read("p", VEC3)
            value = builtin(row.name, read)
            value = value if value.type is FLOAT else builtin("dot", value, number(1.0, VEC3))
        else:
            continue
        name = f"{row.name}_of_point"
        functions.append(Function(name, (Param("p", point),), FLOAT, (Return(value),), name))
        of = FunctionRef(name, (), FunctionType((point,), FLOAT))

        def slope(a: Sequence[Expr], of: Expr = of, point: Type = point) -> Expr:
            place = a[0] if len(a) == 1 else compose(point, *a)
            return Gradient(of, place, False, point)

        rows = _rows(row, len(params))[:SAMPLES] if params != (VEC3,) else _equal(
            [(x,) for x in (0.0, 1e-30, 1e-19, -1e-12, 1.0, row.reach)])  # fmt: skip
        made = _case(row, params, rows)
        cases.append(replace(made, name=f"gradient of {made.name}", expression=slope))
    return cases, tuple(functions)
