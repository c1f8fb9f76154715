"""The nodes of the IR: expressions, statements, functions and the module.

An expression has a type, no side effects and no evaluation order; it may be computed once, several
times or never. A statement has an order and no value. Nodes are immutable: a pass returns new
nodes. Expressions are interned (``distal.ir.interning``): equal expressions are the same object,
and dictionaries keyed by them are cheap.

Every statement has the span of its source code. An expression's span is the first place where an
equal expression was seen, possibly elsewhere in the source; use it only to narrow the statement's
span (``span_in``).

Names of locals are unique within a function: a name is bound once, by a parameter, Let, Var or For.
A read of a local is in the block of its binding or in a block inside it. Conversions that are
implicit in the author's language are explicit here (a float added to a vec3 is a Splat), so
backends never infer them.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from enum import Enum
from typing import Any, ClassVar, Final, TypeAlias

from distal.diagnostics import Span
from distal.ir.interning import Interned, discriminate_number, interned
from distal.ir.quick_init import quick_init
from distal.ir.types import Type

FRAME_TIME: Final = "frame.time"


class UnaryOp(Enum):
    """The unary operators.

    NEGATE: float and int, vectors, matrices (uint wraps). NOT: bool, bvec. INVERT: int, uint.
    """

    __hash__ = object.__hash__

    __hash__ = object.__hash__  # Enum.__hash__ is a Python function: too slow for every node

    NEGATE = "-"
    NOT = "not"
    INVERT = "~"


class BinaryOp(Enum):
    """The binary operators; the value of a member is its spelling.

    Both operands and the result have the same type; operators work component by component.
    ADD SUB MUL: numbers (ints wrap at 32 bits); ADD SUB also matrices; MUL and DIV of a matrix
    only by a Splat of the matrix type. DIV: floats only. FLOOR_DIV and MOD: floored, numbers;
    for ints x // 0 = x and x % 0 = 0. AND OR XOR: ints, and bools without short circuit.
    SHL SHR: ints, the count taken & 31; SHR keeps an int's sign. The two operands of a shift
    have the same type.
    """

    __hash__ = object.__hash__

    __hash__ = object.__hash__

    ADD = "+"
    SUB = "-"
    MUL = "*"
    DIV = "/"
    FLOOR_DIV = "//"
    MOD = "%"
    AND = "&"
    OR = "|"
    XOR = "^"
    SHL = "<<"
    SHR = ">>"


class CompareOp(Enum):
    """The comparisons: bool for scalars, bvec (component by component) for vectors.

    Bools can be compared with EQ and NE only.
    """

    __hash__ = object.__hash__

    __hash__ = object.__hash__

    EQ = "=="
    NE = "!="
    LT = "<"
    LE = "<="
    GT = ">"
    GE = ">="


class LogicalOp(Enum):
    """The short-circuit operators on scalar bools.

    Since expressions have no side effects, short circuit changes the cost only, not the result.
    """

    __hash__ = object.__hash__

    __hash__ = object.__hash__

    AND = "and"
    OR = "or"


class ExpressionNode(Interned):
    """An expression node.

    Attributes:
        memo: What the expression contains, once ``distal.ir.contents`` has found it. It lives as
            long as the node.
    """

    __slots__ = ("memo",)

    memo: Any


@interned
class Const(ExpressionNode):
    """A scalar literal: bool, int (of INT or UINT, within 32 bits) or finite float."""

    discriminate: ClassVar = staticmethod(discriminate_number)

    value: bool | int | float
    type: Type
    span: Span | None = field(default=None, repr=False, kw_only=True)


@interned
class Read(ExpressionNode):
    """The value of a parameter or local variable."""

    name: str
    type: Type
    span: Span | None = field(default=None, repr=False, kw_only=True)


@interned
class Uniform(ExpressionNode):
    """The value of a uniform of the module (``Module.uniforms``), constant over the whole picture.

    Before the entry pass, a Uniform named ``FRAME_TIME`` is the frame's time; it is not declared.
    """

    name: str
    type: Type
    span: Span | None = field(default=None, repr=False, kw_only=True)


@interned
class PerFrame(ExpressionNode):
    """A value computed by the per-frame part (``Module.frame``); created by the frequency pass."""

    name: str
    type: Type
    span: Span | None = field(default=None, repr=False, kw_only=True)


@interned
class Resource(ExpressionNode):
    """A texture or buffer of ``Module.resources``, referenced by name."""

    name: str
    type: Type
    span: Span | None = field(default=None, repr=False, kw_only=True)


@interned
class FunctionRef(ExpressionNode):
    """A module function as a value, with its last parameters bound to ``captures``.

    ``type`` is the FunctionType of the remaining parameters. Removed by the specialise pass.
    """

    name: str
    captures: tuple[Expr, ...]
    type: Type
    span: Span | None = field(default=None, repr=False, kw_only=True)


@interned
class Unary(ExpressionNode):
    """``op operand``; the result has the operand's type."""

    op: UnaryOp
    operand: Expr
    type: Type
    span: Span | None = field(default=None, repr=False, kw_only=True)


