"""Cases packed into pictures: each column one case, each row one sample.

Input: cases, that is expressions of arguments. Output: image modules that any
target can run, and, from the pictures they give, each case's results bit for bit. A float is a
channel of a pixel; an integer two channels of 16 bits, which floats hold exactly.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from distal.ir import build
from distal.ir.build import builtin, compare, integer, swizzle, unsigned
from distal.ir.nodes import (
    BinaryOp,
    Call,
    CompareOp,
    EntryKind,
    Expr,
    Field,
    Function,
    If,
    Let,
    Module,
    Param,
    Read,
    Resource,
    ResourceDeclaration,
    Return,
    Stmt,
)
from distal.ir.types import (
    FLOAT,
    FRAME,
    INT,
    UINT,
    VEC2,
    VEC4,
    Buffer,
    Kind,
    Matrix,
    Scalar,
    Type,
    component_count,
    kind_of,
    vector_of,
)
from tests.parity.sampling import COMPONENT_STRIDE, SAMPLES, Bits, component

Numbers = NDArray[np.float64]
SAMPLES_NAME: Final = "samples"
SAMPLES_TYPE: Final = Buffer(UINT)


@dataclass(frozen=True)
class Case:
    """One expression on one choice of types.

    Attributes:
        name: For messages and for the tolerance report.
        args: The types of its arguments.
        expression: The expression from its arguments' reads.
        samples: Bit patterns for each argument.
        rtol: Relative disagreement allowed.
        atol: Absolute disagreement allowed.
        defined: Given the arguments (components, samples) and whether the target computes on the
            CPU: in which samples a promise is made.
    """

    name: str
    args: tuple[Type, ...]
    expression: Callable[[Sequence[Expr]], Expr]
    samples: Sequence[Bits]
    rtol: float = 0.0
    atol: float = 0.0
    defined: Callable[[Sequence[Numbers], bool], NDArray[np.bool_]] | None = None

    def inputs(self) -> list[Numbers]:
        """The arguments' numbers: for each one row a component."""
        result = []
        for type, bits in zip(self.args, self.samples, strict=True):
            rows = [component(bits, i) for i in range(component_count(type))]
            result.append(np.stack([_numbers(row, kind_of(type)) for row in rows]))
        return result


def _numbers(bits: Bits, kind: Kind | None) -> Numbers:
    match kind:
        case Kind.FLOAT:
            return bits.view(np.float32).astype(np.float64)
        case Kind.INT:
            return bits.view(np.int32).astype(np.float64)
        case _:
            return bits.astype(np.float64)


@dataclass(frozen=True)
class Program:
    """A picture's worth of cases.

    Attributes:
        module: An image module, before all passes.
        buffers: The data of its one buffer, which holds the samples.
        width: Its width in pixels; its height is ``SAMPLES``.
        places: For each case its first column and its result's type.
    """

    module: Module
    buffers: dict[str, NDArray[np.uint32]]
    width: int
    places: tuple[tuple[Case, int, Type], ...]

    def results(self, picture: NDArray[np.float32]) -> Iterator[tuple[Case, Numbers]]:
        """Each case's result from a picture (top row first): (components, samples)."""
        rows = picture[::-1].astype(np.float64)
        for case, column, type in self.places:
            channels = rows[:, column : column + _pixels(type)].reshape(SAMPLES, -1).T
            kind = kind_of(type)
            if kind in (Kind.INT, Kind.UINT):
                whole = channels[0::2] + channels[1::2] * 65536.0
                if kind is Kind.INT:
                    whole = np.where(whole >= 2.0**31, whole - 2.0**32, whole)
                channels = whole
            yield case, channels[: component_count(type)]


