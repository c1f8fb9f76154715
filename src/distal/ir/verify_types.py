"""Check the types of each node's operands: the rules in the docstrings of ``nodes``, as assertions.

Input: one expression node whose operands were already checked. Raises an AssertionError if a rule
is broken. Does not depend on names and scopes.
"""

from __future__ import annotations

import math
from typing import Final, assert_never

from distal.ir.build import element_type
from distal.ir.intrinsics import INTRINSICS
from distal.ir.nodes import (
    Apply,
    Binary,
    BinaryOp,
    Builtin,
    Call,
    Cast,
    Compare,
    CompareOp,
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
    UnaryOp,
    Uniform,
)
from distal.ir.types import (
    BOOL,
    FLOAT,
    INT,
    IVEC2,
    IVEC3,
    UINT,
    VEC2,
    VEC3,
    VEC4,
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
    is_static,
    kind_of,
    tuple_type,
    vector_of,
    with_kind,
)

_NUMBER: Final = frozenset((Kind.FLOAT, Kind.INT, Kind.UINT))
_WHOLE: Final = frozenset((Kind.INT, Kind.UINT))

_BINARY_KINDS: Final = {
    BinaryOp.ADD: _NUMBER,
    BinaryOp.SUB: _NUMBER,
    BinaryOp.MUL: _NUMBER,
    BinaryOp.DIV: frozenset((Kind.FLOAT,)),
    BinaryOp.FLOOR_DIV: _NUMBER,
    BinaryOp.MOD: _NUMBER,
    BinaryOp.AND: _WHOLE | {Kind.BOOL},
    BinaryOp.OR: _WHOLE | {Kind.BOOL},
    BinaryOp.XOR: _WHOLE | {Kind.BOOL},
    BinaryOp.SHL: _WHOLE,
    BinaryOp.SHR: _WHOLE,
}

_UNARY_KINDS: Final = {
    UnaryOp.NEGATE: _NUMBER,
    UnaryOp.NOT: frozenset((Kind.BOOL,)),
    UnaryOp.INVERT: _WHOLE,
}

_COORDINATE: Final = {
    TextureShape.FLAT: VEC2,
    TextureShape.CUBE: VEC3,
    TextureShape.VOLUME: VEC3,
}
_TEXEL_INDEX: Final = {
    TextureShape.FLAT: IVEC2,
    TextureShape.CUBE: IVEC3,
    TextureShape.VOLUME: IVEC3,
}
_SIZE: Final = {
    TextureShape.FLAT: IVEC2,
    TextureShape.CUBE: IVEC2,
    TextureShape.VOLUME: IVEC3,
}


def check_types(e: Expr) -> None:
    """Check that the type of ``e`` matches the types of its operands.

    Raises:
        AssertionError: The types do not match.
    """
    match e:
        case Const(value, type):
            _constant(value, type)
        case Read() | Uniform() | PerFrame() | Resource() | Call() | FunctionRef():
            pass  # their types are checked against declarations, in ``verify``
        case Unary(op, operand, type):
            assert operand.type is type and kind_of(type) in _UNARY_KINDS[op], operand.type
            assert not isinstance(type, Matrix) or op is UnaryOp.NEGATE, "matrix"
        case Binary(op, lhs, rhs, type):
            assert lhs.type is rhs.type is type, f"{lhs.type} {op.value} {rhs.type}"
            assert kind_of(type) in _BINARY_KINDS[op], f"{op.value} of {type}"
            _matrix_binary(op, lhs, rhs)
        case MatMul(lhs, rhs, type):
            _matrix_product(lhs.type, rhs.type, type)
        case Compare(op, lhs, rhs, type):
            assert lhs.type is rhs.type, f"{lhs.type} {op.value} {rhs.type}"
            assert isinstance(lhs.type, Scalar | Vector), f"{op.value} of {lhs.type}"
            assert type is with_kind(lhs.type, Kind.BOOL), "wrong result type"
            equality = op in (CompareOp.EQ, CompareOp.NE)
            assert equality or lhs.type.kind is not Kind.BOOL, f"{op.value} of bools"
        case Logical(_, lhs, rhs, type):
            assert lhs.type is rhs.type is type is BOOL, f"{lhs.type}, {rhs.type}"
        case Select(condition, yes, no, type):
            assert yes.type is no.type is type, f"{yes.type} or {no.type}"
            _condition(condition.type, type)
        case Splat(value, type):
            assert isinstance(type, Vector | Matrix), "neither vector nor matrix"
            assert isinstance(value.type, Scalar) and value.type.kind is kind_of(type), value.type
        case Compose(parts, type):
            _composition(parts, type)
        case Swizzle(base, lanes, type):
            assert isinstance(base.type, Vector), base.type
            assert lanes and set(lanes) <= set("xyzw"[: base.type.size]), lanes
            assert len(lanes) <= 4 and type is vector_of(base.type.kind, len(lanes)), lanes
        case Index(base, index, type):
            assert index.type is INT, f"index of type {index.type}"
            assert element_type(base.type) is type, f"element of {base.type}"
        case Field(base, name, type):
            assert isinstance(base.type, Struct), base.type
            assert base.type.field(name) is type, f"{base.type} has no such {name}"
        case Construct(parts, type):
            _construction(parts, type)
        case Cast(value, type):
            assert isinstance(type, Scalar | Vector), "neither scalar nor vector"
            assert isinstance(value.type, Scalar | Vector), value.type
            assert component_count(value.type) == component_count(type), value.type
            assert value.type is not type, "no conversion"
        case Builtin(name, args, type):
            _builtin(name, args, type)
        case Apply(function, args, type):
            called = function.type
            assert isinstance(called, FunctionType), called
            assert called.params == tuple(a.type for a in args), called
            assert called.result is type, called
        case Gradient(function, point, with_value, type):
            assert point.type in (FLOAT, VEC2, VEC3, VEC4), point.type
            assert function.type is FunctionType((point.type,), FLOAT), function.type
            wanted = tuple_type((FLOAT, point.type)) if with_value else point.type
            assert type is wanted, wanted
        case Sample(texture, coord, type):
            assert isinstance(texture.type, Texture) and type is VEC4, texture.type
            assert coord.type is _COORDINATE[texture.type.shape], coord.type
        case Texel(texture, index, type):
            assert isinstance(texture.type, Texture) and type is VEC4, texture.type
            assert index.type is _TEXEL_INDEX[texture.type.shape], index.type
        case Size(resource, type):
            if isinstance(resource.type, Buffer):
                assert type is INT, "size of a buffer"
            else:
                assert isinstance(resource.type, Texture), resource.type
                assert type is _SIZE[resource.type.shape], "size of a texture"
        case _:
            assert_never(e)


