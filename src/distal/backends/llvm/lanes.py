"""Represent values as leaves: scalars that are the same in all lanes, or one per lane.

Input: IR types, and the shape of the machine's vectors. Output: the flat list of a type's scalars,
and LLVM's names of their types. Does not depend on instructions.

A kernel computes ``count`` pixels at a time, one per lane, in ``chunks`` vectors of ``width``
lanes: several independent chains of instructions hide the latency of each.
"""

from __future__ import annotations

import struct
from dataclasses import dataclass, replace
from functools import cache
from typing import assert_never

from distal.ir.quick_init import quick_init
from distal.ir.types import (
    Array,
    Buffer,
    FunctionType,
    Kind,
    Matrix,
    Scalar,
    Struct,
    Texture,
    Type,
    Vector,
)


@dataclass(frozen=True, slots=True)
class Lanes:
    """The vector shape of one compilation.

    Attributes:
        width: Lanes in one vector.
        chunks: Vectors of each value.
        precision: Bits of a float, 32 or 64.
        block_width: Width of a block of ``count`` pixels; its height follows.
        level: The name of the CPU feature level, for code that depends on the processor.
    """

    width: int = 8
    chunks: int = 2
    precision: int = 32
    block_width: int = 4
    level: str = "avx2"

    @property
    def count(self) -> int:
        """The number of pixels that are computed at a time."""
        return self.width * self.chunks

    @property
    def slot(self) -> int:
        """Bytes of a scalar in uniforms, frame values, arrays and buffers."""
        return self.precision // 8

    @property
    def has_fma(self) -> bool:
        """Whether the processor fuses a product with a sum; others call a slow function for it."""
        return self.level != "sse4.2"

    def one_chunk(self) -> Lanes:
        """Return a copy with one vector per value, to reduce the code of very large functions."""
        return replace(self, chunks=1, block_width=min(self.block_width, self.width))

    def scalar(self, kind: Kind) -> str:
        """Return LLVM's type of one lane."""
        match kind:
            case Kind.FLOAT:
                return "float" if self.precision == 32 else "double"
            case Kind.INT | Kind.UINT:
                return "i32"
            case Kind.BOOL:
                return "i1"
            case _:
                assert_never(kind)

    def vector(self, kind: Kind) -> str:
        """Return LLVM's type of one chunk."""
        return f"<{self.width} x {self.scalar(kind)}>"

    def type(self, kind: Kind, *, uniform: bool) -> str:
        """Return LLVM's type of a leaf's operand: a scalar if uniform, else a vector."""
        return self.scalar(kind) if uniform else self.vector(kind)

    def literal(self, value: bool | int | float, kind: Kind) -> str:
        """Return a constant of one lane in LLVM's syntax."""
        match kind:
            case Kind.FLOAT:
                number = float(value)
                if self.precision == 32:
                    (number,) = struct.unpack("<f", struct.pack("<f", number))
                return f"0x{struct.unpack('<Q', struct.pack('<d', number))[0]:016X}"
            case Kind.INT | Kind.UINT:
                return str(int(value))
            case Kind.BOOL:
                return "true" if value else "false"
            case _:
                assert_never(kind)


@quick_init
@dataclass(frozen=True, slots=True)
class Leaf:
    """One scalar of a value.

    Attributes:
        kind: Its kind.
        names: LLVM operands: one scalar if uniform, else one vector for each chunk.
        uniform: Whether it is the same in every lane.
        constant: Whether it is a literal.
    """

    kind: Kind
    names: tuple[str, ...]
    uniform: bool
    constant: bool = False


Leaves = tuple[Leaf, ...]


@dataclass(frozen=True, slots=True)
class Stored:
    """A value with arrays that is stored in memory, because an index is not constant.

    Leaf i of a uniform value is slot i; otherwise chunk c of leaf i is the vector at slot
    ``(i * chunks + c) * width``.
    """

    type: Type
    pointer: str
    uniform: bool


@cache
def leaf_kinds(type: Type) -> tuple[Kind, ...]:
    """Return the kinds of a value's scalars: matrices by columns, fields and elements in order."""
    match type:
        case Scalar(kind):
            return (kind,)
        case Vector(kind, size):
            return (kind,) * size
        case Matrix(size):
            return (Kind.FLOAT,) * (size * size)
        case Struct(_, fields):
            return tuple(k for _, t in fields for k in leaf_kinds(t))
        case Array(element, length):
            return leaf_kinds(element) * length
        case Texture() | Buffer() | FunctionType():
            return ()
        case _:
            assert_never(type)


def leaf_count(type: Type) -> int:
    """Return the number of scalars of a value."""
    return len(leaf_kinds(type))


def field_offset(struct_type: Struct, name: str) -> int:
    """Return the index of the first leaf of a field."""
    offset = 0
    for field, type in struct_type.fields:
        if field == name:
            return offset
        offset += leaf_count(type)
    raise AssertionError(f"{struct_type} has no {name}")


def has_array(type: Type) -> bool:
    """Return whether a type contains an array."""
    match type:
        case Array():
            return True
        case Struct(_, fields):
            return any(has_array(t) for _, t in fields)
        case _:
            return False