def program(cases: Sequence[Case]) -> Program:
    """Pack cases into one picture."""
    functions: list[Function] = []
    samples: dict[bytes, int] = {}  # a list of samples -> where it begins in the buffer
    body: list[Stmt] = [
        Let("coord", Field(Read("frame", FRAME), "coord", VEC2)),
        Let("column", build.cast(swizzle(Read("coord", VEC2), "x"), Kind.INT)),
        Let("row", build.cast(swizzle(Read("coord", VEC2), "y"), Kind.INT)),
    ]
    places, width = [], 0
    for number, case in enumerate(cases):
        value = case.expression([_argument(case, i, samples) for i in range(len(case.args))])
        places.append((case, width, value.type))
        name = f"case_{number}"
        functions.append(_case_function(name, value))
        part = build.subtract(Read("column", INT), integer(width))
        width += _pixels(value.type)
        here = compare(CompareOp.LT, Read("column", INT), integer(width))
        body.append(If(here, (Return(Call(name, (Read("row", INT), part), VEC4)),), ()))
    body.append(Return(build.number(0.0, VEC4)))
    picture = Function("picture", (Param("frame", FRAME),), VEC4, tuple(body), "picture")
    data = np.frombuffer(b"".join(samples), np.uint32)
    declaration = ResourceDeclaration(SAMPLES_NAME, SAMPLES_TYPE, data)
    module = Module((*functions, picture), "picture", EntryKind.IMAGE, (), (declaration,))
    return Program(module, {SAMPLES_NAME: data}, width, tuple(places))


def _case_function(name: str, value: Expr) -> Function:
    """The function that computes a case and gives one of its pixels."""
    result, last = Read("result", value.type), _pixels(value.type) - 1
    choices = [
        If(
            compare(CompareOp.EQ, Read("part", INT), integer(part)),
            (Return(_pixel(result, part)),),
            (),
        )
        for part in range(last)
    ]
    body = (Let("result", value), *choices, Return(_pixel(result, last)))
    return Function(name, (Param("row", INT), Param("part", INT)), VEC4, body, name)


def _pixels(type: Type) -> int:
    """How many pixels hold a value."""
    channels = component_count(type) * (2 if kind_of(type) in (Kind.INT, Kind.UINT) else 1)
    return -(-channels // 4)


def _argument(case: Case, position: int, samples: dict[bytes, int]) -> Expr:
    """The argument of a case in sample ``row``."""
    type, bits = case.args[position], case.samples[position]
    begin = samples.setdefault(bits.tobytes(), len(samples) * SAMPLES)
    kind = kind_of(type)
    assert kind is not None
    parts = [_component(begin, i, kind) for i in range(component_count(type))]
    match type:
        case Scalar():
            return parts[0]
        case Matrix(size):
            column = vector_of(Kind.FLOAT, size)
            columns = [parts[i * size : (i + 1) * size] for i in range(size)]
            return build.compose(type, *(build.compose(column, *c) for c in columns))
        case _:
            return build.compose(type, *parts)


def _component(begin: int, number: int, kind: Kind) -> Expr:
    shifted = build.add(Read("row", INT), integer(COMPONENT_STRIDE * number % SAMPLES))
    position = build.binary(BinaryOp.AND, shifted, integer(SAMPLES - 1))
    buffer = Resource(SAMPLES_NAME, SAMPLES_TYPE)
    bits = build.index(buffer, build.add(position, integer(begin)))
    match kind:
        case Kind.FLOAT:
            return builtin("uint_bits_to_float", bits)
        case Kind.BOOL:
            return compare(CompareOp.NE, bits, unsigned(0))
        case _:
            return build.cast(bits, kind)


def _pixel(result: Expr, part: int) -> Expr:
    channels = [c for value in _scalars(result) for c in _channels(value)]
    picked = channels[4 * part : 4 * part + 4]
    padding = [build.number(0.0)] * (4 - len(picked))
    return build.compose(VEC4, *picked, *padding)


def _scalars(value: Expr) -> list[Expr]:
    if isinstance(value.type, Matrix):
        columns = [build.index(value, integer(i)) for i in range(value.type.size)]
        return [c for column in columns for c in build.components(column)]
    return list(build.components(value))


def _channels(value: Expr) -> list[Expr]:
    if value.type is FLOAT:
        return [value]
    kind = kind_of(value.type)
    if kind is Kind.BOOL:
        return [build.cast(value, Kind.FLOAT)]
    bits = build.cast(value, Kind.UINT)
    low = build.binary(BinaryOp.AND, bits, unsigned(65535))
    high = build.binary(BinaryOp.SHR, bits, unsigned(16))
    return [build.cast(low, Kind.FLOAT), build.cast(high, Kind.FLOAT)]
