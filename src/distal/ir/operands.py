"""The operands of every node class, and how to build a node with others.

The only module, with ``distal.ir.nodes``, that knows the fields of all node classes. Tables instead
of match statements: passes look nodes up many times, and testing one class after another took a
third of their time.
"""

from __future__ import annotations

from collections.abc import Callable
from operator import attrgetter
from typing import Any, Final, get_args

from distal.ir.nodes import (
    Apply,
    Binary,
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

_Operands = tuple[Expr, ...]

_LEAVES: Final = (Const, Read, Uniform, PerFrame, Resource)


def _none(e: Any) -> _Operands:
    return ()


OPERANDS: Final[dict[type, Callable[[Any], _Operands]]] = {
    **dict.fromkeys(_LEAVES, _none),
    **dict.fromkeys((Binary, Compare, Logical, MatMul), attrgetter("lhs", "rhs")),
    FunctionRef: attrgetter("captures"),
    Unary: lambda e: (e.operand,),
    Select: attrgetter("condition", "yes", "no"),
    Splat: lambda e: (e.value,),
    Cast: lambda e: (e.value,),
    Compose: attrgetter("parts"),
    Construct: attrgetter("parts"),
    Swizzle: lambda e: (e.base,),
    Field: lambda e: (e.base,),
    Index: attrgetter("base", "index"),
    Builtin: attrgetter("args"),
    Call: attrgetter("args"),
    Apply: lambda e: (e.function, *e.args),
    Gradient: attrgetter("function", "point"),
    Sample: attrgetter("texture", "coord"),
    Texel: attrgetter("texture", "index"),
    Size: lambda e: (e.resource,),
}

REBUILT: Final[dict[type, Callable[[Any, _Operands], Expr]]] = {
    **dict.fromkeys(_LEAVES, lambda e, o: e),
    FunctionRef: lambda e, o: FunctionRef(e.name, o, e.type, span=e.span),
    Unary: lambda e, o: Unary(e.op, o[0], e.type, span=e.span),
    Binary: lambda e, o: Binary(e.op, o[0], o[1], e.type, span=e.span),
    Compare: lambda e, o: Compare(e.op, o[0], o[1], e.type, span=e.span),
    Logical: lambda e, o: Logical(e.op, o[0], o[1], e.type, span=e.span),
    MatMul: lambda e, o: MatMul(o[0], o[1], e.type, span=e.span),
    Select: lambda e, o: Select(o[0], o[1], o[2], e.type, span=e.span),
    Splat: lambda e, o: Splat(o[0], e.type, span=e.span),
    Cast: lambda e, o: Cast(o[0], e.type, span=e.span),
    Compose: lambda e, o: Compose(o, e.type, span=e.span),
    Construct: lambda e, o: Construct(o, e.type, span=e.span),
    Swizzle: lambda e, o: Swizzle(o[0], e.lanes, e.type, span=e.span),
    Field: lambda e, o: Field(o[0], e.name, e.type, span=e.span),
    Index: lambda e, o: Index(o[0], o[1], e.type, span=e.span),
    Builtin: lambda e, o: Builtin(e.name, o, e.type, span=e.span),
    Call: lambda e, o: Call(e.function, o, e.type, span=e.span),
    Apply: lambda e, o: Apply(o[0], o[1:], e.type, span=e.span),
    Gradient: lambda e, o: Gradient(o[0], o[1], e.with_value, e.type, span=e.span),
    Sample: lambda e, o: Sample(o[0], o[1], e.type, span=e.span),
    Texel: lambda e, o: Texel(o[0], o[1], e.type, span=e.span),
    Size: lambda e, o: Size(o[0], e.type, span=e.span),
}
assert set(OPERANDS) == set(REBUILT) == set(get_args(Expr)), "a node without operands"
