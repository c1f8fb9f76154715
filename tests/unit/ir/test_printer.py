"""The printer: readable, complete, and no larger than the graph."""

from dataclasses import replace

from distal.ir.build import add, builtin, multiply, number, read, select, unsigned
from distal.ir.nodes import (
    Call,
    Cast,
    Const,
    EntryKind,
    Expr,
    Function,
    Let,
    Module,
    Origin,
    Param,
    PerFrame,
    Resource,
    ResourceDeclaration,
    Return,
    Sample,
    Uniform,
    UniformDeclaration,
)
from distal.ir.printer import print_expression, print_module
from distal.ir.types import FLOAT, INT, TEXTURE_2D, UINT, VEC2, VEC3, VEC4, Struct

P = read("p", VEC3)
X = read("x", FLOAT)


def module(value: Expr) -> Module:
    f = Function("f", (Param("p", VEC3), Param("x", FLOAT)), value.type, (Return(value),), "f")
    return Module((f,), "f", EntryKind.FUNCTION)


def test_a_module_is_readable():
    sphere = Function(
        "sphere",
        (Param("p", VEC3),),
        FLOAT,
        (
            Let("d", add(builtin("length", P), multiply(Uniform("time", FLOAT), number(-1.5)))),
            Return(read("d", FLOAT)),
        ),
        "ball",
    )
    hit = Struct("Hit", (("distance", FLOAT), ("id", INT)), False)
    whole = replace(
        module(number(0.0)),
        functions=(
            sphere,
            Function("g", (Param("h", hit),), FLOAT, (Return(PerFrame("frame_0", FLOAT)),), "g"),
        ),
        entry="g",
        uniforms=(UniformDeclaration("time", FLOAT, Origin.FRAME, 0.0, (("label", "T"),)),),
        resources=(ResourceDeclaration("photo", TEXTURE_2D, None, "clamp"),),
        frame=(("frame_0", builtin("sin", Uniform("time", FLOAT))),),
    )
    assert print_module(whole) == (
        "entry g function\n"
        "struct Hit(distance: float, id: int)\n"
        "uniform @time: float = 0.0 frame (label='T')\n"
        "resource &photo: Texture2D clamp\n"
        "frame\n"
        "  $frame_0: float = (sin @time)\n"
        "\n"
        "fn sphere(p: vec3) -> float of ball\n"
        "  let d: float = (add (length p) (mul @time -1.5))\n"
        "  return d\n"
        "\n"
        "fn g(h: Hit) -> float\n"
        "  return $frame_0\n"
    )


def test_shared_parts_are_written_once():
    e = add(builtin("length", P), X)
    for _ in range(150):
        e = multiply(e, e)
    assert len(print_module(module(e))) < 10_000


def test_what_means_something_else_reads_otherwise():
    texts = {
        print_expression(e)
        for e in (
            Const(1, INT),
            unsigned(1),
            number(1.0),
            number(-0.0),
            number(0.0),
            Const(True, read("b", FLOAT).type),
            Cast(X, INT),
            Cast(X, UINT),
            Call("sin", (X,), FLOAT),
            builtin("sin", X),
            read("sin", FLOAT),
            Uniform("sin", FLOAT),
            PerFrame("sin", FLOAT),
            Sample(Resource("sin", TEXTURE_2D), read("uv", VEC2), VEC4),
        )
    }
    assert len(texts) == 14


def test_the_same_module_prints_the_same():
    def made() -> str:
        return print_module(module(select(read("c", INT), P, add(P, P))))

    assert made() == made()
