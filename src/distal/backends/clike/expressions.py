"""Write expressions in the common syntax of GLSL and WGSL: infix operators, swizzles, calls.

Input: IR expressions. Output: text with as few brackets as both grammars allow. If a language
cannot express something inside an expression, the writer declares a local before the statement, by
appending to ``lines``. The methods of ``distal.backends.clike.dialect`` write everything that
differs between the languages.
"""

from __future__ import annotations

import re
from collections.abc import Iterable
from typing import assert_never

from distal.backends.clike.code import Code, Line, Precedence, infix, prefix, tight
from distal.backends.clike.constants import is_table
from distal.backends.clike.dialect import Dialect
from distal.backends.clike.module_names import ModuleNames
from distal.diagnostics import Span
from distal.ir.intrinsics import INTRINSICS
from distal.ir.nodes import (
    Apply,
    Binary,
    BinaryOp,
    Builtin,
    Call,
    Cast,
    Compare,
    Compose,
    Const,
    Construct,
    Expr,
    Field,
    FunctionRef,
    Gradient,
    Index,
    Logical,
    LogicalOp,
    MatMul,
    PerFrame,
    Read,
    Resource,
    Sample,
    Select,
    Size,
    Splat,
    Swizzle,
    Texel,
    Unary,
    Uniform,
)
from distal.ir.types import Array, Buffer, Kind, Struct, Type, Vector, kind_of

INFIX = {
    BinaryOp.ADD: Precedence.SUM,
    BinaryOp.SUB: Precedence.SUM,
    BinaryOp.MUL: Precedence.PRODUCT,
    BinaryOp.DIV: Precedence.PRODUCT,
    BinaryOp.AND: Precedence.BITS,
    BinaryOp.OR: Precedence.BITS,
    BinaryOp.XOR: Precedence.BITS,
    BinaryOp.SHL: Precedence.SHIFT,
    BinaryOp.SHR: Precedence.SHIFT,
}

# Operators that both languages accept between a scalar and a vector.
_MIXED = (BinaryOp.ADD, BinaryOp.SUB, BinaryOp.MUL, BinaryOp.DIV)

_PLAIN_CALL = re.compile(r"[\w<>{}]+\((\{\d\}(, \{\d\})*)?\)")


