"""The nodes of the IR.

An expression has a type, no effect and no order; it may be computed once, twice or never. A
statement has an order and no value. Nodes never change: a pass returns new nodes. Expressions are
interned (``distal.ir.interning``): equal expressions are the same object, and dictionaries keyed by
them are cheap.

Every statement carries the span it came from. An expression's span is the first place an equal
expression was seen, perhaps elsewhere; use it only to narrow the statement's span (``span_in``).

Names of locals are unique within a function: a name is bound once, by a parameter, Let, Var or For.
A read of a local is in the block of its binding or deeper. Whatever the author's language leaves
implicit is explicit here (a float added to a vec3 is a Splat): backends never guess.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from enum import Enum
from typing import Any, ClassVar, Final, TypeAlias

from distal.diagnostics import Span
from distal.ir.interning import Interned, discriminate_number
from distal.ir.types import Type

FRAME_TIME: Final = "frame.time"


class UnaryOp(Enum):
    """NEGATE: float and int, vectors, matrices (uint wraps). NOT: bool, bvec. INVERT: int, uint."""

    __hash__ = object.__hash__  # Enum's own is a Python call, paid for every node

    NEGATE = "-"
    NOT = "not"
    INVERT = "~"


class BinaryOp(Enum):
    """Both operands and the result have one type, component by component. Value: its spelling.

    ADD SUB MUL: numbers (ints wrap at 32 bits); ADD SUB also matrices; MUL and DIV of a matrix
    only by a Splat of the matrix type. DIV: floats only. FLOOR_DIV and MOD: floored, numbers;
    for ints x // 0 = x and x % 0 = 0. AND OR XOR: ints, and bools without short circuit.
    SHL SHR: ints, the count taken & 31; SHR keeps an int's sign. The two operands of a shift
    have the same type.
    """

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
    """Scalars give bool, vectors give bvec component by component. Bools take EQ and NE only."""

    __hash__ = object.__hash__

    EQ = "=="
    NE = "!="
    LT = "<"
    LE = "<="
    GT = ">"
    GE = ">="


class LogicalOp(Enum):
    """Short-circuit, on scalars of bool; since nothing has an effect, only cost differs."""

    __hash__ = object.__hash__

    AND = "and"
    OR = "or"


@dataclass(frozen=True, slots=True, eq=False, weakref_slot=True)
class Const(metaclass=Interned):
    """A scalar literal: bool, int (of INT or UINT, within 32 bits) or finite float."""

    discriminate: ClassVar = staticmethod(discriminate_number)

    value: bool | int | float
    type: Type
    span: Span | None = field(default=None, repr=False, kw_only=True)


@dataclass(frozen=True, slots=True, eq=False, weakref_slot=True)
class Read(metaclass=Interned):
    """The value of a parameter or local."""

    name: str
    type: Type
    span: Span | None = field(default=None, repr=False, kw_only=True)


@dataclass(frozen=True, slots=True, eq=False, weakref_slot=True)
class Uniform(metaclass=Interned):
    """The value of a module's uniform: one for the whole picture (``Module.uniforms``).

    Before the entry pass one called ``FRAME_TIME`` is the frame's time, declared nowhere.
    """

    name: str
    type: Type
    span: Span | None = field(default=None, repr=False, kw_only=True)


@dataclass(frozen=True, slots=True, eq=False, weakref_slot=True)
class PerFrame(metaclass=Interned):
    """A value the per-frame part computed (``Module.frame``); made by the frequency pass."""

    name: str
    type: Type
    span: Span | None = field(default=None, repr=False, kw_only=True)


@dataclass(frozen=True, slots=True, eq=False, weakref_slot=True)
class Resource(metaclass=Interned):
    """A texture or buffer of ``Module.resources``, by name."""

    name: str
    type: Type
    span: Span | None = field(default=None, repr=False, kw_only=True)


@dataclass(frozen=True, slots=True, eq=False, weakref_slot=True)
class FunctionRef(metaclass=Interned):
    """A module function as a value, its last parameters bound to ``captures``.

    ``type`` is the FunctionType of the parameters that remain. Gone after specialise.
    """

    name: str
    captures: tuple[Expr, ...]
    type: Type
    span: Span | None = field(default=None, repr=False, kw_only=True)


@dataclass(frozen=True, slots=True, eq=False, weakref_slot=True)
class Unary(metaclass=Interned):
    """``op operand``, of the operand's type."""

    op: UnaryOp
    operand: Expr
    type: Type
    span: Span | None = field(default=None, repr=False, kw_only=True)


