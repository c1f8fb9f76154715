"""Write the interpreter of tapes for intervals: 64 boxes at once.

Input: the shape of the machine's vectors. Output: the text of one LLVM function. A slot holds 64
lower ends and 64 upper ends. What an interval says about the float value of the same operation at
any point of the lane's box:

- If both ends are finite, the value is not NaN and is between them, ends included. Sums, products,
  quotients and roots are rounded correctly and so never decrease where the exact result increases:
  the rounded result of the ends bounds all rounded results. Elementary functions are widened by
  their known errors.
- If an end is infinite or NaN, nothing is known; the value may be NaN. Every rule whose result
  could be finite nevertheless adds a *NaN mask*: 0, or NaN if nothing is known of an operand.

Source: T. Hickey, Q. Ju, M. H. van Emden, "Interval Arithmetic: from Principles to Implementation",
Journal of the ACM 48 (2001).
"""

from __future__ import annotations

from itertools import product
from typing import Final, assert_never

from distal.backends.llvm.lanes import Lanes
from distal.ir.intrinsics import Trend
from distal.tape.interpreter_loop import ROUNDINGS, Reader, TapeLoop
from distal.tape.layout import FLOAT_SLOT, INTERVAL_SLOT
from distal.tape.machine_code import POINTER, WORD, Value
from distal.tape.operations import FIRST_ELEMENTARY, NUMBER, OPERATIONS

_UPPER: Final = FLOAT_SLOT  # bytes from the lower ends of a slot to its upper ends
# Twice the largest error of an elementary function on the CPU, with a margin: the values at the
# ends of an interval and those inside may be off in opposite directions. The errors are in
# ``lang.prelude.elementary``; ``tests/tape/test_intervals.py`` measures them against these.
RELATIVE_ERROR: Final = 4e-6
ABSOLUTE_ERROR: Final = 4e-6
POWER_ERROR: Final = 5e-5  # relative; of the exponent, which is up to 126
# The error of an exponential is relative, down to the smallest number that it gives.
_ONLY_RELATIVE: Final = ("exp", "exp2")
SMALLEST_VALUE: Final = 1e-37
_LARGEST_TANGENT: Final = 100.0  # beyond it, the ends' order does not exclude a pole
_HALF_TURN: Final = 3.1416
LARGEST_ANGLE: Final = 1e4  # beyond it, sines are less accurate: their interval is -1 to 1


