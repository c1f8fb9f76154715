"""Operations on scalars that are constants or values of a tape.

Input: scalars. Output: scalars; what is constant is computed now, everything else is added to the
tape. Bools of a tape are 0 or 1. Does not depend on the nodes of the IR, except their operators.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final, NoReturn, TypeAlias

from distal.ir.constant_arithmetic import COMPARE, ConstantArithmetic, NotFoldableError, Number
from distal.ir.intrinsics import INTRINSICS
from distal.ir.intrinsics.folding import ConstantCall
from distal.ir.limits import Held, below_one, smallest
from distal.ir.nodes import BinaryOp, CompareOp, UnaryOp
from distal.ir.types import Kind
from distal.tape.operations import ELEMENTARY
from distal.tape.tape import TapeBuilder, TapeError


@dataclass(frozen=True, slots=True)
class Varying:
    """A scalar that differs from point to point.

    Attributes:
        value: The number of its value on the tape.
    """

    value: int


Scalar: TypeAlias = bool | int | float | Varying

_BINARY: Final = {
    BinaryOp.ADD: "add",
    BinaryOp.SUB: "sub",
    BinaryOp.MUL: "mul",
    BinaryOp.DIV: "div",
}
# Operations that leave the first operand as it is, if the second is this number.
_NEUTRAL: Final = {
    BinaryOp.ADD: 0.0,
    BinaryOp.SUB: 0.0,
    BinaryOp.MUL: 1.0,
    BinaryOp.DIV: 1.0,
}
_SAME_NAME: Final = frozenset({"abs", "floor", "ceil", "round", "trunc", "min", "max", "sqrt"})
_OTHER_NAMES: Final = {"raw_power": "pow", "raw_atan2": "atan2"}


class Scalars:
    """Computes constants, and collects the operations of a tape.

    Args:
        precision: The bits of a float, 32 or 64.
    """

    def __init__(self, precision: int = 32) -> None:
        self.builder = TapeBuilder()
        self._constants = ConstantArithmetic(precision)

    def value(self, scalar: Scalar) -> int:
        """Return the number of a scalar's value on the tape."""
        if isinstance(scalar, Varying):
            return scalar.value
        return self.builder.constant(float(scalar))

    def operation(self, name: str, *operands: Scalar) -> Varying:
        """Add an operation to the tape."""
        return Varying(self.builder.operation(name, *map(self.value, operands)))

    # Operators

    def unary(self, op: UnaryOp, a: Scalar, kind: Kind) -> Scalar:
        """Return ``op a``.

        Args:
            op: The operator.
            a: The operand.
            kind: Its kind.
        """
        if not isinstance(a, Varying):
            return self._constants.unary(op, a, kind)
        if kind is Kind.FLOAT:
            return self.operation("neg", a)
        if kind is Kind.BOOL:
            return self.operation("sub", 1.0, a)
        refuse_whole_numbers()

    def binary(self, op: BinaryOp, a: Scalar, b: Scalar, kind: Kind) -> Scalar:
        """Return ``a op b``.

        Args:
            op: The operator.
            a: The left operand.
            b: The right operand.
            kind: Their kind.
        """
        if not isinstance(a, Varying) and not isinstance(b, Varying):
            try:
                return self._constants.binary(op, a, b, kind)
            except NotFoldableError:
                pass
        if kind is Kind.BOOL:
            return self._of_bools(op, a, b)
        if kind is not Kind.FLOAT:
            refuse_whole_numbers()
        if op in (BinaryOp.FLOOR_DIV, BinaryOp.MOD):
            quotient = self.operation("floor", self.binary(BinaryOp.DIV, a, b, kind))
            if op is BinaryOp.FLOOR_DIV:
                return quotient
            product = self.binary(BinaryOp.MUL, b, quotient, kind)
            rest = self.binary(BinaryOp.SUB, a, product, kind)
            nearest = below_one(self._constants.precision)
            end = self.binary(BinaryOp.MUL, b, nearest, kind)
            least, most = (self.builtin(n, (end, 0.0), kind) for n in ("min", "max"))
            return self.builtin("min", (self.builtin("max", (rest, least), kind), most), kind)
        if not isinstance(b, Varying) and float(b) == _NEUTRAL[op]:
            return a
        if op in (BinaryOp.ADD, BinaryOp.MUL) and not isinstance(a, Varying):
            a, b = b, a
            if not isinstance(b, Varying) and float(b) == _NEUTRAL[op]:
                return a
        return self.operation(_BINARY[op], a, b)

    def _of_bools(self, op: BinaryOp, a: Scalar, b: Scalar) -> Scalar:
        match op:
            case BinaryOp.AND:
                return self.both(a, b)
            case BinaryOp.OR:
                return self.either(a, b)
            case _:
                return self.compare(CompareOp.NE, a, b)

    def both(self, a: Scalar, b: Scalar) -> Scalar:
        """Return ``a and b``."""
        if not isinstance(a, Varying):
            return b if a else False
        if not isinstance(b, Varying):
            return a if b else False
        return self.operation("min", a, b)

    def either(self, a: Scalar, b: Scalar) -> Scalar:
        """Return ``a or b``."""
        if not isinstance(a, Varying):
            return True if a else b
        if not isinstance(b, Varying):
            return True if b else a
        return self.operation("max", a, b)

    def compare(self, op: CompareOp, a: Scalar, b: Scalar) -> Scalar:
        """Return whether ``a op b``."""
        if not isinstance(a, Varying) and not isinstance(b, Varying):
            return COMPARE[op](a, b)
        match op:
            case CompareOp.LT:
                return self.operation("less", a, b)
            case CompareOp.LE:
                return self.operation("less_equal", a, b)
            case CompareOp.GT:
                return self.operation("less", b, a)
            case CompareOp.GE:
                return self.operation("less_equal", b, a)
            case CompareOp.EQ:
                return self.operation("equal", a, b)
            case CompareOp.NE:
                return self.operation("sub", 1.0, self.operation("equal", a, b))

    def select(self, condition: Scalar, yes: Scalar, no: Scalar) -> Scalar:
        """Return ``yes if condition else no``."""
        if not isinstance(condition, Varying):
            return yes if condition else no
        if yes == no and type(yes) is type(no):
            return yes
        if isinstance(yes, bool) and isinstance(no, bool):
            return condition if yes else self.unary(UnaryOp.NOT, condition, Kind.BOOL)
        if not isinstance(yes, Varying | float | bool) or not isinstance(
            no, Varying | float | bool
        ):
            refuse_whole_numbers()
        return self.operation("select", condition, yes, no)

    def cast(self, a: Scalar, source: Kind, target: Kind) -> Scalar:
        """Return a scalar converted to another kind.

        Args:
            a: The scalar.
            source: Its kind.
            target: The kind to convert to.
        """
        if not isinstance(a, Varying):
            return self._constants.cast(a, source, target)
        if source is target or (source is Kind.BOOL and target is Kind.FLOAT):
            return a
        if source is Kind.FLOAT and target is Kind.BOOL:
            return self.compare(CompareOp.NE, a, 0.0)
        refuse_whole_numbers()

    # Built-ins

    def builtin(self, name: str, args: Sequence[Scalar], kind: Kind) -> Scalar:
        """Return a built-in of scalars.

        Args:
            name: Its name in the table of intrinsics.
            args: The arguments.
            kind: The kind of the first argument.

        Raises:
            TapeError: Tapes do not have it.
        """
        name = _OTHER_NAMES.get(name, name)
        known = self._folded(name, args, kind)
        if known is not None:
            return known
        if kind is not Kind.FLOAT:
            refuse_whole_numbers()
        if name in _SAME_NAME or name in ELEMENTARY:
            return self.operation(name, *args)
        if name == "sign":
            negative = self.select(self.compare(CompareOp.LT, args[0], 0.0), -1.0, 0.0)
            return self.select(self.compare(CompareOp.GT, args[0], 0.0), 1.0, negative)
        if name == "inversesqrt":
            root = self.operation(
                "sqrt", self.operation("max", args[0], smallest(self._constants.precision))
            )
            return self.operation("div", 1.0, root)
        raise TapeError(f"'{name}' is no operation of a tape")

    def _folded(self, name: str, args: Sequence[Scalar], kind: Kind) -> Scalar | None:
        """Return the result for constant arguments, if it is an ordinary number."""
        constants = [a for a in args if not isinstance(a, Varying)]
        if len(constants) != len(args):
            return None
        rule = INTRINSICS[name]
        least, most = (rule.held or Held()).limits(self._constants.precision)
        numbers: list[Number] = [min(max(a, least), most) if rule.held else a for a in constants]
        call = ConstantCall(tuple((n,) for n in numbers), kind, kind, self._constants)
        try:
            return rule.fold(call)[0]
        except NotFoldableError:
            return None


def refuse_whole_numbers() -> NoReturn:
    """Refuse a whole number that differs from point to point.

    Raises:
        TapeError: Always.
    """
    raise TapeError("it computes with whole numbers that differ from point to point")
