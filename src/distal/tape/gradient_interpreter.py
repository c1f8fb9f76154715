"""Write the interpreter of tapes for dual numbers: values and gradients at 16 points at once.

Input: the shape of the machine's vectors. Output: the text of one LLVM function. A slot holds 16
values, and 16 derivatives along x, y and z. The values are computed as the interpreter for floats
computes them; where a function has no derivative, it is chosen as in ``ir.intrinsics.derivatives``.

Source: L. B. Rall, "Automatic Differentiation" (1981).
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final, TypeAlias

from distal.backends.llvm.lanes import Lanes
from distal.tape.interpreter_loop import ROUNDINGS, Reader, TapeLoop
from distal.tape.layout import FLOAT_SLOT, GRADIENT_PLANE
from distal.tape.machine_code import Value
from distal.tape.operations import ELEMENTARY, FIRST_ELEMENTARY, NUMBER, OPERATIONS

_PLANES: Final = range(0, FLOAT_SLOT, GRADIENT_PLANE)
# A register of values, and one of each derivative.
Dual: TypeAlias = tuple[Value, Value, Value, Value]


class _Gradients(TapeLoop):
    """The interpreter of dual numbers."""

    def __init__(self, lanes: Lanes, declarations: set[str]) -> None:
        super().__init__(lanes, declarations, FLOAT_SLOT)
        self._slopes = self.code.stack(FLOAT_SLOT)

    @property
    def offsets(self) -> range:
        """The byte offset of each register in 16 floats."""
        return range(0, GRADIENT_PLANE, 4 * self.lanes.width)

    def dual(self, address: Value, offset: int) -> Dual:
        """Load the values and derivatives of some points."""
        a, b, c, d = (self.load(address, plane + offset) for plane in _PLANES)
        return a, b, c, d

    def keep(self, dual: Sequence[Value], address: Value, offset: int) -> None:
        """Store the values and derivatives of some points."""
        for value, plane in zip(dual, _PLANES, strict=True):
            self.store(value, address, plane + offset)

    def number(self, value: float) -> Value:
        """Return a literal in all lanes."""
        return self.code.literal(value, self.vector)

    def case(self, name: str, reader: Reader, _: Value) -> None:
        """Write the code of one operation."""
        target = self.slot(reader, "result")
        zero = self.number(0.0)
        if name == "const":
            constant = self.constant(reader)
            for offset in self.offsets:
                self.keep((constant, zero, zero, zero), target, offset)
        elif name in ("x", "y", "z"):
            axis = "xyz".index(name)
            own = [self.number(1.0) if i == axis else zero for i in range(3)]
            source = self.inputs.at(axis * GRADIENT_PLANE)
            for offset in self.offsets:
                self.keep((self.load(source, offset), *own), target, offset)
        elif name in ELEMENTARY:
            self._elementary(name, reader, target)
        else:
            fields = "abc"[: OPERATIONS[NUMBER[name]].operands]
            addresses = [self.slot(reader, field) for field in fields]
            for offset in self.offsets:
                duals = [self.dual(address, offset) for address in addresses]
                self.keep(self._plain(name, duals), target, offset)

    def _plain(self, name: str, duals: list[Dual]) -> Sequence[Value]:
        """Return the result of an operation that is no elementary function."""
        (a, *da), (b, *db) = duals[0], duals[-1]
        match name:
            case "add":
                return [p + q for p, q in zip(duals[0], duals[1], strict=True)]
            case "sub":
                return [p - q for p, q in zip(duals[0], duals[1], strict=True)]
            case "mul":
                return a * b, *(p * b + a * q for p, q in zip(da, db, strict=True))
            case "div":
                quotient = a / b
                return quotient, *((p - quotient * q) / b for p, q in zip(da, db, strict=True))
            case "min":
                return self._either(b < a, duals[1], duals[0])
            case "max":
                return self._either(a < b, duals[1], duals[0])
            case "select":
                return self._either(a > 0.5, duals[1], duals[2])
            case "neg":
                return [-p for p in duals[0]]
            case "abs":
                turned = [self.code.select(a < 0.0, -p, p) for p in da]
                return self.call("fabs", a), *turned
            case "square":
                twice = a + a
                return a * a, *(twice * p for p in da)
            case "sqrt":
                root = self.call("sqrt", self.positive(a))
                slope = self.number(0.5) / root
                slope = self.code.select(a > 0.0, slope, self.number(0.0))
                return root, *(slope * p for p in da)
            case "less" | "less_equal" | "equal":
                holds = {"less": a < b, "less_equal": a <= b, "equal": a.same(b)}[name]
                return self._step(self.code.select(holds, 1.0, self.number(0.0)))
            case _:
                return self._step(self.call(ROUNDINGS[name], a))

    def _either(self, condition: Value, yes: Dual, no: Dual) -> Sequence[Value]:
        return [self.code.select(condition, p, q) for p, q in zip(yes, no, strict=True)]

    def _step(self, value: Value) -> Sequence[Value]:
        zero = self.number(0.0)
        return value, zero, zero, zero

    def _elementary(self, name: str, reader: Reader, target: Value) -> None:
        count = OPERATIONS[NUMBER[name]].operands
        operands = [self.slot(reader, field) for field in "ab"[:count]]
        number = self.code.literal(NUMBER[name] - FIRST_ELEMENTARY)
        self.code.call("elementary_slopes", self._slopes, operands[0], operands[-1], number)
        for offset in self.offsets:
            value, *slopes, _ = self.dual(self._slopes, offset)
            derivatives = None
            for slope, operand in zip(slopes, operands, strict=False):
                terms = [slope * p for p in self.dual(operand, offset)[1:]]
                if derivatives is None:
                    derivatives = terms
                else:
                    derivatives = [p + q for p, q in zip(derivatives, terms, strict=True)]
            self.keep((value, *(derivatives or ())), target, offset)


def gradient_code(lanes: Lanes, declarations: set[str]) -> str:
    """Return the function that evaluates a tape and its gradient at 16 points.

    Args:
        lanes: The shape of the machine's vectors.
        declarations: Receives the declarations of LLVM intrinsics.
    """
    self = _Gradients(lanes, declarations)
    self.loop(self.case)
    params = "ptr %operations, i64 %length, ptr %constants, ptr noalias %slots, ptr %inputs"
    return self.code.function("gradients", params)
