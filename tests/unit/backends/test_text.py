"""How single expressions and programs look, from IR built by hand."""

from __future__ import annotations

import json

import pytest

from distal.backends import emit, get_target, target_names
from distal.ir import build
from distal.ir.nodes import (
    BinaryOp,
    Builtin,
    CompareOp,
    Construct,
    EntryKind,
    Expr,
    For,
    Function,
    Index,
    Let,
    Module,
    Origin,
    Param,
    PerFrame,
    Read,
    Return,
    Uniform,
    UniformDeclaration,
    Var,
)
from distal.ir.types import BOOL, FLOAT, INT, MAT2, VEC2, VEC4, Array, Type
from distal.lang import slider

TEXT_TARGETS = [name for name in target_names() if name not in ("llvm", "numpy")]

a, b, c = (Read(name, FLOAT) for name in "abc")
i, j, k = (Read(name, INT) for name in "ijk")
p, q = (Read(name, BOOL) for name in "pq")
PARAMS = tuple(Param(r.name, r.type) for r in (a, b, c, i, j, k, p, q))


def library(result: Expr, target: str) -> str:
    """The text of a function that returns ``result``."""
    function = Function("f", PARAMS, result.type, (Return(result),), "f")
    return emit(Module((function,), "f", EntryKind.FUNCTION), get_target(target)).text


def returned(result: Expr, target: str) -> str:
    line = next(n for n in library(result, target).splitlines() if "return" in n)
    return line.strip().removeprefix("return ").removesuffix(";")


def bits(op: BinaryOp, lhs: Expr, rhs: Expr) -> Expr:
    return build.binary(op, lhs, rhs)


@pytest.mark.parametrize("target", ["glsl-es300", "wgsl"])
@pytest.mark.parametrize(
    ("expression", "text"),
    [
        (build.subtract(build.subtract(a, b), c), "a - b - c"),
        (build.subtract(a, build.subtract(b, c)), "a - (b - c)"),
        (build.multiply(build.add(a, b), c), "(a + b) * c"),
        (build.divide(a, build.multiply(b, c)), "a / (b * c)"),
        (build.add(a, build.multiply(b, c)), "a + b * c"),
        (build.subtract(a, build.number(-1.0)), "a - (-1.0)"),
        (build.subtract(a, build.negate(b)), "a - (-b)"),
        (build.negate(build.negate(a)), "-(-a)"),
        (build.negate(build.number(-1.0)), "-(-1.0)"),
        (build.negate(build.add(a, b)), "-(a + b)"),
        (build.both(build.both(p, q), p), "p && q && p"),
        (build.either(build.both(p, q), p), "(p && q) || p"),
        (build.both(build.compare(CompareOp.LT, a, b), p), "a < b && p"),
        (build.compare(CompareOp.EQ, build.compare(CompareOp.LT, a, b), p), "(a < b) == p"),
        (build.negation(build.both(p, q)), "!(p && q)"),
        (bits(BinaryOp.AND, bits(BinaryOp.AND, i, j), k), "i & j & k"),
        (bits(BinaryOp.OR, bits(BinaryOp.AND, i, j), k), "(i & j) | k"),
        (bits(BinaryOp.AND, i, build.add(j, k)), "i & (j + k)"),
        (build.subtract(i, build.integer(-(2**31))), "i - (-2147483647 - 1)"),
    ],
)
def test_brackets(expression: Expr, text: str, target: str) -> None:
    assert returned(expression, target) == text


def test_shifts() -> None:
    shifted = bits(BinaryOp.SHL, build.add(i, j), build.integer(3))
    assert returned(shifted, "glsl-es300") == "(i + j) << 3"
    assert returned(shifted, "wgsl") == "(i + j) << 3u"
    counted = bits(BinaryOp.SHR, i, bits(BinaryOp.AND, j, build.integer(31)))
    assert returned(counted, "glsl-es300") == "i >> (j & 31)"
    assert returned(counted, "wgsl") == "i >> u32(j & 31)"
    assert returned(bits(BinaryOp.SHL, i, build.integer(35)), "wgsl") == "i << 3u"


def test_wgsl_brackets_comparisons_among_arguments() -> None:
    less, more = build.compare(CompareOp.LT, a, b), build.compare(CompareOp.GT, a, c)
    chosen = build.select(p, more, less)
    assert returned(chosen, "wgsl") == "select((a < b), (a > c), p)"
    assert returned(chosen, "glsl-es300") == "p ? a > c : a < b"


def test_wgsl_hides_what_it_would_refuse_to_compute() -> None:
    text = library(build.divide(build.number(1.0), build.number(0.0)), "wgsl")
    assert "var<private> constant: f32 = 1.0;" in text
    assert "return constant / 0.0;" in text


