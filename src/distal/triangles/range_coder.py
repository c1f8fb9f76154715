"""An adaptive binary range coder: decisions and their contexts to bytes, and back.

The coder is that of LZMA (Pavlov; Martin 1979) with carry propagation; a context's probability has
16 bits and adapts to the mean of what was seen, later exponentially. ``web/src/triangles/coder.ts``
is the decoder of pages.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Final, Protocol

# Where a probability moves: to these instead of 0 and 65536, so that no decision is impossible.
NEVER: Final = 131
ALWAYS: Final = 65_405
# How far it moves, of 4096, after so many decisions.
SLOWEST: Final = 41
RATES: Final = tuple(round(4096 / (seen + 2.3)) for seen in range(SLOWEST))
# A number is so many decisions in unary, then Elias-Gamma; its contexts are so many.
UNARY: Final = 12
NUMBER_CONTEXTS: Final = 16
_MOST_BITS: Final = 14


class CoderError(Exception):
    """The bytes are not those of a picture."""


class Coder(Protocol):
    """Codes decisions; ``stream.py`` uses the same order for writing and reading."""

    def bit(self, context: int, value: int) -> int:
        """Code one decision; reading ignores ``value``."""
        ...


class _Adaptive:
    """Probabilities that a decision is 1, by context."""

    def __init__(self, contexts: int) -> None:
        self._chances = [32_768] * contexts
        self._seen = [0] * contexts

    def _learn(self, context: int, value: int) -> None:
        chance, seen = self._chances[context], self._seen[context]
        goal = ALWAYS if value else NEVER
        self._chances[context] = chance + ((goal - chance) * RATES[seen] >> 12)
        if seen < SLOWEST - 1:
            self._seen[context] = seen + 1


class RangeEncoder(_Adaptive):
    """Writes decisions."""

    def __init__(self, contexts: int) -> None:
        super().__init__(contexts)
        self._low = 0
        self._range = 0xFFFF_FFFF
        self._bytes = bytearray()

    def bit(self, context: int, value: int) -> int:
        """Write a decision and return it."""
        bound = (self._range >> 16) * self._chances[context]
        if value:
            self._range = bound
        else:
            self._low += bound
            self._range -= bound
        self._learn(context, value)
        while self._range < 1 << 24:
            self._range <<= 8
            self._shift()
        return value

    def _shift(self) -> None:
        if self._low >> 32:  # carry
            place = len(self._bytes) - 1
            while self._bytes[place] == 0xFF:
                self._bytes[place] = 0
                place -= 1
            self._bytes[place] += 1
        self._bytes.append(self._low >> 24 & 0xFF)
        self._low = (self._low << 8) & 0xFFFF_FFFF

    def finished(self) -> bytes:
        """Return all bytes."""
        for _ in range(4):
            self._shift()
        return bytes(self._bytes)


class RangeDecoder(_Adaptive):
    """Reads decisions."""

    def __init__(self, data: bytes, contexts: int) -> None:
        super().__init__(contexts)
        self._bytes: Iterator[int] = iter(data)
        self._range = 0xFFFF_FFFF
        self._code = 0
        for _ in range(4):
            self._code = self._code << 8 | self._next()

    def bit(self, context: int, value: int = 0) -> int:
        """Read a decision."""
        bound = (self._range >> 16) * self._chances[context]
        value = int(self._code < bound)
        if value:
            self._range = bound
        else:
            self._code -= bound
            self._range -= bound
        self._learn(context, value)
        while self._range < 1 << 24:
            self._range <<= 8
            self._code = (self._code << 8 | self._next()) & 0xFFFF_FFFF
        return value

    def _next(self) -> int:
        found = next(self._bytes, None)
        if found is None:
            raise CoderError("the file ends too early")
        return found


def code_number(coder: Coder, context: int, value: int) -> int:
    """Code a whole number from 0 on; its contexts are the ``NUMBER_CONTEXTS`` from ``context`` on.

    Raises:
        CoderError: The bytes give a number that no picture has.
    """
    for step in range(UNARY):
        if not coder.bit(context + step, value > step):
            return step
    rest, bits = value - UNARY + 1, 0
    while coder.bit(context + UNARY, rest >> (bits + 1) > 0):
        bits += 1
        if bits > _MOST_BITS:
            raise CoderError("a number is too large")
    found = 1
    for bit in reversed(range(bits)):
        found = 2 * found + coder.bit(context + UNARY + 1, rest >> bit & 1)
    return found + UNARY - 1


def code_signed(coder: Coder, context: int, sign: int, value: int) -> int:
    """Code a whole number; ``sign`` is the context of its sign."""
    size = code_number(coder, context, abs(value))
    return -size if size and coder.bit(sign, value < 0) else size
