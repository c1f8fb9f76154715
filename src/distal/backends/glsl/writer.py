"""Write functions in GLSL: the versions ES 3.00 and 3.30, and the differences of ES 1.00.

Input: IR functions after the passes for a GLSL target. Output: their text. Does not depend on
stages, inputs and outputs (``distal.backends.glsl.stages``).
"""

# ruff: noqa: D102  (documented where they are declared)
from __future__ import annotations

from collections.abc import Mapping
from typing import assert_never

from distal.backends.clike.code import Code, Precedence, infix, literal_code, tight
from distal.backends.clike.constants import is_table
from distal.backends.clike.expense import EAGER_OPERATIONS, Expense
from distal.backends.clike.functions import FunctionWriter
from distal.backends.clike.literals import float_literal, int_literal
from distal.backends.clike.module_names import ModuleNames
from distal.backends.glsl.targets import target_name
from distal.diagnostics import CompileError
from distal.error_codes import ErrorCode
from distal.ir.intrinsics import INTRINSICS
from distal.ir.nodes import (
    Binary,
    BinaryOp,
    Builtin,
    Compare,
    CompareOp,
    Const,
    Construct,
    Expr,
    Function,
    Index,
    PerFrame,
    Read,
    Resource,
    Select,
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
)

_COMPARISONS = {
    CompareOp.EQ: "equal",
    CompareOp.NE: "notEqual",
    CompareOp.LT: "lessThan",
    CompareOp.LE: "lessThanEqual",
    CompareOp.GT: "greaterThan",
    CompareOp.GE: "greaterThanEqual",
}


def trust_macro(native: str) -> str:
    """Return the macro that selects the driver's built-in instead of the careful function."""
    return f"TRUST_{native.upper()}"


