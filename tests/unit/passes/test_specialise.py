import pytest

from distal.diagnostics import CompileError
from distal.ir.build import add, boolean, builtin, compare, multiply, number, read, select
from distal.ir.nodes import (
    Apply,
    Assign,
    Call,
    CompareOp,
    FunctionRef,
    Gradient,
    Let,
    Resource,
    ResourceDeclaration,
    Return,
    Sample,
    Var,
)
from distal.ir.printer import print_module
from distal.ir.types import FLOAT, TEXTURE_2D, VEC2, VEC3, VEC4, FunctionType
from distal.ir.verify import verify
from distal.passes.specialise import specialise
from tests.unit.passes.sample_target import CONTEXT, function, program

FIELD = FunctionType((VEC3,), FLOAT)
P = read("p", VEC3)
X = number(0.5)

SPHERE = function(
    "sphere",
    {"p": VEC3, "radius": FLOAT},
    FLOAT,
    Return(add(number(1.0), read("radius", FLOAT))),
)
APPLY_FIELD = Apply(read("field", FIELD), (P,), FLOAT)
TWICE = function("twice", {"field": FIELD, "p": VEC3}, FLOAT, Return(add(APPLY_FIELD, APPLY_FIELD)))


def bound_sphere(radius):
    return FunctionRef("sphere", (radius,), FIELD)


def specialised(*functions, **rest):
    module = specialise.run(program(*functions, **rest), CONTEXT)
    verify(module, "specialise")
    again = specialise.run(module, CONTEXT)
    assert again == module
    return module


def test_captures_become_parameters_of_the_clone():
    main = function("main", {"p": VEC3}, FLOAT, Return(Call("twice", (bound_sphere(X), P), FLOAT)))
    text = print_module(specialised(SPHERE, TWICE, main))
    assert "fn twice_sphere(p: vec3, field_radius: float) -> float of twice" in text
    assert "sphere(p, field_radius)" in text
    assert "return twice_sphere(p, 0.5)" in text
    assert "fn twice(" not in text


def test_equal_bindings_share_a_clone_and_others_do_not():
    other = function("other", {"p": VEC3}, FLOAT, Return(number(2.0)))
    main = function(
        "main",
        {"p": VEC3},
        FLOAT,
        Let("a", Call("twice", (bound_sphere(X), P), FLOAT)),
        Let("b", Call("twice", (bound_sphere(number(3.0)), P), FLOAT)),
        Let("c", Call("twice", (FunctionRef("other", (), FIELD), P), FLOAT)),
        Return(add(add(read("a", FLOAT), read("b", FLOAT)), read("c", FLOAT))),
    )
    module = specialised(SPHERE, other, TWICE, main)
    assert [f.name for f in module.functions] == [
        "sphere", "twice_sphere", "other", "twice_other", "main",
    ]  # fmt: skip


def test_function_values_pass_through_several_levels():
    outer = function(
        "outer",
        {"shape": FIELD, "p": VEC3},
        FLOAT,
        Return(Call("twice", (read("shape", FIELD), P), FLOAT)),
    )
    grown = function(  # a closure over a field and a number
        "grown",
        {"p": VEC3, "by": FLOAT, "inner": FIELD},
        FLOAT,
        Return(multiply(Apply(read("inner", FIELD), (P,), FLOAT), read("by", FLOAT))),
    )
    closure = FunctionRef("grown", (number(7.0), bound_sphere(X)), FIELD)
    main = function("main", {"p": VEC3}, FLOAT, Return(Call("outer", (closure, P), FLOAT)))
    text = print_module(specialised(SPHERE, TWICE, outer, grown, main))
    assert "fn outer_grown_sphere(p: vec3, shape_by: float, inner_radius: float)" in text
    assert "grown_sphere(p, field_by, inner_radius)" in text
    assert "return outer_grown_sphere(p, 7.0, 0.5)" in text


def test_a_named_function_value_keeps_what_it_captured():
    main = function(
        "main",
        {"p": VEC3},
        FLOAT,
        Var("radius", X),
        Let("shape", bound_sphere(read("radius", FLOAT))),
        Assign(read("radius", FLOAT), number(9.0)),
        Return(Apply(read("shape", FIELD), (P,), FLOAT)),
    )
    text = print_module(specialised(SPHERE, main))
    assert "let shape_captured: float = radius\n  set radius = 9.0" in text
    assert "return sphere(p, shape_captured)" in text


def test_textures_are_bound():
    uv = read("uv", VEC2)
    fetch = function(
        "fetch",
        {"image": TEXTURE_2D, "uv": VEC2},
        VEC4,
        Return(Sample(read("image", TEXTURE_2D), uv, VEC4)),
    )
    main = function(
        "main", {"uv": VEC2}, VEC4, Return(Call("fetch", (Resource("photo", TEXTURE_2D), uv), VEC4))
    )
    photo = ResourceDeclaration("photo", TEXTURE_2D, None)
    text = print_module(specialised(fetch, main, resources=(photo,)))
    assert "fn fetch_photo(uv: vec2) -> vec4 of fetch\n  return (sample &photo uv)" in text


def test_the_function_of_a_gradient_is_specialised():
    wrapped = function("wrapped", {"p": VEC3, "field": FIELD}, FLOAT, Return(APPLY_FIELD))
    closure = FunctionRef("wrapped", (bound_sphere(X),), FIELD)
    main = function("main", {"p": VEC3}, VEC3, Return(Gradient(closure, P, False, VEC3)))
    text = print_module(specialised(SPHERE, wrapped, main))
    assert "return (gradient (function wrapped_sphere 0.5) p)" in text


def test_a_choice_of_functions_is_refused_unless_constant():
    def main(condition):
        chosen = select(condition, bound_sphere(X), bound_sphere(number(2.0)))
        return function("main", {"p": VEC3}, FLOAT, Return(Call("twice", (chosen, P), FLOAT)))

    with pytest.raises(CompileError, match="a function cannot be chosen while the program runs"):
        specialised(SPHERE, TWICE, main(compare(CompareOp.LT, builtin("length", P), X)))
    specialised(SPHERE, TWICE, main(boolean(False)))


def test_recursion_through_a_function_value_is_refused():
    again = Call("loop", (FunctionRef("step", (read("field", FIELD),), FIELD), P), FLOAT)
    step = function("step", {"p": VEC3, "inner": FIELD}, FLOAT, Return(number(1.0)))
    loop = function("loop", {"field": FIELD, "p": VEC3}, FLOAT, Return(again))
    main = function("main", {"p": VEC3}, FLOAT, Return(Call("loop", (bound_sphere(X), P), FLOAT)))
    with pytest.raises(CompileError, match="'loop' calls itself through a function"):
        specialised(SPHERE, step, loop, main)


def test_an_entry_with_a_function_parameter_is_refused():
    with pytest.raises(CompileError, match="can only be called from scene code"):
        specialised(TWICE)
