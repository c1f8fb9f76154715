"""Signatures of built-ins: patterns over types, and how a call is matched to a signature."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from enum import Enum
from typing import Final, TypeAlias

from distal.ir.types import (
    BVEC2,
    BVEC3,
    BVEC4,
    FLOAT,
    INT,
    IVEC2,
    IVEC3,
    IVEC4,
    MAT2,
    MAT3,
    MAT4,
    UINT,
    UVEC2,
    UVEC3,
    UVEC4,
    VEC2,
    VEC3,
    VEC4,
    Kind,
    Matrix,
    Type,
    Vector,
    with_kind,
)


class Follows(Enum):
    """A type derived from the signature's type variable T."""

    T = "T"
    AS_BOOL = "bool for each component of T"
    AS_INT = "T with int components"
    AS_UINT = "T with uint components"
    AS_FLOAT = "T with float components"
    SQUARE = "the matrix with columns of type T"


Pattern: TypeAlias = Type | Follows
T: Final = Follows.T

FLOATS: Final[tuple[Type, ...]] = (FLOAT, VEC2, VEC3, VEC4)
VECTORS: Final[tuple[Type, ...]] = (VEC2, VEC3, VEC4)
INTS: Final[tuple[Type, ...]] = (INT, IVEC2, IVEC3, IVEC4)
UINTS: Final[tuple[Type, ...]] = (UINT, UVEC2, UVEC3, UVEC4)
NUMBERS: Final = FLOATS + INTS + UINTS
SIGNED: Final = FLOATS + INTS
BOOL_VECTORS: Final[tuple[Type, ...]] = (BVEC2, BVEC3, BVEC4)
MATRICES: Final[tuple[Type, ...]] = (MAT2, MAT3, MAT4)


def resolve(pattern: Pattern, variable: Type) -> Type:
    """Return the type that a pattern denotes when T is ``variable``."""
    match pattern:
        case Follows.T:
            return variable
        case Follows.AS_BOOL:
            return with_kind(variable, Kind.BOOL)
        case Follows.AS_INT:
            return with_kind(variable, Kind.INT)
        case Follows.AS_UINT:
            return with_kind(variable, Kind.UINT)
        case Follows.AS_FLOAT:
            return with_kind(variable, Kind.FLOAT)
        case Follows.SQUARE:
            assert isinstance(variable, Vector)
            return Matrix(variable.size)
        case _:
            return pattern


@dataclass(frozen=True, slots=True)
class Signature:
    """Parameters and result as patterns of a type variable T, which takes the types in ``over``."""

    params: tuple[Pattern, ...]
    result: Pattern
    over: tuple[Type, ...]

    def instances(self) -> Iterator[tuple[tuple[Type, ...], Type]]:
        """Yield every pair (parameter types, result type) that this signature describes."""
        for variable in self.over:
            yield (
                tuple(resolve(p, variable) for p in self.params),
                resolve(self.result, variable),
            )

    def match(self, args: Sequence[Type]) -> Type | None:
        """Return the result type if the arguments have exactly these types, else None."""
        for params, result in self.instances():
            if params == tuple(args):
                return result
        return None


def componentwise(arity: int, over: tuple[Type, ...] = FLOATS) -> Signature:
    """Return the signature of a function of ``arity`` arguments of type T with result type T."""
    return Signature((T,) * arity, T, over)


UNARY: Final = componentwise(1)
BINARY: Final = componentwise(2)
TERNARY: Final = componentwise(3)
