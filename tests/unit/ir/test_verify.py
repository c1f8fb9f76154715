"""The verifier refuses what breaks a rule; each case breaks one rule of a module that holds."""

from dataclasses import replace

import pytest

from distal.ir.build import add, boolean, builtin, integer, negate, number, read
from distal.ir.nodes import (
    Apply,
    Assign,
    Binary,
    BinaryOp,
    Break,
    Builtin,
    Call,
    Cast,
    Compare,
    CompareOp,
    Compose,
    Const,
    Construct,
    EntryKind,
    Field,
    For,
    Function,
    FunctionRef,
    Gradient,
    If,
    Index,
    Let,
    Logical,
    LogicalOp,
    MatMul,
    Module,
    Origin,
    Param,
    PerFrame,
    Read,
    Resource,
    Return,
    Sample,
    Select,
    Size,
    Splat,
    Swizzle,
    Unary,
    UnaryOp,
    Uniform,
    UniformDeclaration,
    Var,
    While,
)
from distal.ir.types import (
    BOOL,
    BVEC2,
    FLOAT,
    FRAME,
    INT,
    MAT2,
    MAT3,
    TEXTURE_2D,
    UINT,
    VEC2,
    VEC3,
    VEC4,
    Array,
    FunctionType,
    Struct,
)
from distal.ir.verify import Verifier, verify

X = read("x", FLOAT)
P = read("p", VEC3)
V = read("v", FLOAT)
PAIR = Compare(CompareOp.LT, Splat(X, VEC2), Splat(X, VEC2), BVEC2)
HIT = Struct("Hit", (("distance", FLOAT),), False)
FIELD = FunctionType((VEC3,), FLOAT)


def function(*body, name="f", result=FLOAT, params=()):
    every = (Param("x", FLOAT), Param("p", VEC3), *params)
    return Function(name, every, result, body, name)


def module(*functions):
    return Module(functions, functions[-1].name, EntryKind.FUNCTION)


SPHERE = Function("sphere", (Param("p", VEC3),), FLOAT, (Return(builtin("length", P)),), "sphere")


def test_a_rich_module_holds():
    body = (
        Var("v", X),
        For("i", integer(0), integer(3), 1, (Assign(V, add(V, Call("sphere", (P,), FLOAT))),)),
        While(boolean(True), (If(Compare(CompareOp.LT, V, X, BOOL), (Return(V),), (Break(),)),)),
        Var("w", P),
        Assign(Swizzle(read("w", VEC3), "zx", VEC2), Splat(V, VEC2)),
        If(boolean(True), (Return(V),), (Return(X),)),
    )
    verify(module(SPHERE, function(*body)), "bounds")


BAD_EXPRESSIONS = {
    "bool is no int": Const(True, INT),
    "out of range": Const(2**31, INT),
    "uint is not negative": Const(-1, UINT),
    "not finite": Const(float("inf"), FLOAT),
    "unknown name": read("y", FLOAT),
    "read at another type": read("x", INT),
    "mixed types": Binary(BinaryOp.ADD, X, P, VEC3),
    "divided ints": Binary(BinaryOp.DIV, integer(1), integer(2), INT),
    "shifted float": Binary(BinaryOp.SHL, X, X, FLOAT),
    "multiplied matrices": Binary(BinaryOp.MUL, *(Splat(X, MAT2),) * 2, VEC2),
    "not of a float": Unary(UnaryOp.NOT, X, FLOAT),
    "compared bools": Compare(CompareOp.LT, boolean(True), boolean(True), BOOL),
    "compared to float": Compare(CompareOp.LT, X, X, FLOAT),
    "and of floats": Logical(LogicalOp.AND, X, X, BOOL),
    "picked by a short bvec": Select(PAIR, P, P, VEC3),
    "picked from two types": Select(boolean(True), X, P, VEC3),
    "splat of a vector": Splat(P, VEC3),
    "splat of an int": Splat(integer(1), VEC3),
    "too few components": Compose((X, X), VEC3),
    "matrix of short columns": Compose((P, P), MAT2),
    "no such lane": Swizzle(P, "w", FLOAT),
    "wrong lane count": Swizzle(P, "xy", VEC3),
    "indexed by a float": Index(P, X, FLOAT),
    "no such field": Field(Construct((X,), HIT), "material", FLOAT),
    "struct of other parts": Construct((P,), HIT),
    "array of another length": Construct((X,), Array(FLOAT, 2)),
    "cast of another size": Cast(P, INT),
    "cast to itself": Cast(X, FLOAT),
    "unknown row": Builtin("lenght", (P,), FLOAT),
    "row of other types": Builtin("length", (X,), FLOAT),
    "unknown function": Call("cube", (P,), FLOAT),
    "called with other types": Call("sphere", (X,), FLOAT),
    "called for another type": Call("sphere", (P,), VEC3),
    "calls itself": Call("f", (X, P), FLOAT),
    "unknown uniform": Uniform("time", FLOAT),
    "unknown frame value": PerFrame("frame_0", FLOAT),
    "unknown texture": Sample(Resource("photo", TEXTURE_2D), Splat(X, VEC2), VEC4),
    "size of a number": Size(X, INT),
    "unlike matrices": MatMul(Splat(X, MAT2), Splat(X, MAT3), MAT3),
    "gradient of another point": Gradient(FunctionRef("sphere", (), FIELD), X, False, FLOAT),
    "reference of another type": FunctionRef("sphere", (X,), FIELD),
}  # fmt: skip


@pytest.mark.parametrize("e", BAD_EXPRESSIONS.values(), ids=BAD_EXPRESSIONS)
def test_a_bad_expression_is_found(e):
    with pytest.raises(AssertionError):
        verify(module(SPHERE, function(Let("bad", e), Return(X))))


