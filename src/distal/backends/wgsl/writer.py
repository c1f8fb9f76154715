"""Write functions in WGSL.

Input: IR functions after the passes for WGSL. Output: their text. Does not depend on entry points
and bindings (``distal.backends.wgsl.stages``). There are three differences to GLSL: not every
implementation can index parameters and ``let`` values by a run-time value (they become ``var``);
``select`` evaluates both sides (expensive ones become ``if``); and the compiler evaluates constant
expressions and rejects a division by zero (one constant is then read from a variable).
"""

# ruff: noqa: D102  (documented where they are declared)
from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import assert_never

from distal.backends.clike.code import Code, Precedence, infix, literal_code, tight
from distal.backends.clike.constants import is_literal_operation, is_table
from distal.backends.clike.expense import EAGER_OPERATIONS, Expense
from distal.backends.clike.functions import FunctionWriter
from distal.backends.clike.literals import float_literal, int_literal
from distal.backends.clike.module_names import ModuleNames
from distal.backends.wgsl.names import OWN
from distal.ir.nodes import (
    Binary,
    BinaryOp,
    Compare,
    Const,
    Construct,
    Expr,
    Field,
    Function,
    Index,
    PerFrame,
    Read,
    Resource,
    Select,
    Splat,
    Swizzle,
    Unary,
    UnaryOp,
    Uniform,
)
from distal.ir.types import (
    Array,
    Buffer,
    FunctionType,
    Kind,
    Matrix,
    Scalar,
    Struct,
    Texture,
    TextureShape,
    Type,
    Vector,
    component_count,
    kind_of,
    with_kind,
)
from distal.ir.walk import expressions_in

_SCALARS = {Kind.FLOAT: "f32", Kind.INT: "i32", Kind.UINT: "u32", Kind.BOOL: "bool"}
_LETTERS = {Kind.FLOAT: "f", Kind.INT: "i", Kind.UINT: "u"}


def _root(e: Expr) -> Expr:
    while isinstance(e, Index | Field | Swizzle):
        e = e.base
    return e


def _by_value(e: Index) -> bool:
    """Return whether a run-time index selects an element of an array or matrix."""
    return isinstance(e.base.type, Array | Matrix) and not isinstance(e.index, Const)