class ExpressionWriter(Dialect):
    """Writes the expressions of one function at a time.

    Attributes:
        names: The names of module scope.
        tables: The tables of literals and their names.
        lines: The lines written so far.
        depth: The current indentation, in steps.
        span: The author's place that new lines get.
        locals: The names of locals in the text, by IR name.
        local_namer: Makes names for new locals.
    """

    def __init__(self, names: ModuleNames) -> None:
        self.names = names
        self.tables: dict[Construct, str] = {}
        self.lines: list[Line] = []
        self.depth = 0
        self.span: Span | None = None
        self.locals: dict[str, str] = {}
        self.local_namer = names.local_namer()

    def line(self, text: str) -> None:
        """Append a line at the current indentation."""
        self.lines.append(Line("    " * self.depth + text if text else "", self.span))

    def temporary(self, wanted: str, value: Code, type: Type, *, mutable: bool = False) -> Code:
        """Declare a local with a value before the current statement, and return a read of it.

        Args:
            wanted: The preferred name.
            value: The value.
            type: The type of the value.
            mutable: Whether the local is assigned again.
        """
        name = self.local_namer.name(wanted)
        self.line(self.declaration(name, value, type, mutable=mutable))
        return Code(name)

    def named(self, e: Expr, wanted: str = "value") -> Code:
        """Return text that can be used several times without computing the value again."""
        code = self.expression(e)
        if isinstance(e, Const | Read | Uniform | PerFrame):
            return code
        return self.temporary(wanted, code, e.type)

    def components(self, e: Expr) -> list[Code]:
        """Return the components of a vector; the vector itself is computed once."""
        assert isinstance(e.type, Vector)
        match e:
            case Splat(value):
                return [self.named(value)] * e.type.size
            case Compose(parts) if len(parts) == e.type.size:
                return [self.expression(part) for part in parts]
            case _:
                whole = tight(self.named(e))
                return [Code(f"{whole}.{lane}") for lane in "xyzw"[: e.type.size]]

    def call(self, function: str, args: Iterable[Code]) -> Code:
        """Return a call of a function or constructor."""
        return Code(f"{function}({self.arguments(list(args))})")

    def expression(self, e: Expr) -> Code:
        """Return the text of an expression; lines that must precede the statement are appended."""
        match e:
            case Const():
                return self.constant(e)
            case Read(name):
                return Code(self.locals[name])
            case Uniform():
                return self.uniform(e)
            case PerFrame():
                return self.per_frame(e)
            case Unary():
                return self.unary_special(e) or prefix(
                    "!" if e.op.value == "not" else e.op.value, self.expression(e.operand)
                )
            case Binary():
                return self._binary(e)
            case MatMul(lhs, rhs):
                return infix("*", Precedence.PRODUCT, self.expression(lhs), self.expression(rhs))
            case Compare(op, lhs, rhs):
                if isinstance(lhs.type, Vector):
                    return self.vector_compare(e)
                return infix(
                    op.value, Precedence.RELATION, self.expression(lhs), self.expression(rhs)
                )
            case Logical():
                return self._logical(e)
            case Select():
                return self._select(e)
            case Splat(value, type):
                return self.call(self.type_name(type), [self.expression(value)])
            case Cast(value, type):
                return self.call(self.type_name(type), [self.expression(value)])
            case Compose(parts, type):
                return self.call(self.type_name(type), map(self.expression, parts))
            case Construct(parts, type):
                if not isinstance(type, Struct):
                    return self.array(e)
                return self.call(self.type_name(type), map(self.expression, parts))
            case Swizzle(base, lanes):
                return Code(f"{tight(self.expression(base))}.{lanes}")
            case Field(base, name):
                assert isinstance(base.type, Struct)
                field = self.names.fields[base.type, name]
                return Code(f"{tight(self.expression(base))}.{field}")
            case Index(base, index):
                if isinstance(base.type, Buffer):
                    assert isinstance(base, Resource)
                    return self.buffer_element(base, self.expression(index))
                return self.element(e)
            case Builtin():
                return self._builtin(e)
            case Call(function, args):
                return self.call(self.names.functions[function], map(self.expression, args))
            case Sample(texture, coord):
                assert isinstance(texture, Resource)
                return self.sample(texture, self.expression(coord))
            case Texel(texture, index):
                assert isinstance(texture, Resource)
                return self.texel(texture, self.expression(index))
            case Size(resource):
                assert isinstance(resource, Resource)
                return self.size(resource)
            case Resource() | FunctionRef() | Apply() | Gradient():
                raise AssertionError(f"{e.__class__.__name__} reached a backend as a value")
            case _:
                assert_never(e)

    def array(self, e: Construct) -> Code:
        """Return an array; an array of literals is a table, declared once outside the functions."""
        if not is_table(e):
            return self.array_text(e)
        if e not in self.tables:
            self.tables[e] = self.names.tables[len(self.tables)]
        return Code(self.tables[e])

    def table_part(self, e: Expr) -> Code:
        """Return an element of an array's constructor."""
        if not isinstance(e, Construct):
            return self.expression(e)
        if isinstance(e.type, Array):
            return self.array_text(e)
        return self.call(self.type_name(e.type), map(self.table_part, e.parts))

    def _binary(self, e: Binary) -> Code:
        op, type = e.op, e.type
        if op in (BinaryOp.SHL, BinaryOp.SHR):
            return self.shift(e)
        if kind_of(type) is Kind.BOOL:
            lhs, rhs = self.expression(e.lhs), self.expression(e.rhs)
            if isinstance(type, Vector):
                return self.bool_vector_binary(op, lhs, rhs, type)
            spelled = {BinaryOp.AND: "&&", BinaryOp.OR: "||", BinaryOp.XOR: "!="}[op]
            level = {"&&": Precedence.AND, "||": Precedence.OR, "!=": Precedence.RELATION}[spelled]
            return infix(spelled, level, lhs, rhs)
        scaled = self.matrix_scale(e)
        if scaled is not None:
            return scaled
        level = INFIX[op]  # floor division and remainder were decomposed
        return infix(op.value, level, self._side(e, e.lhs, e.rhs), self._side(e, e.rhs, e.lhs))

    def _side(self, e: Binary, operand: Expr, other: Expr) -> Code:
        if e.op in _MIXED and isinstance(operand, Splat) and not isinstance(other, Splat):
            return self.expression(operand.value)
        return self.expression(operand)

    def _builtin(self, e: Builtin) -> Code:
        intrinsic = INTRINSICS[e.name]
        spelling = intrinsic.spelling(self.family)
        may_be_scalar = self.scalar_arguments(e.name)
        splats = [i for i in may_be_scalar if isinstance(e.args[i], Splat)]
        args = []
        for i, arg in enumerate(e.args):
            # clamp(v, 0.0, 1.0): either all arguments that may be scalar are scalar, or none.
            narrow = isinstance(arg, Splat) and i in splats and len(splats) == len(may_be_scalar)
            args.append(self.expression(arg.value if narrow and isinstance(arg, Splat) else arg))
        if spelling is None:
            return self.call(e.name, args)
        result = self.type_name(e.type)
        if _PLAIN_CALL.fullmatch(spelling):
            name = spelling[: spelling.index("(")].replace("{result}", result)
            return self.call(name, args)
        return Code(spelling.format(*map(tight, args), result=result))

    def _logical(self, e: Logical) -> Code:
        is_and = e.op is LogicalOp.AND
        lhs = self.expression(e.lhs)
        mark = len(self.lines)
        self.depth += 1
        rhs = self.expression(e.rhs)
        self.depth -= 1
        needed = self.lines[mark:]
        if not needed:
            op, level = ("&&", Precedence.AND) if is_and else ("||", Precedence.OR)
            return infix(op, level, lhs, rhs)
        # The right side needs statements; they run only if the left side does not decide.
        del self.lines[mark:]
        result = self.temporary("holds", lhs, e.type, mutable=True)
        self.line(f"if ({result.text if is_and else prefix('!', result).text}) {{")
        self.lines += needed
        self.depth += 1
        self.line(f"{result.text} = {rhs.text};")
        self.depth -= 1
        self.line("}")
        return result

    def _select(self, e: Select) -> Code:
        if isinstance(e.condition.type, Vector):
            return self.chosen_by_components(e)
        condition = self.expression(e.condition)
        branches: list[tuple[list[Line], Code]] = []
        self.depth += 1
        for value in (e.yes, e.no):
            mark = len(self.lines)
            code = self.expression(value)
            branches.append((self.lines[mark:], code))
            del self.lines[mark:]
        self.depth -= 1
        (yes_lines, yes), (no_lines, no) = branches
        if not yes_lines and not no_lines:
            chosen = self.chosen(e, condition, yes, no)
            if chosen is not None:
                return chosen
        name = self.local_namer.name("chosen")
        self.line(self.unset_declaration(name, e.type))
        self.line(f"if ({condition.text}) {{")
        self._branch(name, yes_lines, yes)
        self.line("} else {")
        self._branch(name, no_lines, no)
        self.line("}")
        return Code(name)

    def _branch(self, name: str, lines: list[Line], value: Code) -> None:
        self.lines += lines
        self.depth += 1
        self.line(f"{name} = {value.text};")
        self.depth -= 1