@interned
class Binary(ExpressionNode):
    """``lhs op rhs``; both operands have the type of this node."""

    op: BinaryOp
    lhs: Expr
    rhs: Expr
    type: Type
    span: Span | None = field(default=None, repr=False, kw_only=True)


@interned
class MatMul(ExpressionNode):
    """``lhs @ rhs``: matrix @ matrix, matrix @ vector (column), vector (row) @ matrix."""

    lhs: Expr
    rhs: Expr
    type: Type
    span: Span | None = field(default=None, repr=False, kw_only=True)


@interned
class Compare(ExpressionNode):
    """``lhs op rhs``; both operands have the same type; the result is a bool or a bvec."""

    op: CompareOp
    lhs: Expr
    rhs: Expr
    type: Type
    span: Span | None = field(default=None, repr=False, kw_only=True)


@interned
class Logical(ExpressionNode):
    """``lhs and rhs`` or ``lhs or rhs`` with short circuit."""

    op: LogicalOp
    lhs: Expr
    rhs: Expr
    type: Type
    span: Span | None = field(default=None, repr=False, kw_only=True)


@interned
class Select(ExpressionNode):
    """``yes if condition else no``.

    A bvec condition selects component by component. A bool condition selects the whole value, of
    any value type.
    """

    condition: Expr
    yes: Expr
    no: Expr
    type: Type
    span: Span | None = field(default=None, repr=False, kw_only=True)


@interned
class Splat(ExpressionNode):
    """A scalar repeated into every component of a vector or (for MUL and DIV) a matrix."""

    value: Expr
    type: Type
    span: Span | None = field(default=None, repr=False, kw_only=True)


@interned
class Compose(ExpressionNode):
    """A vector built from scalars and vectors of its kind, or a matrix built from its columns."""

    parts: tuple[Expr, ...]
    type: Type
    span: Span | None = field(default=None, repr=False, kw_only=True)


@interned
class Swizzle(ExpressionNode):
    """Components of a vector selected by letters of ``xyzw``: ``base.xz``; one letter: a scalar."""

    base: Expr
    lanes: str
    type: Type
    span: Span | None = field(default=None, repr=False, kw_only=True)


@interned
class Index(ExpressionNode):
    """``base[index]`` of an array, vector, matrix (a column) or buffer; the index is an int.

    Every index is defined to be clamped into range. The bounds pass makes the clamp explicit unless
    it proves that the index is in range; after this pass an index is always in range (the backend
    still clamps indices of buffers).
    """

    base: Expr
    index: Expr
    type: Type
    span: Span | None = field(default=None, repr=False, kw_only=True)


@interned
class Field(ExpressionNode):
    """The field ``base.name`` of a struct."""

    base: Expr
    name: str
    type: Type
    span: Span | None = field(default=None, repr=False, kw_only=True)


@interned
class Construct(ExpressionNode):
    """A struct built from its fields in order, or an array built from its elements."""

    parts: tuple[Expr, ...]
    type: Type
    span: Span | None = field(default=None, repr=False, kw_only=True)


@interned
class Cast(ExpressionNode):
    """A scalar or vector with its components converted to another kind.

    float to int or uint truncates and saturates, and NaN gives 0; conversions between int and uint
    keep the bits; bool converts to 0 or 1; conversion to bool is ``!= 0``.
    """

    value: Expr
    type: Type
    span: Span | None = field(default=None, repr=False, kw_only=True)


@interned
class Builtin(ExpressionNode):
    """A call of an intrinsic of ``distal.ir.intrinsics``."""

    name: str
    args: tuple[Expr, ...]
    type: Type
    span: Span | None = field(default=None, repr=False, kw_only=True)


@interned
class Call(ExpressionNode):
    """A call of a module function. Functions have no side effects."""

    function: str
    args: tuple[Expr, ...]
    type: Type
    span: Span | None = field(default=None, repr=False, kw_only=True)