def _constant(value: bool | int | float, type: Type) -> None:
    if type is BOOL:
        assert isinstance(value, bool), repr(value)
    elif type is INT:
        assert isinstance(value, int) and not isinstance(value, bool), repr(value)
        assert -(2**31) <= value < 2**31, value
    elif type is UINT:
        assert isinstance(value, int) and not isinstance(value, bool), repr(value)
        assert 0 <= value < 2**32, value
    else:
        assert type is FLOAT and isinstance(value, float) and math.isfinite(value), repr(value)


def _matrix_binary(op: BinaryOp, lhs: Expr, rhs: Expr) -> None:
    if not isinstance(lhs.type, Matrix):
        return
    if op in (BinaryOp.ADD, BinaryOp.SUB):
        return
    assert op in (BinaryOp.MUL, BinaryOp.DIV), f"{op.value} of matrices"
    left = op is BinaryOp.MUL and isinstance(lhs, Splat)
    assert left or isinstance(rhs, Splat), f"{op.value} of two matrices"


def _matrix_product(lhs: Type, rhs: Type, result: Type) -> None:
    match lhs, rhs:
        case Matrix(left), Matrix(right):
            assert left == right and result is lhs, f"{lhs} @ {rhs}"
        case Matrix(left), Vector(Kind.FLOAT, right):
            assert left == right and result is rhs, f"{lhs} @ {rhs}"
        case Vector(Kind.FLOAT, left), Matrix(right):
            assert left == right and result is lhs, f"{lhs} @ {rhs}"
        case _:
            raise AssertionError(f"{lhs} @ {rhs}")


def _condition(condition: Type, type: Type) -> None:
    if condition is BOOL:
        return
    assert isinstance(condition, Vector) and condition.kind is Kind.BOOL, condition
    assert isinstance(type, Vector) and type.size == condition.size, f"{condition} for {type}"


def _composition(parts: tuple[Expr, ...], type: Type) -> None:
    types = [p.type for p in parts]
    match type:
        case Vector(kind, size):
            assert all(isinstance(t, Scalar | Vector) and t.kind is kind for t in types), types
            assert sum(map(component_count, types)) == size, types
        case Matrix(size):
            assert types == [Vector(Kind.FLOAT, size)] * size, types
        case _:
            raise AssertionError("neither vector nor matrix")


def _construction(parts: tuple[Expr, ...], type: Type) -> None:
    types = [p.type for p in parts]
    match type:
        case Struct(_, fields):
            assert types == [t for _, t in fields], types
        case Array(element, length):
            assert length >= 1 and types == [element] * length, types
        case _:
            raise AssertionError("neither struct nor array")
    assert not any(map(is_static, types)), types


def _builtin(name: str, args: tuple[Expr, ...], type: Type) -> None:
    assert name in INTRINSICS, f"no intrinsic {name}"
    types = [a.type for a in args]
    found = [s.match(types) for s in INTRINSICS[name].signatures]
    assert type in found, f"{name} of {', '.join(map(str, types))}"