class GlslWriter(FunctionWriter):
    """Writes GLSL functions.

    Attributes:
        expense: The costs of functions.
        uniform_texts: The texts of the uniforms that are not declared by name.
        output: The variable that ``main`` assigns instead of returning; None in other functions.
        targets: The struct whose fields ``main`` assigns, each to a picture of its own.
        leaves_choice: Whether a macro of the host selects between the driver's built-ins and the
            careful functions.
    """

    family = "glsl"

    def __init__(
        self, names: ModuleNames, expense: Expense, uniform_texts: Mapping[str, str]
    ) -> None:
        """Create a writer.

        Args:
            names: The names in the text.
            expense: The costs of functions.
            uniform_texts: The texts of the uniforms that are not declared by name.
        """
        super().__init__(names)
        self.expense = expense
        self.uniform_texts = uniform_texts
        self.output: str | None = None
        self.targets: Struct | None = None
        self.leaves_choice = False

    # Types

    def type_name(self, type: Type) -> str:
        match type:
            case Scalar() | Vector() | Matrix():
                return str(type)
            case Struct():
                return self.names.structs[type]
            case Array(element, length):
                return f"{self.stored_name(element)}[{length}]"
            case Texture() | Buffer() | FunctionType():
                raise AssertionError(f"{type} is no value")
            case _:
                assert_never(type)

    def stored_name(self, type: Type) -> str:
        """Return a type's name as an element; a struct wraps arrays, because they cannot nest."""
        return self.names.structs[type] if isinstance(type, Array) else self.type_name(type)

    def struct_lines(self, type: Type, held: bool) -> list[str]:
        """Return the declaration of a struct, or of the struct that wraps a ``held`` array."""
        match type:
            case Struct(_, fields):
                members = [f"{self.type_name(t)} {self.names.fields[type, n]};" for n, t in fields]
            case Array() if held:
                members = [f"{self.type_name(type)} items;"]
            case _:
                return []
        return [f"struct {self.names.structs[type]} {{", *(f"    {m}" for m in members), "};"]

    # Leaves

    def constant(self, e: Const) -> Code:
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
        return Code(self.uniform_texts.get(e.name) or self.names.uniforms[e.name])

    def per_frame(self, e: PerFrame) -> Code:
        return Code(self.names.frame[e.name])

    # Functions and statements

    def function(self, fn: Function) -> None:
        if fn.native is None or not self.leaves_choice:
            super().function(fn)
            return
        # Both have the same name, so that no macro replaces one of the author's names.
        self.open_function(fn)
        reads = tuple(Read(p.name, p.type) for p in fn.params)
        native = self.expression(Builtin(fn.native, reads, fn.result))
        self.line(f"#ifdef {trust_macro(fn.native)}")
        self.line(f"{self.header(fn)} {{ {self.native_body(fn, native)} }}")
        self.line("#else")
        self.line(f"{self.header(fn)} {{")
        self.body(fn)
        self.line("}")
        self.line("#endif")

    def native_body(self, fn: Function, native: Code) -> str:
        """Return the body of a careful function where the driver's own is used."""
        return f"return {native.text};"

    def header(self, fn: Function) -> str:
        params = ", ".join(f"{self.type_name(p.type)} {self.locals[p.name]}" for p in fn.params)
        return f"{self.type_name(fn.result)} {self.names.functions[fn.name]}({params})"

    def declaration(self, name: str, value: Code, type: Type, *, mutable: bool) -> str:
        return f"{self.type_name(type)} {name} = {value.text};"

    def unset_declaration(self, name: str, type: Type) -> str:
        return f"{self.type_name(type)} {name};"

    def loop_start(self, name: str, start: Code, type: Type) -> str:
        return f"{self.type_name(type)} {name} = {start.text}"

    def unsigned(self, value: Code) -> Code:
        return self.call("uint", [value])

    def signed(self, value: Code) -> Code:
        return self.call("int", [value])

    def write_return(self, value: Code, *, tail: bool) -> None:
        if self.output is None:
            super().write_return(value, tail=tail)
            return
        if self.targets is None:
            self.line(f"{self.output} = {value.text};")
        else:
            made = self.temporary("targets", value, self.targets).text
            for i, (name, _) in enumerate(self.targets.fields):
                field = self.names.fields[self.targets, name]
                self.line(f"{target_name(i)} = {made}.{field};")
        if not tail:
            self.line("return;")

    def assign_swizzle(self, base: str, lanes: str, value: Code, type: Type) -> None:
        self.line(f"{base}.{lanes} = {value.text};")

    def target_index(self, base: str, target: Index) -> str:
        return self._element_text(base, target)

    def zero(self, type: Type) -> str:
        match type:
            case Scalar(kind):
                return {Kind.FLOAT: "0.0", Kind.INT: "0", Kind.UINT: "0u", Kind.BOOL: "false"}[kind]
            case Vector(kind) if kind is not Kind.FLOAT:
                return f"{type}({self.zero(Scalar(kind))})"
            case Vector() | Matrix():
                return f"{type}(0.0)"
            case Struct(_, fields):
                return f"{self.type_name(type)}({', '.join(self.zero(t) for _, t in fields)})"
            case Array(element, length):
                return f"{self.type_name(type)}({', '.join([self.held_zero(element)] * length)})"
            case Texture() | Buffer() | FunctionType():
                raise AssertionError(f"{type} is no value")
            case _:
                assert_never(type)

    def held_zero(self, element: Type) -> str:
        """Return a zero as an element of an array."""
        zero = self.zero(element)
        return f"{self.stored_name(element)}({zero})" if isinstance(element, Array) else zero

    # Operators

    def arguments(self, args: list[Code]) -> str:
        return ", ".join(a.text for a in args)

    def scalar_arguments(self, name: str) -> tuple[int, ...]:
        return INTRINSICS[name].glsl_scalars

    def unary_special(self, e: Unary) -> Code | None:
        if e.op is UnaryOp.NOT and isinstance(e.type, Vector):
            return self.call("not", [self.expression(e.operand)])
        return None

    def matrix_scale(self, e: Binary) -> Code | None:
        return None

    def vector_compare(self, e: Compare) -> Code:
        args = [self.expression(e.lhs), self.expression(e.rhs)]
        return self.call(_COMPARISONS[e.op], args)

    def bool_vector_binary(self, op: BinaryOp, lhs: Code, rhs: Code, type: Type) -> Code:
        if op is BinaryOp.XOR:
            return self.call("notEqual", [lhs, rhs])
        # GLSL has no && or & of bool vectors: compute with 0.0 and 1.0.
        as_floats = f"vec{component_count(type)}"
        sides = (self.call(as_floats, [side]) for side in (lhs, rhs))
        operator = ("*", Precedence.PRODUCT) if op is BinaryOp.AND else ("+", Precedence.SUM)
        joined = infix(*operator, *sides)
        return self.call(str(type), [joined])

    def shift(self, e: Binary) -> Code:
        count: Expr = e.rhs
        lhs, rhs = self.expression(e.lhs), self.expression(count)
        if isinstance(count, Const):
            wide = "u" if kind_of(count.type) is Kind.UINT else ""
            rhs = Code(f"{int(count.value) & 31}{wide}")
        return infix(e.op.value, Precedence.SHIFT, lhs, rhs)

    def chosen(self, e: Select, condition: Code, yes: Code, no: Code) -> Code | None:
        if not isinstance(e.type, Scalar | Vector | Matrix):
            return None
        if self.family == "glsl" and self._is_picked(e):
            lanes = component_count(e.type) if isinstance(e.type, Vector) else 1
            picks = self.call(f"bvec{lanes}", [condition]) if lanes > 1 else condition
            return self.call("mix", [no, yes, picks])
        test = f"({condition.text})" if condition.level is Precedence.TERNARY else condition.text
        first = f"({yes.text})" if yes.level is Precedence.TERNARY else yes.text
        return Code(f"{test} ? {first} : {no.text}", Precedence.TERNARY)

    def _is_picked(self, e: Select) -> bool:
        """Return whether to compute both values: ``?:`` may become a branch, ``mix`` never does.

        SwiftShader's time to compile a loop doubles with each branch that has two equally long
        sides. It compiled none of nine scenes of the gallery before the memory ran out; with
        ``mix`` it takes a second.
        """
        if isinstance(e.type, Matrix) or kind_of(e.type) is not Kind.FLOAT:
            return False
        return max(self.expense.of(e.yes), self.expense.of(e.no)) <= EAGER_OPERATIONS

    def chosen_by_components(self, e: Select) -> Code:
        if kind_of(e.type) is Kind.FLOAT and self.family == "glsl":
            return self.call("mix", [self.expression(part) for part in (e.no, e.yes, e.condition)])
        parts = zip(*map(self.components, (e.condition, e.yes, e.no)), strict=True)
        picks = [Code(f"{tight(c)} ? {tight(y)} : {tight(n)}") for c, y, n in parts]
        return self.call(str(e.type), picks)

    # Arrays

    def array_text(self, e: Construct) -> Code:
        assert isinstance(e.type, Array)
        parts = []
        for part in e.parts:
            code = self.table_part(part)
            if isinstance(e.type.element, Array):
                code = self.call(self.stored_name(e.type.element), [code])
            parts.append(code)
        return self.call(self.type_name(e.type), parts)

    def element(self, e: Index) -> Code:
        base = self.expression(e.base)
        if isinstance(e.base, Construct) and not is_table(e.base):
            base = self.temporary("items", base, e.base.type)
        return Code(self._element_text(tight(base), e))

    def _element_text(self, base: str, e: Index) -> str:
        text = f"{base}[{self.expression(e.index).text}]"
        return f"{text}.items" if isinstance(e.type, Array) else text

    # Textures and buffers

    def buffer_element(self, resource: Resource, index: Code) -> Code:
        return self.call(self.names.accessors[resource.name], [index])

    def sample(self, resource: Resource, coord: Code) -> Code:
        return self.call(
            "textureLod", [Code(self.names.resources[resource.name]), coord, Code("0.0")]
        )

    def texel(self, resource: Resource, index: Code) -> Code:
        return self.call(self.names.accessors[resource.name], [index])

    def size(self, resource: Resource) -> Code:
        if isinstance(resource.type, Buffer):
            return Code(self.names.counts[resource.name])
        name = self.names.resources[resource.name]
        return self.call("textureSize", [Code(name), Code("0")])