@interned
class Apply(ExpressionNode):
    """A call of a function value (a Read of FunctionType, a FunctionRef). Removed by specialise."""

    function: Expr
    args: tuple[Expr, ...]
    type: Type
    span: Span | None = field(default=None, repr=False, kw_only=True)


@interned
class Gradient(ExpressionNode):
    """The exact derivative of a float-valued function value at ``point`` (float, vec2-4).

    ``type`` is the point's type; with ``with_value`` it is the tuple (float, gradient), both from
    one evaluation. Removed by the gradient pass.
    """

    function: Expr
    point: Expr
    with_value: bool
    type: Type
    span: Span | None = field(default=None, repr=False, kw_only=True)


@interned
class Sample(ExpressionNode):
    """A filtered texture value, a vec4. There are no mip maps: every target reads level 0.

    2D: (0, 0) is the lower left corner of the picture, (1, 1) the upper right. The filter is
    linear; coordinates outside wrap as the texture declares. Cube: a direction. 3D: (0, 0, 0) to
    (1, 1, 1).
    """

    texture: Expr
    coord: Expr
    type: Type
    span: Span | None = field(default=None, repr=False, kw_only=True)


@interned
class Texel(ExpressionNode):
    """One unfiltered texel, a vec4, at an ivec2 (2D) or ivec3 (3D; cube: x, y, face); clamped."""

    texture: Expr
    index: Expr
    type: Type
    span: Span | None = field(default=None, repr=False, kw_only=True)


@interned
class Size(ExpressionNode):
    """The size of a texture in texels, ivec2 (2D, cube) or ivec3 (3D), or a buffer's int length."""

    resource: Expr
    type: Type
    span: Span | None = field(default=None, repr=False, kw_only=True)


Expr: TypeAlias = (
    Const
    | Read
    | Uniform
    | PerFrame
    | Resource
    | FunctionRef
    | Unary
    | Binary
    | MatMul
    | Compare
    | Logical
    | Select
    | Splat
    | Compose
    | Swizzle
    | Index
    | Field
    | Construct
    | Cast
    | Builtin
    | Call
    | Apply
    | Gradient
    | Sample
    | Texel
    | Size
)


@quick_init
@dataclass(frozen=True, slots=True)
class Let:
    """Bind an immutable local."""

    name: str
    value: Expr
    span: Span | None = field(default=None, repr=False, kw_only=True)


@quick_init
@dataclass(frozen=True, slots=True)
class Var:
    """Bind a local that Assign may change."""

    name: str
    value: Expr
    span: Span | None = field(default=None, repr=False, kw_only=True)


@quick_init
@dataclass(frozen=True, slots=True)
class Assign:
    """Assign to a Var or to a part of it.

    ``target`` is a Read of the Var, or a Swizzle (no letter twice), Index or Field of a target.
    """

    target: Expr
    value: Expr
    span: Span | None = field(default=None, repr=False, kw_only=True)


@quick_init
@dataclass(frozen=True, slots=True)
class If:
    """Run one of two blocks, selected by a bool condition."""

    condition: Expr
    then: tuple[Stmt, ...]
    otherwise: tuple[Stmt, ...]
    span: Span | None = field(default=None, repr=False, kw_only=True)


@quick_init
@dataclass(frozen=True, slots=True)
class For:
    """``for name in range(start, stop, step)``: a loop at run time with a constant step.

    ``start`` and ``stop`` are computed once, before the loop. ``name`` is a read-only int, visible
    only in the body; ``step`` is not 0. The counter never overflows: the loop ends at the limits of
    int.
    """

    name: str
    start: Expr
    stop: Expr
    step: int
    body: tuple[Stmt, ...]
    span: Span | None = field(default=None, repr=False, kw_only=True)


@quick_init
@dataclass(frozen=True, slots=True)
class While:
    """Run the body while the condition holds."""

    condition: Expr
    body: tuple[Stmt, ...]
    span: Span | None = field(default=None, repr=False, kw_only=True)


@dataclass(frozen=True, slots=True)
class Break:
    """Leave the innermost loop."""

    span: Span | None = field(default=None, repr=False, kw_only=True)


@dataclass(frozen=True, slots=True)
class Continue:
    """Continue with the next iteration of the innermost loop."""

    span: Span | None = field(default=None, repr=False, kw_only=True)


@quick_init
@dataclass(frozen=True, slots=True)
class Return:
    """Return a value from the function."""

    value: Expr
    span: Span | None = field(default=None, repr=False, kw_only=True)


