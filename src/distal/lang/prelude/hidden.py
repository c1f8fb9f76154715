"""The hidden intrinsics, under the names that prelude code uses.

A target implements them with narrower guarantees than the language gives; the prelude functions
that call them handle the other cases. Authors cannot use them.
"""

from __future__ import annotations

from typing import Final, Protocol, TypeVar

from distal.ir.intrinsics import INTRINSICS
from distal.lang import Floats, uint
from distal.lang.names import LangFunction

Integers = TypeVar("Integers", int, uint)


class _OfTwoFloats(Protocol):
    def __call__(self, a: float, b: float, /) -> float: ...


class _OfFloats(Protocol):
    def __call__(self, x: Floats, /) -> Floats: ...


class _OfTwoIntegers(Protocol):
    def __call__(self, a: Integers, b: Integers, /) -> Integers: ...


class _OfACondition(Protocol):
    def __call__(self, condition: bool, /) -> bool: ...


class _FloatToInt(Protocol):
    def __call__(self, x: float, /) -> int: ...


class _FloatToUint(Protocol):
    def __call__(self, x: float, /) -> uint: ...


anywhere: Final[_OfACondition] = LangFunction(INTRINSICS["anywhere"])
nearer_zero: Final[_OfFloats] = LangFunction(INTRINSICS["nearer_zero"])
raw_atan2: Final[_OfTwoFloats] = LangFunction(INTRINSICS["raw_atan2"])
raw_power: Final[_OfTwoFloats] = LangFunction(INTRINSICS["raw_power"])
saturated_int: Final[_FloatToInt] = LangFunction(INTRINSICS["saturated_int"])
saturated_uint: Final[_FloatToUint] = LangFunction(INTRINSICS["saturated_uint"])
truncated_quotient: Final[_OfTwoIntegers] = LangFunction(INTRINSICS["truncated_quotient"])