@dataclass(frozen=True, slots=True, eq=False, weakref_slot=True)
class Binary(metaclass=Interned):
    """``lhs op rhs``; both sides already have this node's type."""

    op: BinaryOp
    lhs: Expr
    rhs: Expr
    type: Type
    span: Span | None = field(default=None, repr=False, kw_only=True)


@dataclass(frozen=True, slots=True, eq=False, weakref_slot=True)
class MatMul(metaclass=Interned):
    """``lhs @ rhs``: matrix @ matrix, matrix @ vector (column), vector (row) @ matrix."""

    lhs: Expr
    rhs: Expr
    type: Type
    span: Span | None = field(default=None, repr=False, kw_only=True)


@dataclass(frozen=True, slots=True, eq=False, weakref_slot=True)
class Compare(metaclass=Interned):
    """``lhs op rhs``; both sides have one type, the result is bool or a bvec."""

    op: CompareOp
    lhs: Expr
    rhs: Expr
    type: Type
    span: Span | None = field(default=None, repr=False, kw_only=True)


@dataclass(frozen=True, slots=True, eq=False, weakref_slot=True)
class Logical(metaclass=Interned):
    """``lhs and rhs``, ``lhs or rhs``."""

    op: LogicalOp
    lhs: Expr
    rhs: Expr
    type: Type
    span: Span | None = field(default=None, repr=False, kw_only=True)


@dataclass(frozen=True, slots=True, eq=False, weakref_slot=True)
class Select(metaclass=Interned):
    """``yes if condition else no``. A bvec condition picks component by component.

    With a bool condition any value type is picked whole.
    """

    condition: Expr
    yes: Expr
    no: Expr
    type: Type
    span: Span | None = field(default=None, repr=False, kw_only=True)


@dataclass(frozen=True, slots=True, eq=False, weakref_slot=True)
class Splat(metaclass=Interned):
    """A scalar repeated into every component of a vector or (for MUL and DIV) a matrix."""

    value: Expr
    type: Type
    span: Span | None = field(default=None, repr=False, kw_only=True)


@dataclass(frozen=True, slots=True, eq=False, weakref_slot=True)
class Compose(metaclass=Interned):
    """A vector from scalars and vectors of its kind, or a matrix from its columns."""

    parts: tuple[Expr, ...]
    type: Type
    span: Span | None = field(default=None, repr=False, kw_only=True)


@dataclass(frozen=True, slots=True, eq=False, weakref_slot=True)
class Swizzle(metaclass=Interned):
    """Components of a vector picked by letters of ``xyzw``: ``base.xz``; one letter: a scalar."""

    base: Expr
    lanes: str
    type: Type
    span: Span | None = field(default=None, repr=False, kw_only=True)


@dataclass(frozen=True, slots=True, eq=False, weakref_slot=True)
class Index(metaclass=Interned):
    """``base[index]`` of an array, vector, matrix (a column) or buffer; the index is an int.

    Every index is clamped into range in meaning. The bounds pass makes that explicit where it
    cannot prove it; after it an index is in range (buffers stay clamped by the backend).
    """

    base: Expr
    index: Expr
    type: Type
    span: Span | None = field(default=None, repr=False, kw_only=True)


@dataclass(frozen=True, slots=True, eq=False, weakref_slot=True)
class Field(metaclass=Interned):
    """``base.name`` of a struct."""

    base: Expr
    name: str
    type: Type
    span: Span | None = field(default=None, repr=False, kw_only=True)