Stmt: TypeAlias = Let | Var | Assign | If | For | While | Break | Continue | Return


@dataclass(frozen=True, slots=True)
class Param:
    """A parameter of a function, read-only in the body."""

    name: str
    type: Type


@dataclass(frozen=True, slots=True)
class Function:
    """A function. Every path ends in Return (or in a ``while True`` that never ends).

    Attributes:
        name: Unique in the module.
        params: The parameters, in order.
        result: The type of the returned value.
        body: The statements.
        source_name: The author's name of the function.
        native: The built-in, with the same arguments, that this function replaces on a target with
            inaccurate built-ins (``Target.rough``). A shader text may let its host select the
            driver's own function instead. None: it replaces no built-in.
        apart: Whether the function is never inlined, and called for each vector: a piece of a
            longer function that was cut, or a long function that few pixels need.
        span: The place in the author's code.
    """

    name: str
    params: tuple[Param, ...]
    result: Type
    body: tuple[Stmt, ...]
    source_name: str
    native: str | None = field(default=None, kw_only=True)
    apart: bool = field(default=False, kw_only=True)
    span: Span | None = field(default=None, repr=False, kw_only=True)
    _hash: int | None = field(default=None, init=False, repr=False, compare=False)

    def __hash__(self) -> int:
        # Computed once: what passes keep is looked up by the function (``distal.ir.kept``).
        found = self._hash
        if found is None:
            found = hash((self.name, self.params, self.result, self.body, self.native, self.span))
            object.__setattr__(self, "_hash", found)
        return found


class Origin(Enum):
    """The source of a uniform's value."""

    FRAME = "frame"  # resolution, time, mouse, index, seed
    PARAMETER = "parameter"  # a parameter of the scene, such as a slider
    NUMBER = "number"  # a number in a scene's shapes: its default value is not part of the code


@dataclass(frozen=True, slots=True)
class UniformDeclaration:
    """One uniform of a module.

    Attributes:
        name: Unique among the uniforms.
        type: The type of its value.
        origin: The source of its value.
        default: A bool, int, float or a tuple of floats.
        interface: The other properties of a parameter in the JSON interface (label, kind, low,
            high, step, log, group, help, options).
        source: The author's parameter object, which validates values.
    """

    name: str
    type: Type
    origin: Origin
    default: Any
    interface: tuple[tuple[str, Any], ...] = ()
    source: Any = field(default=None, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class ResourceDeclaration:
    """One texture or buffer of a module.

    Attributes:
        name: Unique among the resources.
        type: A texture or buffer type.
        source: The author's object that holds the data.
        wrap: "repeat" or "clamp" (textures).
        values: The elements of a buffer that the compiler created for a constant table of the
            program; None: the host provides the data.
    """

    name: str
    type: Type
    source: Any = field(compare=False, repr=False)
    wrap: str = "repeat"
    values: tuple[Any, ...] | None = field(default=None, repr=False)


class EntryKind(Enum):
    """How the entry function is run: once for each pixel, or over arrays of arguments."""

    IMAGE = "image"  # an @image: after the entry pass, main(coord: vec2) -> vec4, per pixel
    FUNCTION = "function"  # a @func: run over arrays of its parameters


@dataclass(frozen=True, slots=True)
class Module:
    """The complete input of one compilation.

    Attributes:
        functions: The reachable functions; each callee precedes its callers; no recursion.
        entry: The name of the function that is run.
        kind: How it is run.
        uniforms: The uniforms in a fixed order: frame values first, then parameters by first use.
        resources: Textures and buffers, by first use.
        frame: The per-frame part, in order: (name, value). A value reads uniforms and earlier
            PerFrame values, and may call functions. Empty before the frequency pass.
    """

    functions: tuple[Function, ...]
    entry: str
    kind: EntryKind
    uniforms: tuple[UniformDeclaration, ...] = ()
    resources: tuple[ResourceDeclaration, ...] = ()
    frame: tuple[tuple[str, Expr], ...] = ()

    def function(self, name: str) -> Function:
        """Return the function named ``name``."""
        return next(f for f in self.functions if f.name == name)


def span_in(stmt_span: Span | None, expr: Expr) -> Span | None:
    """Return the best span for a diagnostic about ``expr`` in a statement with ``stmt_span``."""
    inner = expr.span
    if stmt_span is None or inner is None or inner.file != stmt_span.file:
        return stmt_span or inner
    last = max(stmt_span.end_line, stmt_span.line)
    return inner if stmt_span.line <= inner.line <= last else stmt_span
