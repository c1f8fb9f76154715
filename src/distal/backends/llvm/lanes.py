"""What a value is while it is computed: leaves, each the same in all lanes or one per lane.

Input: IR types and the shape of the machine. Output: the flat list of scalars a type consists of,
and how LLVM writes their types. Knows no instruction.

A kernel works on ``count`` pixels at a time, one per lane, held in ``chunks`` vectors of ``width``:
several chains of work in flight hide the latency of each.
"""

from __future__ import annotations

import struct
from dataclasses import dataclass, replace
from functools import cache
from typing import assert_never

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
        chunks: Vectors of each value in flight.
        precision: Bits of a float, 32 or 64.
        block_width: Pixels across in the block of ``count`` pixels; the rest is its height.
        level: The CPU feature level, for what plain LLVM text cannot say.
    """

    width: int = 8
    chunks: int = 2
    precision: int = 32
    block_width: int = 4
    level: str = "avx2"

    @property
    def count(self) -> int:
        """Pixels at a time."""
        return self.width * self.chunks

    @property
    def slot(self) -> int:
        """Bytes of a scalar in uniforms, frame values, arrays and buffers."""
        return self.precision // 8

    def one_chunk(self) -> Lanes:
        """The same with one vector of each value: less code, where there is very much of it."""
        return replace(self, chunks=1, block_width=min(self.block_width, self.width))

    def scalar(self, kind: Kind) -> str:
        """LLVM's type of one lane."""
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
        """LLVM's type of one chunk."""
        return f"<{self.width} x {self.scalar(kind)}>"

    def type(self, kind: Kind, *, uniform: bool) -> str:
        """LLVM's type of one name of a leaf."""
        return self.scalar(kind) if uniform else self.vector(kind)

    def literal(self, value: bool | int | float, kind: Kind) -> str:
        """A constant of one lane as LLVM writes it."""
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


@dataclass(frozen=True, slots=True)
class Leaf:
    """One scalar of a value.

    Attributes:
        kind: What it is.
        names: LLVM operands: one scalar when uniform, else one vector for each chunk.
        uniform: The same in every lane.
        constant: A literal.
    """

    kind: Kind
    names: tuple[str, ...]
    uniform: bool
    constant: bool = False


Leaves = tuple[Leaf, ...]


@dataclass(frozen=True, slots=True)
class Stored:
    """A value with arrays, kept in memory because it is indexed by what is not constant.

    Leaf i of a uniform one is slot i; else chunk c of leaf i is the vector at slot
    ``(i * chunks + c) * width``.
    """

    type: Type
    pointer: str
    uniform: bool


@cache
def leaf_kinds(type: Type) -> tuple[Kind, ...]:
    """The kinds of a value's scalars: columns of a matrix, fields and elements in order."""
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
    """How many scalars a value has."""
    return len(leaf_kinds(type))


def field_offset(struct_type: Struct, name: str) -> int:
    """The first leaf of a field."""
    offset = 0
    for field, type in struct_type.fields:
        if field == name:
            return offset
        offset += leaf_count(type)
    raise AssertionError(f"{struct_type} has no {name}")


def has_array(type: Type) -> bool:
    """Whether a value contains an array."""
    match type:
        case Array():
            return True
        case Struct(_, fields):
            return any(has_array(t) for _, t in fields)
        case _:
            return False