@dataclass(frozen=True, slots=True, eq=False, weakref_slot=True)
class Construct(metaclass=Interned):
    """A struct from its fields in order, or an array from its elements."""

    parts: tuple[Expr, ...]
    type: Type
    span: Span | None = field(default=None, repr=False, kw_only=True)


@dataclass(frozen=True, slots=True, eq=False, weakref_slot=True)
class Cast(metaclass=Interned):
    """A scalar or vector with its components converted.

    float to int or uint truncates, saturates, NaN gives 0; int and uint keep their bits; bool is
    0 or 1; anything to bool is ``!= 0``.
    """

    value: Expr
    type: Type
    span: Span | None = field(default=None, repr=False, kw_only=True)


@dataclass(frozen=True, slots=True, eq=False, weakref_slot=True)
class Builtin(metaclass=Interned):
    """A call of an intrinsic of ``distal.ir.intrinsics``."""

    name: str
    args: tuple[Expr, ...]
    type: Type
    span: Span | None = field(default=None, repr=False, kw_only=True)


@dataclass(frozen=True, slots=True, eq=False, weakref_slot=True)
class Call(metaclass=Interned):
    """A call of a module function. Functions have no effects."""

    function: str
    args: tuple[Expr, ...]
    type: Type
    span: Span | None = field(default=None, repr=False, kw_only=True)


@dataclass(frozen=True, slots=True, eq=False, weakref_slot=True)
class Apply(metaclass=Interned):
    """A call of a function value (a Read of FunctionType, a FunctionRef). Gone after specialise."""

    function: Expr
    args: tuple[Expr, ...]
    type: Type
    span: Span | None = field(default=None, repr=False, kw_only=True)


@dataclass(frozen=True, slots=True, eq=False, weakref_slot=True)
class Gradient(metaclass=Interned):
    """The exact derivative of a float-valued function value at ``point`` (float, vec2-4).

    ``type`` is the point's type; with ``with_value`` it is the tuple (float, gradient), from one
    evaluation. Gone after the gradient pass.
    """

    function: Expr
    point: Expr
    with_value: bool
    type: Type
    span: Span | None = field(default=None, repr=False, kw_only=True)


@dataclass(frozen=True, slots=True, eq=False, weakref_slot=True)
class Sample(metaclass=Interned):
    """A filtered texture value, vec4. No mip maps: every target reads level 0.

    2D: (0, 0) is the lower left corner of the picture, (1, 1) the upper right. Linear filter,
    wrapping as the texture was declared. Cube: a direction. 3D: (0,0,0) to (1,1,1).
    """

    texture: Expr
    coord: Expr
    type: Type
    span: Span | None = field(default=None, repr=False, kw_only=True)


@dataclass(frozen=True, slots=True, eq=False, weakref_slot=True)
class Texel(metaclass=Interned):
    """One unfiltered texel, vec4, at an ivec2 (2D) or ivec3 (3D; cube: x, y, face); clamped."""

    texture: Expr
    index: Expr
    type: Type
    span: Span | None = field(default=None, repr=False, kw_only=True)


@dataclass(frozen=True, slots=True, eq=False, weakref_slot=True)
class Size(metaclass=Interned):
    """ivec2 (2D, cube) or ivec3 (3D) of a texture in texels, int count of a buffer."""

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


@dataclass(frozen=True, slots=True)
class Let:
    """Bind a local for good."""

    name: str
    value: Expr
    span: Span | None = field(default=None, repr=False, kw_only=True)


@dataclass(frozen=True, slots=True)
class Var:
    """Bind a local that Assign may change."""

    name: str
    value: Expr
    span: Span | None = field(default=None, repr=False, kw_only=True)


@dataclass(frozen=True, slots=True)
class Assign:
    """Change a Var or a part of it.

    ``target`` is a Read of the Var, or a Swizzle (no letter twice), Index or Field of a target.
    """

    target: Expr
    value: Expr
    span: Span | None = field(default=None, repr=False, kw_only=True)