class Glsl100Writer(GlslWriter):
    """Writes GLSL ES 1.00, where arrays are not values: each becomes a struct of its elements."""

    family = "glsl100"

    def type_name(self, type: Type) -> str:
        return self.names.structs[type] if isinstance(type, Array) else super().type_name(type)

    def struct_lines(self, type: Type, held: bool) -> list[str]:
        if not isinstance(type, Array):
            return super().struct_lines(type, held)
        element = self.type_name(type.element)
        members = [f"    {element} item{i};" for i in range(type.length)]
        return [f"struct {self.names.structs[type]} {{", *members, "};"]

    def held_zero(self, element: Type) -> str:
        return self.zero(element)

    def array(self, e: Construct) -> Code:
        return self.call(self.type_name(e.type), map(self.expression, e.parts))

    def element(self, e: Index) -> Code:
        return Code(self._element_text(tight(self.expression(e.base)), e))

    def _element_text(self, base: str, e: Index) -> str:
        if not isinstance(e.index, Const):
            raise CompileError.at(
                ErrorCode.TARGET,
                "GLSL ES 1.00 has no index that is computed at run time",
                self.span,
            )
        if isinstance(e.base.type, Array):
            return f"{base}.item{int(e.index.value)}"
        return f"{base}[{int(e.index.value)}]"

    def sample(self, resource: Resource, coord: Code) -> Code:
        assert isinstance(resource.type, Texture)
        if resource.type.shape is TextureShape.VOLUME:
            raise CompileError.at(ErrorCode.TARGET, "GLSL ES 1.00 has no 3D textures", self.span)
        function = "texture2D" if resource.type.shape is TextureShape.FLAT else "textureCube"
        return self.call(function, [Code(self.names.resources[resource.name]), coord])

    def texel(self, resource: Resource, index: Code) -> Code:
        raise CompileError.at(
            ErrorCode.TARGET,
            "GLSL ES 1.00 reads no single texels",
            self.span,
            "use sample(texture, coord)",
        )

    def size(self, resource: Resource) -> Code:
        lacks = "has no buffers" if isinstance(resource.type, Buffer) else "knows no texture's size"
        raise CompileError.at(ErrorCode.TARGET, f"GLSL ES 1.00 {lacks}", self.span)

    def buffer_element(self, resource: Resource, index: Code) -> Code:
        raise CompileError.at(ErrorCode.TARGET, "GLSL ES 1.00 has no buffers", self.span)
