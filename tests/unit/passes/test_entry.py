import pytest

from distal.diagnostics import CompileError
from distal.ir.build import add, boolean, field, multiply, number, read, select, splat
from distal.ir.nodes import (
    FRAME_TIME,
    Apply,
    Call,
    Compose,
    EntryKind,
    FunctionRef,
    Let,
    Origin,
    Return,
    Uniform,
    UniformDeclaration,
    Var,
)
from distal.ir.printer import print_module
from distal.ir.types import FLOAT, FRAME, VEC2, VEC3, VEC4, FunctionType
from distal.ir.verify import verify
from distal.passes import entry
from tests.unit.passes.sample_target import CONTEXT, function, program

FRAME_READ = read("frame", FRAME)
TIME = Uniform(FRAME_TIME, FLOAT)


def image(*functions, **rest):
    module = entry.run(program(*functions, kind=EntryKind.IMAGE, **rest), CONTEXT)
    verify(module, "entry")
    return module


def test_an_image_becomes_main_of_coord():
    time = field(FRAME_READ, "time")
    picture = function("picture", {"frame": FRAME}, VEC3, Return(splat(time, VEC3)))
    text = print_module(image(picture))
    assert "fn picture(coord: vec2) -> vec3\n  return (splat vec3 @time)\n" in text
    assert "fn main(coord: vec2) -> vec4\n  return (vec4 picture(coord) 1.0)\n" in text
    assert "uniform @time: float = 0.0 frame" in text
    assert "@mouse" not in text


def test_frame_is_passed_on_as_coord_even_under_another_name():
    shade = function(
        "shade",
        {"f": FRAME, "coord": FLOAT},
        VEC4,
        Return(
            Compose((field(read("f", FRAME), "coord"), read("coord", FLOAT), number(1.0)), VEC4)
        ),
    )
    alias = read("alias", FRAME)
    picture = function(
        "main",
        {"frame": FRAME},
        VEC4,
        Let("alias", FRAME_READ),
        Return(Call("shade", (alias, field(alias, "time")), VEC4)),
    )
    module = image(shade, picture)
    assert module.entry == "main_2"
    text = print_module(module)
    assert "fn shade(coord_2: vec2, coord: float)" in text
    assert "fn main(coord: vec2) -> vec4\n  return shade(coord, @time)\n" in text


def test_a_function_value_may_take_a_frame():
    taking = FunctionType((FRAME,), FLOAT)
    plain = function("plain", {"frame": FRAME}, FLOAT, Return(field(FRAME_READ, "time")))
    twice = function(
        "twice",
        {"f": taking, "frame": FRAME},
        FLOAT,
        Return(add(*(Apply(read("f", taking), (FRAME_READ,), FLOAT),) * 2)),
    )
    value = Call("twice", (FunctionRef("plain", (), taking), FRAME_READ), FLOAT)
    picture = function("picture", {"frame": FRAME}, VEC3, Return(splat(value, VEC3)))
    assert "f: Callable[[vec2], float]" in print_module(image(plain, twice, picture))


def test_uniforms_of_the_frame_come_first_in_their_own_order():
    value = multiply(field(FRAME_READ, "time"), field(FRAME_READ, "resolution"))
    mouse = Compose((value, Uniform("size", FLOAT), number(1.0)), VEC4)
    picture = function("picture", {"frame": FRAME}, VEC4, Return(mouse))
    size = UniformDeclaration("size", FLOAT, Origin.PARAMETER, 1.0)
    module = image(picture, uniforms=(size,))
    assert [u.name for u in module.uniforms] == ["resolution", "time", "size"]


def test_a_parameter_named_like_a_frame_value_is_renamed():
    slider = UniformDeclaration("time", FLOAT, Origin.PARAMETER, 2.0, (("label", "Time"),))
    other = UniformDeclaration("time_value", FLOAT, Origin.PARAMETER, 3.0)
    value = add(
        add(Uniform("time", FLOAT), field(FRAME_READ, "time")), Uniform("time_value", FLOAT)
    )
    picture = function("picture", {"frame": FRAME}, VEC3, Return(splat(value, VEC3)))
    module = image(picture, uniforms=(slider, other))
    assert "(add (add @time_value_2 @time) @time_value)" in print_module(module)
    assert [u.name for u in module.uniforms] == ["time", "time_value_2", "time_value"]
    set_by = [dict(u.interface).get("parameter", u.name) for u in module.uniforms]
    assert set_by == ["time", "time", "time_value"]


@pytest.mark.parametrize(
    "body",
    [
        (Var("f", FRAME_READ), Return(splat(field(read("f", FRAME), "time"), VEC3))),
        (Return(splat(field(select(boolean(True), FRAME_READ, FRAME_READ), "time"), VEC3)),),
    ],
)
def test_other_uses_of_a_frame_are_refused(body):
    picture = function("picture", {"frame": FRAME}, VEC3, *body)
    with pytest.raises(CompileError, match="a Frame can only be read and passed on"):
        image(picture)


def test_an_image_must_return_a_colour():
    picture = function("picture", {"frame": FRAME}, VEC2, Return(field(FRAME_READ, "coord")))
    with pytest.raises(CompileError, match="the image 'picture' returns vec2"):
        image(picture)


def test_the_time_of_expressions_is_the_frames_time_in_functions_too():
    wave = function("wave", {"x": FLOAT}, FLOAT, Return(add(read("x", FLOAT), TIME)))
    module = entry.run(program(wave), CONTEXT)
    verify(module, "entry")
    text = print_module(module)
    assert "uniform @time: float = 0.0 frame" in text
    assert "return (add x @time)" in text


def test_a_parameter_called_time_stands_beside_the_time():
    slider = UniformDeclaration("time", FLOAT, Origin.PARAMETER, 0.5)
    body = Return(multiply(Uniform("time", FLOAT), TIME))
    module = program(function("wave", {"x": FLOAT}, FLOAT, body), uniforms=(slider,))
    verify(module)
    text = print_module(entry.run(module, CONTEXT))
    assert "return (mul @time_value @time)" in text


def test_what_is_kept_of_a_function_declares_the_frames_values_again():
    time = field(FRAME_READ, "time")
    picture = function("kept", {"frame": FRAME}, VEC3, Return(splat(time, VEC3)))
    texts = [print_module(image(picture)) for _ in range(2)]
    assert texts[0] == texts[1]
    assert "uniform @time" in texts[1]


def test_the_same_function_reads_a_parameter_by_the_name_it_has_in_each_program():
    reading = Uniform("time", FLOAT)
    picture = function("kept", {"frame": FRAME}, VEC3, Return(splat(reading, VEC3)))
    declared = UniformDeclaration("time", FLOAT, Origin.PARAMETER, 1.0)
    taken = UniformDeclaration("time_value", FLOAT, Origin.PARAMETER, 1.0)
    read_in = "(splat vec3 @time_value)"
    assert read_in in print_module(image(picture, uniforms=(declared,)))
    assert read_in not in print_module(image(picture, uniforms=(declared, taken)))