class WgslWriter(FunctionWriter):
    """Writes WGSL functions.

    Attributes:
        variables_of_constants: The names of the variables that contain a literal.
    """

    family = "wgsl"

    def __init__(
        self,
        names: ModuleNames,
        expense: Expense,
        frame: Mapping[str, str],
        functions: Mapping[str, str],
    ) -> None:
        """Create a writer.

        Args:
            names: The names in the text.
            expense: The costs of functions.
            frame: Per-frame value -> the text of a read of it.
            functions: The other names of functions that are written twice, by name in the text.
        """
        super().__init__(names)
        self.expense = expense
        self.frame = frame
        self.other_functions = functions
        self.variables_of_constants: dict[Const, str] = {}
        self._hide_next = False
        self._indexed: set[str] = set()

    # Types

    def type_name(self, type: Type) -> str:
        match type:
            case Scalar(kind):
                return _SCALARS[kind]
            case Vector(Kind.BOOL, size):
                return f"vec{size}<bool>"
            case Vector(kind, size):
                return f"vec{size}{_LETTERS[kind]}"
            case Matrix(size):
                return f"mat{size}x{size}f"
            case Struct():
                return self.names.structs[type]
            case Array(element, length):
                return f"array<{self.type_name(element)}, {length}>"
            case Texture() | Buffer() | FunctionType():
                raise AssertionError(f"{type} is no value")
            case _:
                assert_never(type)

    def struct_lines(self, type: Struct) -> list[str]:
        """Return the declaration of a struct."""
        members = [
            f"    {self.names.fields[type, n]}: {self.type_name(t)}," for n, t in type.fields
        ]
        return [f"struct {self.names.structs[type]} {{", *members, "}"]

    def zero(self, type: Type) -> str:
        return f"{self.type_name(type)}()"

    # Leaves

    def expression(self, e: Expr) -> Code:
        if is_literal_operation(e):
            self._hide_next = True
        return super().expression(e)

    def constant(self, e: Const) -> Code:
        if self._hide_next:
            self._hide_next = False
            if e not in self.variables_of_constants:
                self.variables_of_constants[e] = self.names.constants[
                    len(self.variables_of_constants)
                ]
            return Code(self.variables_of_constants[e])
        return self.literal(e)

    def literal(self, e: Const) -> Code:
        """Return a literal, which the compiler may evaluate."""
        kind = kind_of(e.type)
        if kind is Kind.BOOL:
            return Code("true" if e.value else "false")
        if kind is Kind.FLOAT:
            text = float_literal(float(e.value), self.span)
        elif kind is Kind.UINT:
            text = f"{int(e.value)}u"
        else:
            text = int_literal(int(e.value))
        return literal_code(text)

    def uniform(self, e: Uniform) -> Code:
        return self.shared(f"{OWN.uniforms}.{self.names.uniforms[e.name]}", e.type)

    def per_frame(self, e: PerFrame) -> Code:
        text = self.frame[e.name]
        return self.shared(text, e.type) if "." in text else Code(text)

    def shared(self, text: str, type: Type) -> Code:
        """Return a value that is read from a buffer."""
        if kind_of(type) is not Kind.BOOL:
            return Code(text)
        zero = "0u" if isinstance(type, Scalar) else f"vec{component_count(type)}u()"
        return Code(f"{text} != {zero}", Precedence.RELATION)

    def call(self, function: str, args: Iterable[Code]) -> Code:
        return super().call(self.other_functions.get(function, function), args)

    # Statements

    def mentioned(self, fn: Function) -> frozenset[str]:
        return super().mentioned(fn).union(self.other_functions.values())

    def header(self, fn: Function) -> str:
        params = ", ".join(f"{self.locals[p.name]}: {self.type_name(p.type)}" for p in fn.params)
        name = self.names.functions[fn.name]
        name = self.other_functions.get(name, name)
        return f"fn {name}({params}) -> {self.type_name(fn.result)}"

    def declaration(self, name: str, value: Code, type: Type, *, mutable: bool) -> str:
        return f"{'var' if mutable else 'let'} {name} = {value.text};"

    def unset_declaration(self, name: str, type: Type) -> str:
        return f"var {name}: {self.type_name(type)};"

    def loop_start(self, name: str, start: Code, type: Type) -> str:
        return f"var {name} = {start.text}"

    def unsigned(self, value: Code) -> Code:
        return self.call("u32", [value])

    def signed(self, value: Code) -> Code:
        return self.call("i32", [value])

    def bind(self, name: str, value: Expr, *, mutable: bool) -> None:
        copied = name in self._indexed and not is_table(value)
        super().bind(name, value, mutable=mutable or copied)

    def copy_parameters(self, fn: Function) -> None:
        self._indexed = {
            root.name
            for e in expressions_in(fn.body)
            if isinstance(e, Index) and _by_value(e) and isinstance(root := _root(e), Read)
        }
        for param in fn.params:
            if param.name in self._indexed:
                copy = self.temporary(
                    f"{self.locals[param.name]}_copy",
                    Code(self.locals[param.name]),
                    param.type,
                    mutable=True,
                )
                self.locals[param.name] = copy.text

    def assign_swizzle(self, base: str, lanes: str, value: Code, type: Type) -> None:
        parts = self.temporary("lanes", value, type)
        for lane, source in zip(lanes, "xyzw", strict=False):
            self.line(f"{base}.{lane} = {parts.text}.{source};")

    def target_index(self, base: str, target: Index) -> str:
        return f"{base}[{self.expression(target.index).text}]"

    # Operators

    def arguments(self, args: list[Code]) -> str:
        # f(a < b, c > d) would be read as one argument, a<b, c>.
        loose = (Precedence.RELATION, Precedence.AND, Precedence.OR)
        first = [f"({a.text})" if a.level in loose else a.text for a in args[:-1]]
        return ", ".join([*first, *(a.text for a in args[-1:])])

    def scalar_arguments(self, name: str) -> tuple[int, ...]:
        return (2,) if name == "mix" else ()

    def unary_special(self, e: Unary) -> Code | None:
        if e.op is UnaryOp.NEGATE and kind_of(e.type) is Kind.UINT:
            return infix("-", Precedence.SUM, Code("0u"), self.expression(e.operand))
        if isinstance(e.type, Matrix):
            # The language has no minus before a matrix (WGSL, "Arithmetic Expressions").
            return infix("*", Precedence.PRODUCT, Code("-1.0"), self.expression(e.operand))
        return None

    def matrix_scale(self, e: Binary) -> Code | None:
        if e.op is not BinaryOp.DIV or not isinstance(e.type, Matrix):
            return None
        lhs, rhs = (
            self.named(side.value) if isinstance(side, Splat) else self.named(side, "matrix")
            for side in (e.lhs, e.rhs)
        )
        columns = []
        for i in range(e.type.size):
            sides = (
                code if isinstance(side, Splat) else Code(f"{tight(code)}[{i}]")
                for side, code in ((e.lhs, lhs), (e.rhs, rhs))
            )
            columns.append(infix("/", Precedence.PRODUCT, *sides))
        return self.call(self.type_name(e.type), columns)

    def vector_compare(self, e: Compare) -> Code:
        return infix(
            e.op.value, Precedence.RELATION, self.expression(e.lhs), self.expression(e.rhs)
        )

    def bool_vector_binary(self, op: BinaryOp, lhs: Code, rhs: Code, type: Type) -> Code:
        if op is BinaryOp.XOR:
            return infix("!=", Precedence.RELATION, lhs, rhs)
        return infix(op.value, Precedence.BITS, lhs, rhs)

    def shift(self, e: Binary) -> Code:
        lhs = self.expression(e.lhs)
        return infix(e.op.value, Precedence.SHIFT, lhs, self._count(e.rhs))

    def _count(self, e: Expr) -> Code:
        """Return a shift's count, which must be a u32 in WGSL."""
        unsigned = with_kind(e.type, Kind.UINT)
        match e:
            case Const(value):
                return Code(f"{int(value) & 31}u")
            case Splat(Const(value)):
                return Code(f"{self.type_name(unsigned)}({int(value) & 31}u)")
            case _ if e.type is unsigned:
                return self.expression(e)
            case _:
                return self.call(self.type_name(unsigned), [self.expression(e)])

    def chosen(self, e: Select, condition: Code, yes: Code, no: Code) -> Code | None:
        if not isinstance(e.type, Scalar | Vector):
            return None
        if max(self.expense.of(e.yes), self.expense.of(e.no)) > EAGER_OPERATIONS:
            return None
        return self.call("select", [no, yes, condition])

    def chosen_by_components(self, e: Select) -> Code:
        return self.call("select", [self.expression(part) for part in (e.no, e.yes, e.condition)])

    # Arrays

    def array_text(self, e: Construct) -> Code:
        return self.call(self.type_name(e.type), map(self.table_part, e.parts))

    def element(self, e: Index) -> Code:
        base = self.expression(e.base)
        root = _root(e.base)
        is_value = not isinstance(root, Read | Uniform | PerFrame)
        if _by_value(e) and is_value and base.text not in self.tables.values():
            base = self.temporary("items", base, e.base.type, mutable=True)
        return Code(f"{tight(base)}[{self.expression(e.index).text}]")

    # Textures and buffers

    def buffer_element(self, resource: Resource, index: Code) -> Code:
        return self.call(self.names.accessors[resource.name], [index])

    def texel(self, resource: Resource, index: Code) -> Code:
        return self.call(self.names.accessors[resource.name], [index])

    def sample(self, resource: Resource, coord: Code) -> Code:
        texture = Code(self.names.resources[resource.name])
        sampler = Code(self.names.samplers[resource.name])
        return self.call("textureSampleLevel", [texture, sampler, coord, Code("0.0")])

    def size(self, resource: Resource) -> Code:
        name = self.names.resources[resource.name]
        if isinstance(resource.type, Buffer):
            return self.call("i32", [Code(f"arrayLength(&{name})")])
        assert isinstance(resource.type, Texture)
        extent = "vec3i" if resource.type.shape is TextureShape.VOLUME else "vec2i"
        return self.call(extent, [Code(f"textureDimensions({name})")])