def test_names_of_ours_never_hide_the_authors() -> None:
    table = build_table()
    body = (
        Let("table", a),
        Let("constant", b),
        Return(build.add(Index(table, i, FLOAT), build.add(Read("table", FLOAT), b))),
    )
    function = Function("f", PARAMS, FLOAT, body, "f")
    for target in ("glsl-es300", "wgsl"):
        text = emit(Module((function,), "f", EntryKind.FUNCTION), get_target(target)).text
        assert "table[i] + (table_2 + b)" in text


def build_table() -> Expr:
    return Construct((build.number(1.0), build.number(2.0)), Array(FLOAT, 2))


def test_a_loop_that_could_pass_the_end_of_the_ints_is_counted() -> None:
    body = (
        Var("n", build.integer(0)),
        For("at", i, j, 3, ()),
        Return(Read("n", INT)),
    )
    function = Function("f", PARAMS, INT, body, "f")
    text = emit(Module((function,), "f", EntryKind.FUNCTION), get_target("glsl-es300")).text
    assert "for (uint at_round = 0u; at_round < at_rounds; at_round++) {" in text
    safe = Function("f", PARAMS, INT, (For("at", i, j, 1, ()), Return(i)), "f")
    text = emit(Module((safe,), "f", EntryKind.FUNCTION), get_target("glsl-es300")).text
    assert "for (int at = i; at < j; at++) {" in text


def image(result: Expr, **parts: object) -> Module:
    main = Function("main", (Param("coord", VEC2),), VEC4, (Return(result),), "picture")
    return Module((main,), "main", EntryKind.IMAGE, **parts)  # type: ignore[arg-type]


def uniform(name: str, type: Type, default: object, origin: Origin = Origin.PARAMETER) -> object:
    return UniformDeclaration(name, type, origin, default)


@pytest.mark.parametrize("target", TEXT_TARGETS)
def test_interface_is_json(target: str) -> None:
    asked = slider("Filter", 0.5)
    filter_ = UniformDeclaration("filter", FLOAT, Origin.PARAMETER, 0.5, interface=asked.interface)
    value = build.splat(Uniform("filter", FLOAT), VEC4)
    artifact = emit(image(value, uniforms=(filter_,)), get_target(target))
    interface = json.loads(json.dumps(artifact.interface))
    assert interface == artifact.interface
    entry = next(e for e in interface["uniforms"] if e["name"] == "filter")
    assert entry["uniform"] == "filter_"
    assert "filter_" in artifact.text


def test_wgsl_offsets() -> None:
    uniforms = (
        uniform("time", FLOAT, 0.0, Origin.FRAME),
        uniform("on", BOOL, True),
        uniform("turn", MAT2, None),
        uniform("tint", VEC4, (1.0, 1.0, 1.0, 1.0)),
    )
    value = build.multiply(Uniform("tint", VEC4), Uniform("time", FLOAT))
    artifact = emit(image(value, uniforms=uniforms), get_target("wgsl"))
    offsets = {e["name"]: e["offset"] for e in artifact.interface["uniforms"]}
    assert offsets == {"resolution": 0, "time": 8, "on": 12, "turn": 16, "tint": 32}
    assert artifact.interface["tile"]["offset"] == 48
    assert artifact.interface["uniform_buffer"]["size"] == 64


def test_a_library_has_its_per_frame_values_in_place() -> None:
    time = Uniform("time", FLOAT)
    sway = build.builtin("sin", time)
    function = Function("f", (Param("x", FLOAT),), FLOAT, (Return(PerFrame("sway", FLOAT)),), "f")
    module = Module(
        (function,),
        "f",
        EntryKind.FUNCTION,
        (UniformDeclaration("time", FLOAT, Origin.FRAME, 0.0),),
        (),
        (("sway", sway),),
    )
    for name in TEXT_TARGETS:
        text = emit(module, get_target(name)).text
        # wgsl-compute alone has an entry point: a function is called for many points there.
        assert ("main" in text) == (name == "wgsl-compute")
        assert "frame_main" not in text
        assert "sin(" in text


def test_registry() -> None:
    for name in target_names():
        assert get_target(name).name == name
    with pytest.raises(KeyError):
        get_target("metal")


def test_scalars_beside_vectors_stay_scalars() -> None:
    v = Read("v", VEC2)
    function = Function(
        "f",
        (Param("v", VEC2),),
        VEC2,
        (
            Return(
                Builtin(
                    "clamp",
                    (
                        build.multiply(build.number(2.0), v),
                        build.number(0.0, VEC2),
                        build.number(1.0, VEC2),
                    ),
                    VEC2,
                )
            ),
        ),
        "f",
    )
    module = Module((function,), "f", EntryKind.FUNCTION)
    assert "clamp(2.0 * v, 0.0, 1.0)" in emit(module, get_target("glsl-es300")).text
    assert "clamp(2.0 * v, vec2f(0.0), vec2f(1.0))" in emit(module, get_target("wgsl")).text