def too_deep():
    e = X
    for _ in range(201):
        e = negate(e)
    return e


BAD_BODIES = {
    "no return": (Let("a", X),),
    "one branch returns": (If(boolean(True), (Return(X),), ()),),
    "loop that may end": (While(boolean(True), (If(boolean(True), (Break(),), ()),)),),
    "bound twice": (Let("a", X), Let("a", X), Return(X)),
    "bound in two blocks": (If(boolean(True), (Let("a", X),), (Let("a", X),)), Return(X)),
    "read outside its block": (If(boolean(True), (Let("a", X),), ()), Return(read("a", FLOAT))),
    "counter after the loop": (
        For("i", integer(0), integer(1), 1, ()),
        Return(Cast(read("i", INT), FLOAT)),
    ),
    "assigned parameter": (Assign(X, X), Return(X)),
    "assigned let": (Let("a", X), Assign(read("a", FLOAT), X), Return(X)),
    "assigned twice over": (
        Var("a", P),
        Assign(Swizzle(read("a", VEC3), "xx", VEC2), Splat(X, VEC2)),
        Return(X),
    ),
    "assigned another type": (Var("a", X), Assign(read("a", FLOAT), integer(1)), Return(X)),
    "assigned a value": (Var("a", X), Assign(add(X, X), X), Return(X)),
    "break outside": (Break(), Return(X)),
    "float condition": (If(X, (), ()), Return(X)),
    "float range": (For("i", X, integer(1), 1, ()), Return(X)),
    "no step": (For("i", integer(0), integer(1), 0, ()), Return(X)),
    "another result": (Return(P),),
    "too deep": (Return(too_deep()),),
}


@pytest.mark.parametrize("body", BAD_BODIES.values(), ids=BAD_BODIES)
def test_a_bad_body_is_found(body):
    with pytest.raises(AssertionError):
        verify(module(function(*body)))


def test_functions_stand_once_and_before_their_callers():
    f = function(Return(Call("sphere", (P,), FLOAT)))
    verify(module(SPHERE, f))
    for functions in ((f, SPHERE), (SPHERE, SPHERE, f)):
        with pytest.raises(AssertionError):
            verify(replace(module(*functions), entry="f"))


STAGES = {
    "frame": ("entry", function(Return(X), params=(Param("frame", FRAME),))),
    "field": ("specialise", function(Return(X), params=(Param("field", FIELD),))),
    "apply": (
        "specialise",
        function(Return(Apply(FunctionRef("sphere", (), FIELD), (P,), FLOAT))),
    ),
    "gradient": (
        "gradient",
        function(Return(Gradient(FunctionRef("sphere", (), FIELD), P, False, VEC3)), result=VEC3),
    ),
    "texture": ("bounds", function(Return(X), params=(Param("photo", TEXTURE_2D),))),
    "index": ("bounds", function(Return(Index(P, integer(3), FLOAT)))),
}


@pytest.mark.parametrize(("stage", "fn"), STAGES.values(), ids=STAGES)
def test_what_a_pass_promises_is_held(stage, fn):
    verify(module(SPHERE, fn))
    with pytest.raises(AssertionError):
        verify(module(SPHERE, fn), stage)
    verify(module(SPHERE, function(Return(number(1.0)))), stage)


def test_the_entry_of_an_image_takes_coord():
    main = Function("main", (Param("coord", VEC2),), VEC4, (Return(Splat(X, VEC4)),), "main")
    main = replace(main, body=(Return(Splat(Swizzle(Read("coord", VEC2), "x", FLOAT), VEC4)),))
    image = replace(module(main), kind=EntryKind.IMAGE)
    verify(image, "entry")
    with pytest.raises(AssertionError):
        verify(replace(image, functions=(replace(main, params=()),)), "entry")


def test_a_verifier_checks_again_what_has_changed_around_a_function() -> None:
    """The same function object, with other uniforms, callees or rules around it."""
    size = UniformDeclaration("size", FLOAT, Origin.NUMBER, 1.0)
    value = builtin("max", Uniform("size", FLOAT), Call("sphere", (P,), FLOAT))
    caller = function(Return(value))
    sound = replace(module(SPHERE, caller), uniforms=(size,))
    verifier = Verifier()
    verifier.verify(sound, "fold")
    verifier.verify(sound, "inline")
    for broken in (
        replace(sound, uniforms=()),
        replace(sound, uniforms=(replace(size, type=INT, default=1),)),
        replace(sound, functions=(caller,)),
        replace(sound, functions=(replace(SPHERE, params=()), caller)),
        replace(sound, functions=(caller, SPHERE)),
        replace(sound, frame=(("unread", number(1.0)),)),
    ):
        with pytest.raises(AssertionError):
            verifier.verify(broken, "inline")
        verifier.verify(sound, "inline")
    early = replace(sound, functions=(SPHERE, function(Return(PerFrame("f", FLOAT)))))
    early = replace(early, frame=(("f", number(1.0)),))
    verifier.verify(early)
    with pytest.raises(AssertionError, match="before the frequency pass"):
        verifier.verify(early, "fold")


def test_a_verifier_checks_the_order_of_per_frame_values() -> None:
    first, second = ("a", number(1.0)), ("b", PerFrame("a", FLOAT))
    reads = function(Return(PerFrame("b", FLOAT)))
    verifier = Verifier()
    verifier.verify(replace(module(reads), frame=(first, second)), "frequency")
    with pytest.raises(AssertionError, match="no such per-frame value"):
        verifier.verify(replace(module(reads), frame=(second, first)), "frequency")
