"""Write operations on leaves: once if all operands are uniform, else once for each chunk.

Input: leaves. Output: instructions in a ``LlvmWriter``, and leaves that name their results. A
uniform operand is broadcast as late as possible, and only once in code that always runs together.
Does not depend on IR nodes, variables or control flow.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

from distal.backends.llvm.fusion import fused
from distal.backends.llvm.lanes import Lanes, Leaf, Leaves
from distal.backends.llvm.writer import LlvmWriter
from distal.ir.nodes import BinaryOp, CompareOp
from distal.ir.types import Kind

_FLOAT_COMPARE = {
    CompareOp.EQ: "oeq",
    CompareOp.NE: "une",
    CompareOp.LT: "olt",
    CompareOp.LE: "ole",
    CompareOp.GT: "ogt",
    CompareOp.GE: "oge",
}
_ORDER = {CompareOp.LT: "lt", CompareOp.LE: "le", CompareOp.GT: "gt", CompareOp.GE: "ge"}
_FLOAT_OPS = {
    BinaryOp.ADD: "fadd",
    BinaryOp.SUB: "fsub",
    BinaryOp.MUL: "fmul",
}
_INTEGER_OPS = {
    BinaryOp.ADD: "add",
    BinaryOp.SUB: "sub",
    BinaryOp.MUL: "mul",
    BinaryOp.AND: "and",
    BinaryOp.OR: "or",
    BinaryOp.XOR: "xor",
}


class LaneArithmetic:
    """Writes operations, and caches the broadcasts of uniform leaves."""

    def __init__(self, lanes: Lanes, writer: LlvmWriter, declarations: set[str]) -> None:
        self.lanes = lanes
        self.writer = writer
        self.declarations = declarations
        self._scopes: list[dict[object, Any]] = [{}]
        self._typed: dict[tuple[object, ...], str] = {}  # templates with types
        self._block = ""
        self._values: dict[str, str] = {}  # of this block, by instruction

    def enter(self) -> None:
        """Begin code that may not run; values of ``once`` in it are not used after ``leave``."""
        self._scopes.append({})

    def leave(self) -> None:
        """End code that may not run."""
        self._scopes.pop()

    def once(self, key: object, make: Callable[[], Any]) -> Any:
        """Return the result of ``make`` for ``key``, cached while its code is certain to run."""
        for scope in self._scopes:
            if key in scope:
                return scope[key]
        made = self._scopes[-1][key] = make()
        return made

    def text(self) -> str:
        """Return the body of the function, with products fused if the processor can."""
        if self.lanes.has_fma:
            self.writer.lines = fused(self.writer.lines, self.declarations)
        return self.writer.text()

    # Leaves

    def constant(self, value: bool | int | float, kind: Kind) -> Leaf:
        """Return a literal."""
        return Leaf(kind, (self.lanes.literal(value, kind),), True, True)

    def vectors(self, leaf: Leaf) -> tuple[str, ...]:
        """Return the chunks of a leaf; a uniform leaf is broadcast."""
        if not leaf.uniform:
            return leaf.names
        scalar, (name,) = self.lanes.scalar(leaf.kind), leaf.names
        if leaf.constant:
            return (f"splat ({scalar} {name})",) * self.lanes.chunks
        chunk = self.once(("broadcast", name), lambda: self.broadcast(name, leaf.kind))
        return (chunk,) * self.lanes.chunks

    def broadcast(self, name: str, kind: Kind) -> str:
        """Return a vector with a scalar in each lane."""
        scalar, vector = self.lanes.scalar(kind), self.lanes.vector(kind)
        first = self.writer.value(f"insertelement {vector} poison, {scalar} {name}, i64 0")
        spread = f"shufflevector {vector} {first}, {vector} poison, "
        return self.writer.value(spread + f"<{self.lanes.width} x i32> zeroinitializer")

    def spread(self, leaf: Leaf) -> Leaf:
        """Return the leaf with a vector for each chunk."""
        return leaf if not leaf.uniform else Leaf(leaf.kind, self.vectors(leaf), False)

    def apply(self, result: Kind, template: str, *operands: Leaf) -> Leaf:
        """Write an instruction for scalars or for each chunk.

        Args:
            result: The kind of the result.
            template: ``{0}`` is the first operand, ``{t0}`` its type, ``{r}`` the result's type.
            operands: The operands.
        """
        uniform = all([o.uniform for o in operands])
        key = (template, uniform, result, *[o.kind for o in operands])
        typed = self._typed.get(key)
        if typed is None:
            typed = self._typed[key] = self._with_types(result, template, operands, uniform)
        write = self._value
        if uniform:
            return Leaf(result, (write(typed.format(*[o.names[0] for o in operands])),), True)
        columns = [self.vectors(o) for o in operands]
        rows = zip(*columns, strict=True)
        return Leaf(result, tuple([write(typed.format(*row)) for row in rows]), False)

    def _value(self, instruction: str) -> str:
        """Write an instruction, unless this block has the same one; return its result's name.

        LLVM would find them, but the fusion of products depends on how often each is used.
        """
        if self._block != self.writer.block:
            self._block, self._values = self.writer.block, {}
        name = self._values.get(instruction)
        if name is None:
            name = self._values[instruction] = self.writer.value(instruction)
        return name

    def _with_types(
        self, result: Kind, template: str, operands: Sequence[Leaf], uniform: bool
    ) -> str:
        """Return a template in which types are filled in; see ``apply``.

        Args:
            result: The kind of the result.
            template: The template.
            operands: The operands.
            uniform: Whether all operands are uniform.
        """
        typed = template.replace("{r}", self.lanes.type(result, uniform=uniform))
        for i, operand in enumerate(operands):
            typed = typed.replace(f"{{t{i}}}", self.lanes.type(operand.kind, uniform=uniform))
        return typed

    def intrinsic(self, name: str, result: Kind, *operands: Leaf, rest: str = "") -> Leaf:
        """Write a call of an overloaded LLVM intrinsic.

        Args:
            name: The intrinsic's name, without ``llvm.`` and type suffixes.
            result: The kind of the result.
            operands: The operands.
            rest: Text of further arguments after the operands.
        """
        lanes, uniform = self.lanes, all(o.uniform for o in operands)
        width = "" if uniform else f"v{lanes.width}"
        suffix = f".{width}{_letters(lanes.scalar(result))}"
        if operands[0].kind is not result:
            suffix += f".{width}{_letters(lanes.scalar(operands[0].kind))}"
        types = ", ".join(lanes.type(o.kind, uniform=uniform) for o in operands)
        more = ", i1" if rest else ""
        returned = lanes.type(result, uniform=uniform)
        self.declarations.add(f"declare {returned} @llvm.{name}{suffix}({types}{more})")
        args = ", ".join(f"{{t{i}}} {{{i}}}" for i in range(len(operands)))
        return self.apply(result, f"call {{r}} @llvm.{name}{suffix}({args}{rest})", *operands)

    # Operations of the language

    def select(self, condition: Leaf, yes: Leaf, no: Leaf) -> Leaf:
        """Return ``yes`` in the lanes where the condition holds, else ``no``.

        Args:
            condition: A bool.
            yes: The value if the condition holds.
            no: The value if it does not.
        """
        if yes == no:
            return yes
        if condition.constant:
            return yes if condition.names[0] == "true" else no
        form = "select {t0} {0}, {t1} {1}, {t2} {2}"
        if condition.uniform and not (yes.uniform and no.uniform):
            # A scalar condition selects whole vectors.
            vector = self.lanes.vector(yes.kind)
            pairs = zip(self.vectors(yes), self.vectors(no), strict=True)
            return Leaf(
                yes.kind,
                tuple(
                    self.writer.value(f"select i1 {condition.names[0]}, {vector} {a}, {vector} {b}")
                    for a, b in list(pairs)
                ),
                False,
            )
        return self.apply(yes.kind, form, condition, yes, no)

    def compare(self, op: CompareOp, lhs: Leaf, rhs: Leaf) -> Leaf:
        """Return the comparison ``lhs op rhs``.

        Args:
            op: The comparison.
            lhs: The left operand.
            rhs: The right operand, of the same kind.
        """
        if lhs.kind is Kind.FLOAT:
            form = f"fcmp {_FLOAT_COMPARE[op]} {{t0}} {{0}}, {{1}}"
        elif op in _ORDER:
            sign = "s" if lhs.kind is Kind.INT else "u"
            form = f"icmp {sign}{_ORDER[op]} {{t0}} {{0}}, {{1}}"
        else:
            form = f"icmp {'eq' if op is CompareOp.EQ else 'ne'} {{t0}} {{0}}, {{1}}"
        return self.apply(Kind.BOOL, form, lhs, rhs)

    def binary(self, op: BinaryOp, lhs: Leaf, rhs: Leaf) -> Leaf:
        """Return ``lhs op rhs`` of one component.

        Args:
            op: The operator.
            lhs: The left operand.
            rhs: The right operand, of the same kind.
        """
        kind = lhs.kind
        if kind is Kind.FLOAT:
            return self._float_binary(op, lhs, rhs)
        if op in _INTEGER_OPS:
            return self.apply(kind, f"{_INTEGER_OPS[op]} {{t0}} {{0}}, {{1}}", lhs, rhs)
        match op:
            case BinaryOp.SHL | BinaryOp.SHR:
                count = self.binary(BinaryOp.AND, rhs, self.constant(31, kind))
                right = "ashr" if kind is Kind.INT else "lshr"
                name = "shl" if op is BinaryOp.SHL else right
                return self.apply(kind, f"{name} {{t0}} {{0}}, {{1}}", lhs, count)
            case BinaryOp.FLOOR_DIV:
                return self._floored(lhs, rhs)[0]
            case BinaryOp.MOD:
                return self._floored(lhs, rhs)[1]
            case _:
                raise AssertionError(f"{op} of {kind}")

    def _float_binary(self, op: BinaryOp, lhs: Leaf, rhs: Leaf) -> Leaf:
        if op in (BinaryOp.ADD, BinaryOp.SUB) and self.is_zero(rhs):
            return lhs  # zeros have no sign in the language
        if op is BinaryOp.ADD and self.is_zero(lhs):
            return rhs
        if op in _FLOAT_OPS:
            return self.apply(Kind.FLOAT, f"{_FLOAT_OPS[op]} {{t0}} {{0}}, {{1}}", lhs, rhs)
        assert op is BinaryOp.DIV, f"{op} of floats is decomposed"
        return self.divide(lhs, rhs)

    def is_zero(self, leaf: Leaf) -> bool:
        """Return whether a float is the constant 0."""
        return leaf.constant and leaf.names[0] == self.lanes.literal(0.0, Kind.FLOAT)

    def divide(self, lhs: Leaf, rhs: Leaf) -> Leaf:
        """Return ``lhs / rhs`` of floats, correctly rounded."""
        return self.apply(Kind.FLOAT, "fdiv {t0} {0}, {1}", lhs, rhs)

    def _floored(self, lhs: Leaf, rhs: Leaf) -> tuple[Leaf, Leaf]:
        """Return ``lhs // rhs`` and ``lhs % rhs`` of ints; x // 0 = x, x % 0 = 0."""
        kind = lhs.kind
        divisor = int(rhs.names[0]) if rhs.constant else 0
        if divisor > 0 and divisor & (divisor - 1) == 0:
            shift = "ashr" if kind is Kind.INT else "lshr"
            bits = self.constant(divisor.bit_length() - 1, kind)
            quotient = self.apply(kind, f"{shift} {{t0}} {{0}}, {{1}}", lhs, bits)
            return quotient, self.binary(BinaryOp.AND, lhs, self.constant(divisor - 1, kind))
        if rhs.constant and divisor == 0:
            return lhs, self.constant(0, kind)
        quotient = self.truncated_quotient(lhs, rhs)
        remainder = self.binary(BinaryOp.SUB, lhs, self.binary(BinaryOp.MUL, quotient, rhs))
        zero = self.constant(0, kind)
        if kind is Kind.INT:
            # Round down instead of toward zero if the remainder's sign is not the divisor's.
            signs = self.compare(CompareOp.LT, self.binary(BinaryOp.XOR, remainder, rhs), zero)
            inexact = self.compare(CompareOp.NE, remainder, zero)
            wrong = self.apply(Kind.BOOL, "and {t0} {0}, {1}", signs, inexact)
            less = self.binary(BinaryOp.SUB, quotient, self.constant(1, kind))
            quotient = self.select(wrong, less, quotient)
            more = self.binary(BinaryOp.ADD, remainder, rhs)
            remainder = self.select(wrong, more, remainder)
        if not rhs.constant:
            # If the divisor is 0, the division used 1, so the quotient is lhs.
            nothing = self.compare(CompareOp.EQ, rhs, zero)
            quotient = self.select(nothing, lhs, quotient)
            remainder = self.select(nothing, zero, remainder)
        return quotient, remainder

    def truncated_quotient(self, lhs: Leaf, rhs: Leaf) -> Leaf:
        """Return the quotient of ints toward zero; it wraps, never traps, and x / 0 is x.

        Computed in doubles: a quotient of two 32-bit ints that is not whole differs from the next
        whole number by more than a double's rounding error. Vector code has no integer division,
        and scalar division by zero would stop the process.
        """
        kind = lhs.kind
        signed = kind is Kind.INT
        if rhs.constant and int(rhs.names[0]) not in (0, -1):
            return self.apply(kind, f"{'s' if signed else 'u'}div {{t0}} {{0}}, {{1}}", lhs, rhs)
        nothing = self.compare(CompareOp.EQ, rhs, self.constant(0, kind))
        rhs = self.select(nothing, self.constant(1, kind), rhs)
        wide = "double" if lhs.uniform and rhs.uniform else f"<{self.lanes.width} x double>"
        whole = wide.replace("double", "i64")
        uniform = lhs.uniform and rhs.uniform
        type = self.lanes.type(kind, uniform=uniform)
        convert = "sitofp" if signed else "uitofp"
        names = []
        sides = (o.names if uniform else self.vectors(o) for o in (lhs, rhs))
        for a, b in list(zip(*sides, strict=True)):
            x = self.writer.value(f"{convert} {type} {a} to {wide}")
            y = self.writer.value(f"{convert} {type} {b} to {wide}")
            quotient = self.writer.value(f"fdiv {wide} {x}, {y}")
            long = self.writer.value(f"fptosi {wide} {quotient} to {whole}")
            names.append(self.writer.value(f"trunc {whole} {long} to {type}"))
        return Leaf(kind, tuple(names), uniform)

    def negate(self, operand: Leaf) -> Leaf:
        """Return ``-operand``."""
        if operand.kind is Kind.FLOAT:
            return self.apply(Kind.FLOAT, "fneg {t0} {0}", operand)
        return self.binary(BinaryOp.SUB, self.constant(0, operand.kind), operand)

    def invert(self, operand: Leaf) -> Leaf:
        """Return ``not`` of a bool, or ``~`` of an int."""
        ones = self.constant(True if operand.kind is Kind.BOOL else -1, operand.kind)
        return self.apply(operand.kind, "xor {t0} {0}, {1}", operand, ones)

    def both(self, lhs: Leaf, rhs: Leaf) -> Leaf:
        """Return ``and`` of bools."""
        return self.apply(Kind.BOOL, "and {t0} {0}, {1}", lhs, rhs)

    def either(self, lhs: Leaf, rhs: Leaf) -> Leaf:
        """Return ``or`` of bools."""
        return self.apply(Kind.BOOL, "or {t0} {0}, {1}", lhs, rhs)

    def cast(self, operand: Leaf, kind: Kind) -> Leaf:
        """Return the leaf converted to another kind."""
        source = operand.kind
        if source is kind:
            return operand
        if kind is Kind.BOOL:
            return self.compare(CompareOp.NE, operand, self.constant(0, source))
        if source is Kind.BOOL:
            return self.select(operand, self.constant(1, kind), self.constant(0, kind))
        if source is Kind.FLOAT:
            sign = "s" if kind is Kind.INT else "u"
            return self.intrinsic(f"fpto{sign}i.sat", kind, operand)
        if kind is Kind.FLOAT:
            sign = "s" if source is Kind.INT else "u"
            return self.apply(kind, f"{sign}itofp {{t0}} {{0}} to {{r}}", operand)
        return Leaf(kind, operand.names, operand.uniform, operand.constant)

    def any_lane(self, leaf: Leaf) -> str:
        """Return a scalar i1: whether any lane is true."""
        if leaf.uniform:
            return leaf.names[0]
        mask = self.lanes.vector(Kind.BOOL)
        joined = leaf.names[0]
        for chunk in leaf.names[1:]:
            joined = self.writer.value(f"or {mask} {joined}, {chunk}")
        bits = self.writer.value(f"bitcast {mask} {joined} to i{self.lanes.width}")
        return self.writer.value(f"icmp ne i{self.lanes.width} {bits}, 0")

    # Loop-carried bools

    def carried(self, kind: Kind, *, uniform: bool) -> str:
        """Return the type of a loop-carried leaf.

        Processors without mask registers represent bools as whole lanes. For vectors of i1, LLVM
        would pack and unpack them in each iteration, so bools are carried as vectors of ints.
        """
        packed = kind is Kind.BOOL and not uniform and self.lanes.level != "avx512"
        return self.lanes.type(Kind.INT if packed else kind, uniform=uniform)

    def to_carried(self, kind: Kind, name: str, *, uniform: bool) -> str:
        """Convert a leaf's name to its carried form, at the end of an iteration.

        Args:
            kind: The kind of the leaf.
            name: The name of a scalar or of a chunk.
            uniform: Whether the leaf is uniform.
        """
        type, carried = self.lanes.type(kind, uniform=uniform), self.carried(kind, uniform=uniform)
        if type == carried:
            return name
        if name.startswith("splat"):
            return f"splat (i32 {-1 if 'true' in name else 0})"
        return self.writer.value(f"sext {type} {name} to {carried}")

    def from_carried(self, kind: Kind, name: str, *, uniform: bool) -> str:
        """Convert a leaf's name from its carried form, at the start of an iteration.

        Args:
            kind: The kind of the leaf.
            name: The name of a scalar or of a chunk.
            uniform: Whether the leaf is uniform.
        """
        type, carried = self.lanes.type(kind, uniform=uniform), self.carried(kind, uniform=uniform)
        if type == carried:
            return name
        return self.writer.value(f"icmp slt {carried} {name}, zeroinitializer")

    def spread_all(self, leaves: Leaves) -> Leaves:
        """Return all leaves with a vector for each chunk."""
        return tuple(map(self.spread, leaves))


def _letters(scalar: str) -> str:
    return {"float": "f32", "double": "f64", "i32": "i32", "i1": "i1"}[scalar]