class _Intervals(TapeLoop):
    """The interval interpreter, which also records the choices of each lane."""

    def __init__(self, lanes: Lanes, declarations: set[str]) -> None:
        super().__init__(lanes, declarations, INTERVAL_SLOT)
        self.first = self.code.parameter("first", POINTER)
        self.second = self.code.parameter("second", POINTER)
        self._ends = self.code.stack(2 * FLOAT_SLOT)
        self._inner = self.code.stack(4 * FLOAT_SLOT)

    def ends(self, address: Value, offset: int) -> tuple[Value, Value]:
        """Load a chunk of lower ends and one of upper ends."""
        return self.load(address, offset), self.load(address, _UPPER + offset)

    def keep(self, ends: tuple[Value, Value], address: Value, offset: int) -> None:
        """Store a chunk of lower and one of upper ends."""
        self.store(ends[0], address, offset)
        self.store(ends[1], address, _UPPER + offset)

    def nan_mask(self, *ends: Value) -> Value:
        """Return 0 where all ends are finite, else NaN (or NaN where their sum overflows)."""
        total = ends[0] - ends[1]
        for low, high in zip(ends[2::2], ends[3::2], strict=True):
            total = total + (low - high)
        return total * 0.0

    def corners(self, values: list[Value]) -> tuple[Value, Value]:
        """Return the least and the most of four values; NaN is only kept by ``nan_mask``."""
        p, q, r, s = values
        low = self.least(self.least(p, q), self.least(r, s))
        return low, self.most(self.most(p, q), self.most(r, s))

    def record(self, masks: list[list[Value]], index: Value) -> None:
        """Store which lanes take the first operand for certain, and which the second.

        Args:
            masks: For both, one vector of bools for each chunk.
            index: The operation's place on the tape.
        """
        code, width = self.code, self.lanes.width
        for chunks, target in zip(masks, (self.first, self.second), strict=True):
            joined = code.literal(0)
            for number, chunk in enumerate(chunks):
                whole = code.value(f"i{width}", f"bitcast {chunk.type} {chunk.name} to i{width}")
                word = code.value(WORD, f"zext i{width} {whole.name} to i64")
                joined = joined | (word << (number * width) if number else word)
            code.store(joined, target.at(index * 8))

    def case(self, name: str, reader: Reader, index: Value) -> None:
        """Write the code of one operation."""
        row = OPERATIONS[NUMBER[name]]
        target = self.slot(reader, "result")
        if name == "const":
            constant = self.constant(reader)
            for offset in self.offsets:
                self.keep((constant, constant), target, offset)
        elif name in ("x", "y", "z"):
            source = self.inputs.at("xyz".index(name) * INTERVAL_SLOT)
            for offset in self.offsets:
                self.keep(self.ends(source, offset), target, offset)
        elif row.chooses:
            choose = self._select if name == "select" else self._extremum
            choose(name, reader, target, index)
        elif row.trend is not None:
            operands = [self.slot(reader, f) for f in "ab"[: row.operands]]
            self._elementary(name, row.trend, operands, target)
        else:
            addresses = [self.slot(reader, f) for f in "ab"[: row.operands]]
            for offset in self.offsets:
                operands = [end for address in addresses for end in self.ends(address, offset)]
                self.keep(self._plain(name, operands), target, offset)

    def _extremum(self, name: str, reader: Reader, target: Value, index: Value) -> None:
        """``min`` and ``max``: an operand is taken only if both are known."""
        a, b = self.slot(reader, "a"), self.slot(reader, "b")
        first, second = [], []
        for offset in self.offsets:
            (al, ah), (bl, bh) = self.ends(a, offset), self.ends(b, offset)
            nan_mask = self.nan_mask(al, ah, bl, bh)
            if name == "min":
                low, high = self.least(al, bl), self.least(ah, bh)
                first.append((ah + nan_mask) < bl)
                second.append((bh + nan_mask) < al)
            else:
                low, high = self.most(al, bl), self.most(ah, bh)
                first.append((bh + nan_mask) < al)
                second.append((ah + nan_mask) < bl)
            self.keep((low, high + nan_mask), target, offset)
        self.record([first, second], index)

    def _select(self, _: str, reader: Reader, target: Value, index: Value) -> None:
        a, b, c = (self.slot(reader, f) for f in "abc")
        first, second = [], []
        for offset in self.offsets:
            low, high = self.ends(a, offset)
            (bl, bh), (cl, ch) = self.ends(b, offset), self.ends(c, offset)
            yes, no = low > 0.5, high < 0.5
            nan_mask = self.nan_mask(bl, bh, cl, ch)
            either = self.least(bl, cl), self.most(bh, ch) + nan_mask
            pairs = zip((bl, bh), (cl, ch), either, strict=True)
            chosen = [
                self.code.select(yes, y, self.code.select(no, n, both)) for y, n, both in pairs
            ]
            self.keep((chosen[0], chosen[1]), target, offset)
            first.append(yes)
            second.append(no)
        self.record([first, second], index)

    def _plain(self, name: str, ends: list[Value]) -> tuple[Value, Value]:
        """Return the interval of an operation that has no choice."""
        low, high = ends[0], ends[1]
        match name:
            case "add":
                return low + ends[2], high + ends[3]
            case "sub":
                return low - ends[3], high - ends[2]
            case "mul":
                products = [x * y for x in ends[:2] for y in ends[2:]]
                least, most = self.corners(products)
                # A product is infinite or NaN if a factor is.
                p, q, r, s = products
                return least, most + self.nan_mask(p, q, r, s)
            case "div":
                return self._quotient(ends)
            case "neg":
                return -high, -low
            case "abs":
                least = self.positive(self.most(low, -high))
                return least, self.most(-low, high) + self.nan_mask(low, high)
            case "square":
                near = self.positive(self.most(low, -high))
                far = self.most(low * low, high * high)
                return near * near, far + self.nan_mask(low, high)
            case "sqrt":
                roots = [self.call("sqrt", self.positive(end)) for end in (low, high)]
                return roots[0], roots[1] + self.nan_mask(low, high)
            case "less" | "less_equal" | "equal":
                return self._comparison(name, ends)
            case _:
                return self.call(ROUNDINGS[name], low), self.call(ROUNDINGS[name], high)

    def _quotient(self, ends: list[Value]) -> tuple[Value, Value]:
        low, high, least, most = ends
        nothing = self.code.literal(float("nan"), self.vector)
        quotients = [x / y for x in (low, high) for y in (least, most)]
        bottom, top = self.corners(quotients)
        nan_mask = self.nan_mask(*ends)
        crosses = (least <= 0.0) & (most >= 0.0)
        return bottom, self.code.select(crosses, nothing, top + nan_mask)

    def _comparison(self, name: str, ends: list[Value]) -> tuple[Value, Value]:
        """Return 1 to 1 if it always holds, 0 to 0 if it never does, else 0 to 1.

        Comparisons with NaN do not hold, so "never" needs no NaN mask.
        """
        low, high, least, most = ends
        nan_mask = self.nan_mask(*ends)
        zero = self.code.literal(0.0, self.vector)
        one = self.code.literal(1.0, self.vector)
        if name == "equal":
            apart = ((high + nan_mask) < least) | ((most + nan_mask) < low)
            return zero, self.code.select(apart, 0.0, one)
        if name == "less":
            always, never = (high + nan_mask) < least, (low + nan_mask) >= most
        else:
            always, never = (high + nan_mask) <= least, (low + nan_mask) > most
        return self.code.select(always, 1.0, zero), self.code.select(never, 0.0, one)

    def _elementary(self, name: str, trend: Trend, operands: list[Value], target: Value) -> None:
        code, a = self.code, operands[0]
        number = code.literal(NUMBER[name] - FIRST_ELEMENTARY)
        match trend:
            case Trend.UNKNOWN:
                nothing = code.literal(float("nan"), self.vector)
                for offset in self.offsets:
                    self.keep((nothing, nothing), target, offset)
            case Trend.WAVE:
                self._wave(a, target, number)
            case Trend.MONOTONE | Trend.ANGLE:
                self._corners(trend, a, operands[1], target, number)
            case Trend.EVEN:
                for offset in self.offsets:
                    low, high = self.ends(a, offset)
                    nearest = self.positive(self.most(low, -high))
                    farthest = self.most(-low, high) + self.nan_mask(low, high)
                    self.keep((nearest, farthest), self._inner, offset)
                self._at_ends(name, Trend.RISING, self._inner, target, number)
            case Trend.RISING | Trend.FALLING | Trend.BRANCHES:
                self._at_ends(name, trend, a, target, number)
            case _:
                assert_never(trend)

    def _at_ends(self, name: str, trend: Trend, a: Value, target: Value, number: Value) -> None:
        """A function that rises or falls: its values at the ends."""
        code = self.code
        code.call("elementary", self._ends, a, a, number)
        code.call("elementary", self._ends.at(_UPPER), a.at(_UPPER), a.at(_UPPER), number)
        absolute = SMALLEST_VALUE if name in _ONLY_RELATIVE else ABSOLUTE_ERROR
        for offset in self.offsets:
            first, last = self.ends(a, offset)
            nan_mask = self.nan_mask(first, last)
            low, high = self.ends(self._ends, offset)
            if trend is Trend.FALLING:
                low, high = high, low
            if trend is Trend.BRANCHES:
                nan_mask = nan_mask + self._pole(last - first, low, high)
                # Its slope is 1 + tan^2, by which an error of the argument grows.
                rest = [(end * end + 1.0) * ABSOLUTE_ERROR for end in (low, high)]
                self.keep((low - rest[0], high + (rest[1] + nan_mask)), target, offset)
                continue
            low = low - (self.call("fabs", low) * RELATIVE_ERROR + absolute)
            high = high + (self.call("fabs", high) * RELATIVE_ERROR + absolute)
            self.keep((low, high + nan_mask), target, offset)

    def _pole(self, width: Value, low: Value, high: Value) -> Value:
        """Return NaN where there may be a pole of the tangent between the ends, else 0.

        The tangents of ends less than pi apart are in falling order if a pole is between them.
        Next to a pole their order is not certain.
        """
        code = self.code
        zero = code.literal(0.0, self.vector)
        largest = self.most(self.call("fabs", low), self.call("fabs", high))
        known = (width < 3.0) & (low <= high) & (largest < _LARGEST_TANGENT)
        return code.select(known, zero, code.literal(float("nan"), self.vector))

    def _corners(self, trend: Trend, a: Value, b: Value, target: Value, number: Value) -> None:
        """A function that is monotone along both arguments: its values at the corners."""
        code = self.code
        for place, (first, second) in enumerate(product((0, _UPPER), repeat=2)):
            corner = self._inner.at(place * FLOAT_SLOT)
            code.call("elementary", corner, a.at(first), b.at(second), number)
        for offset in self.offsets:
            values = [self.load(self._inner, place * FLOAT_SLOT + offset) for place in range(4)]
            (al, ah), (bl, bh) = self.ends(a, offset), self.ends(b, offset)
            nan_mask = self.nan_mask(al, ah, bl, bh)
            low, high = self.corners(values)
            low = low - (self.call("fabs", low) * POWER_ERROR + ABSOLUTE_ERROR)
            high = high + (self.call("fabs", high) * POWER_ERROR + ABSOLUTE_ERROR)
            if trend is Trend.ANGLE:
                smooth = (bl > 0.0) | (al > 0.0) | (ah < 0.0)
                low = code.select(smooth, low, code.literal(-_HALF_TURN, self.vector))
                high = code.select(smooth, high, code.literal(_HALF_TURN, self.vector))
            self.keep((low, high + nan_mask), target, offset)

    def _wave(self, a: Value, target: Value, number: Value) -> None:
        """A function with slope at most 1: the value in the middle, plus and minus the radius."""
        code = self.code
        for offset in self.offsets:
            low, high = self.ends(a, offset)
            self.store(low + (high - low) * 0.5, self._ends, offset)
        middles = self._ends.at(_UPPER)
        code.call("elementary", middles, self._ends, self._ends, number)
        for offset in self.offsets:
            low, high = self.ends(a, offset)
            middle, value = self.load(self._ends, offset), self.load(middles, offset)
            radius = self.most(high - middle, middle - low) * 1.000001 + ABSOLUTE_ERROR
            far = self.most(-low, high) > LARGEST_ANGLE
            least = code.select(
                far, -1.0, self.most(value - radius, code.literal(-1.0, self.vector))
            )
            most = code.select(far, 1.0, self.least(value + radius, code.literal(1.0, self.vector)))
            self.keep((least, most + self.nan_mask(low, high)), target, offset)


def interval_code(lanes: Lanes, declarations: set[str]) -> str:
    """Return the function that evaluates a tape with intervals in 64 tiles.

    Args:
        lanes: The shape of the machine's vectors.
        declarations: Receives the declarations of LLVM intrinsics.
    """
    self = _Intervals(lanes, declarations)
    self.loop(self.case)
    params = (
        "ptr %operations, i64 %length, ptr %constants, ptr noalias %slots, ptr %inputs, "
        "ptr %first, ptr %second"
    )
    return self.code.function("intervals", params)