@dataclass(frozen=True, slots=True)
class If:
    """Run one of two blocks."""

    condition: Expr
    then: tuple[Stmt, ...]
    otherwise: tuple[Stmt, ...]
    span: Span | None = field(default=None, repr=False, kw_only=True)


@dataclass(frozen=True, slots=True)
class For:
    """``for name in range(start, stop, step)``: a real loop with a step.

    ``start`` and ``stop`` are computed once, before. ``name`` is a read-only int, alive in the
    body only; ``step`` is not 0. The count never overflows: the loop ends at the int range.
    """

    name: str
    start: Expr
    stop: Expr
    step: int
    body: tuple[Stmt, ...]
    span: Span | None = field(default=None, repr=False, kw_only=True)


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
    """Go on with the innermost loop's next round."""

    span: Span | None = field(default=None, repr=False, kw_only=True)


@dataclass(frozen=True, slots=True)
class Return:
    """Leave the function with a value."""

    value: Expr
    span: Span | None = field(default=None, repr=False, kw_only=True)


Stmt: TypeAlias = Let | Var | Assign | If | For | While | Break | Continue | Return


@dataclass(frozen=True, slots=True)
class Param:
    """A parameter of a function: read-only in the body."""

    name: str
    type: Type


@dataclass(frozen=True, slots=True)
class Function:
    """A function. Every path ends in Return (or in a ``while True`` that never ends).

    ``name`` is unique in the module; ``source_name`` is what the author called it. ``native`` is
    the built-in that the function replaces on a rough target, of the same arguments: a text
    may let its host choose the driver's own. ``apart`` is a piece of a longer function, which a
    backend must not put together again.
    """

    name: str
    params: tuple[Param, ...]
    result: Type
    body: tuple[Stmt, ...]
    source_name: str
    native: str | None = field(default=None, kw_only=True)
    apart: bool = field(default=False, kw_only=True)
    span: Span | None = field(default=None, repr=False, kw_only=True)


class Origin(Enum):
    """Where a uniform's value comes from."""

    FRAME = "frame"  # resolution, time, mouse, index, seed
    PARAMETER = "parameter"  # a slider or the like
    NUMBER = "number"  # a number of a scene's shapes: its default, which is no part of the code


@dataclass(frozen=True, slots=True)
class UniformDeclaration:
    """One uniform of a module.

    ``default`` is a bool, int, float or a tuple of floats. ``interface`` holds what the JSON
    interface says of a parameter besides (label, kind, low, high, step, log, group, help, options).
    ``source`` is the author's parameter, which checks values.
    """

    name: str
    type: Type
    origin: Origin
    default: Any
    interface: tuple[tuple[str, Any], ...] = ()
    source: Any = field(default=None, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class ResourceDeclaration:
    """One texture or buffer of a module; ``source`` is the author's object that has its data.

    ``wrap`` is "repeat" or "clamp" (textures). ``values`` are the elements of a buffer that the
    compiler made of the program's own tables; the host has no data for it.
    """

    name: str
    type: Type
    source: Any = field(compare=False, repr=False)
    wrap: str = "repeat"
    values: tuple[Any, ...] | None = field(default=None, repr=False)


class EntryKind(Enum):
    """How the entry function is run."""

    IMAGE = "image"  # an @image: after the entry pass, main(coord: vec2) -> vec4, per pixel
    FUNCTION = "function"  # a @func: over arrays of its parameters


@dataclass(frozen=True, slots=True)
class Module:
    """Everything one compilation needs.

    Attributes:
        functions: A callee stands before its callers; no recursion. Only what is reachable.
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
        """The function of that name."""
        return next(f for f in self.functions if f.name == name)


def span_in(stmt_span: Span | None, expr: Expr) -> Span | None:
    """The best span for a diagnostic about ``expr`` inside a statement with ``stmt_span``."""
    inner = expr.span
    if stmt_span is None or inner is None or inner.file != stmt_span.file:
        return stmt_span or inner
    last = max(stmt_span.end_line, stmt_span.line)
    return inner if stmt_span.line <= inner.line <= last else stmt_span
