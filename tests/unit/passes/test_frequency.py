"""Frequency: what is computed once a frame, how it reaches the pixels, and that nothing changes."""

from __future__ import annotations

import pytest

from distal.ir import build
from distal.ir.nodes import (
    Assign,
    Builtin,
    Call,
    CompareOp,
    Construct,
    EntryKind,
    Expr,
    For,
    Function,
    If,
    Let,
    Module,
    Origin,
    Param,
    PerFrame,
    Return,
    Stmt,
    Uniform,
    UniformDeclaration,
    Var,
    While,
)
from distal.ir.target import FramePlace, Target
from distal.ir.types import BOOL, FLOAT, INT, VEC3, Struct, Type, component_count
from distal.ir.verify import verify
from distal.ir.walk import nodes_in
from distal.passes.per_frame.frequency import VERTEX_LIMIT, run
from tests.unit.passes.random_modules import Generator, check, context, value

HOST, VERTEX, PIXEL, NONE = (
    Target(place.value, "glsl", place, integer_floor=True, saturating_cast=True)
    for place in (FramePlace.HOST, FramePlace.VERTEX, FramePlace.PIXEL, FramePlace.NONE)
)
UNIFORMS = (
    UniformDeclaration("time", FLOAT, Origin.FRAME, 0.0),
    UniformDeclaration("count", INT, Origin.FRAME, 0),
    UniformDeclaration("shown", BOOL, Origin.FRAME, True),
    UniformDeclaration("eye", VEC3, Origin.FRAME, (0.0, 0.0, 0.0)),
)
time, count = Uniform("time", FLOAT), Uniform("count", INT)
shown, eye = Uniform("shown", BOOL), Uniform("eye", VEC3)
x, a, b, v = (build.read(name, FLOAT) for name in "xabv")
one, two = build.number(1.0), build.number(2.0)
zero, nine = build.integer(0), build.integer(9)
wave = build.builtin("sin", time)


def function(name: str, params: dict[str, Type], *body: Stmt) -> Function:
    last = body[-1]
    result = last.value.type if isinstance(last, Return) else FLOAT
    return Function(name, tuple(Param(n, t) for n, t in params.items()), result, body, name)


def hoisted(*functions: Function, target: Target = HOST) -> Module:
    module = Module(functions, functions[-1].name, EntryKind.FUNCTION, UNIFORMS)
    verify(module)
    result = run(module, context(target))
    verify(result, "frequency")
    return result


def entry(*body: Stmt) -> Function:
    return function("entry", {"x": FLOAT}, *body)


def call(name: str, *args: Expr, type: Type = FLOAT) -> Call:
    return Call(name, args, type)


def frame(name: str, type: Type = FLOAT) -> PerFrame:
    return PerFrame(name, type)


def doubled(e: Expr) -> Expr:
    return build.multiply(e, two)


def test_uniform_work_goes_and_keeps_the_authors_name() -> None:
    module = hoisted(entry(Let("height", wave), Return(build.add(x, build.read("height", FLOAT)))))
    assert module.frame == (("height", wave),)
    assert module.function("entry").body == (Return(build.add(x, frame("height"))),)


def test_a_name_that_is_taken_gets_a_number_and_the_nameless_are_numbered() -> None:
    other = build.add(build.builtin("exp", time), build.builtin("cos", build.negate(time)))
    height = build.read("height", FLOAT)
    helper = function("helper", {"height": FLOAT}, Return(build.multiply(height, height)))
    module = hoisted(
        helper,
        entry(
            Let("height", wave),
            Return(build.multiply(build.add(call("helper", x), other), build.add(x, height))),
        ),
    )
    assert module.frame == (("height_2", wave), ("frame_0", other))


def test_little_work_stays() -> None:
    body = (Return(build.multiply(x, build.multiply(time, two))),)
    module = hoisted(entry(*body))
    assert module.frame == () and module.function("entry").body == body


def test_a_target_without_a_frame_part_is_left_alone() -> None:
    module = Module((entry(Return(build.add(x, wave))),), "entry", EntryKind.FUNCTION, UNIFORMS)
    assert run(module, context(NONE)) is module


def test_a_parameter_that_is_the_same_everywhere_goes() -> None:
    angle = build.read("angle", FLOAT)
    turn = function(
        "turn", {"x": FLOAT, "angle": FLOAT}, Let("c", build.builtin("cos", angle)),
        Return(build.multiply(x, build.read("c", FLOAT))),
    )  # fmt: skip
    same = build.multiply(time, two)
    use = build.add(call("turn", x, same), call("turn", doubled(x), same))
    module = hoisted(turn, entry(Return(use)))
    assert module.frame == (("c", build.builtin("cos", same)),)
    assert [p.name for p in module.function("turn").params] == ["x"]
    assert module.function("turn").body == (Return(build.multiply(x, frame("c"))),)


def test_work_on_different_angles_is_handed_on() -> None:
    angle = build.read("angle", FLOAT)
    turn = function(
        "turn", {"x": FLOAT, "angle": FLOAT}, Return(build.multiply(x, build.builtin("cos", angle)))
    )
    # Through a function in between, too.
    pair = function(
        "pair",
        {"x": FLOAT, "angle": FLOAT},
        Return(build.add(call("turn", x, angle), call("turn", x, doubled(angle)))),
    )
    use = build.add(call("pair", x, time), call("turn", x, x))
    module = hoisted(turn, pair, entry(Return(use)))
    # One call has an angle of its own for each pixel: nothing to gain for turn.
    assert module.frame == () and len(module.function("turn").params) == 2

    module = hoisted(
        turn,
        pair,
        entry(Return(build.add(call("pair", x, time), call("pair", x, build.add(time, one))))),
    )
    assert [p.name for p in module.function("turn").params] == ["x", "cos_angle"]
    assert [p.name for p in module.function("pair").params] == ["x", "cos_angle", "cos_angle_2"]
    assert {value for _, value in module.frame} == {
        build.builtin("cos", angle)
        for angle in (
            time,
            doubled(time),
            build.add(time, one),
            doubled(build.add(time, one)),
        )
    }


def test_numbers_stay_arguments_in_text() -> None:
    ball = function("ball", {"x": FLOAT, "radius": FLOAT},
                    Return(build.subtract(x, build.read("radius", FLOAT))))  # fmt: skip
    module = hoisted(ball, entry(Return(call("ball", x, one))))
    assert module.functions[0] == ball
    by_slider = hoisted(ball, entry(Return(call("ball", x, time))))
    assert by_slider.functions[0].body == (Return(build.subtract(x, time)),)


def test_a_call_of_uniforms_runs_in_the_frame_part_as_a_whole() -> None:
    loop = For("i", zero, nine, 1, (Assign(v, build.add(v, build.builtin("sin", v))),))
    slow = function("slow", {"x": FLOAT}, Var("v", x), loop, Return(v))
    module = hoisted(slow, entry(Return(build.add(x, call("slow", time)))))
    assert module.frame == (("slow_time", call("slow", time)),)
    assert [f.name for f in module.functions] == ["slow", "entry"]


def test_a_function_that_both_parts_call_stands_twice_when_pixels_changed_it() -> None:
    k = build.read("k", FLOAT)
    mixed = function(
        "mixed", {"x": FLOAT, "k": FLOAT}, Return(build.add(x, build.builtin("sin", k)))
    )
    use = build.add(call("mixed", x, time), call("mixed", time, time))
    module = hoisted(mixed, entry(Return(use)))
    assert [f.name for f in module.functions] == ["mixed_per_frame", "mixed", "entry"]
    assert dict(module.frame)["mixed_time"] == call("mixed_per_frame", time, time)


def test_a_while_does_not_run_where_no_pixel_asks_for_it() -> None:
    endless = function(
        "endless",
        {"x": FLOAT},
        Var("v", x),
        While(build.compare(CompareOp.GT, v, one), (Assign(v, build.add(v, one)),)),
        Return(v),
    )
    guarded = build.select(shown, build.number(0.0), call("endless", time))
    module = hoisted(endless, entry(Return(build.add(x, guarded))))
    assert module.frame == ()


def test_what_branches_assign_is_followed() -> None:
    up = build.read("up", VEC3)
    test = build.compare(CompareOp.GT, time, one)
    flat = build.compose(VEC3, one, build.number(0.0), build.number(0.0))
    body = (
        Var("up", build.compose(VEC3, build.number(0.0), one, build.number(0.0))),
        If(test, (Assign(up, flat),), ()),
        Let("right", build.builtin("cross", eye, up)),
        Return(build.multiply(x, build.swizzle(build.read("right", VEC3), "x"))),
    )
    module = hoisted(entry(*body))
    picked = build.select(test, flat, build.compose(VEC3, build.number(0), one, build.number(0)))
    assert module.frame[-1][1] == build.swizzle(build.builtin("cross", eye, picked), "x")
    assert module.function("entry").body == (Return(build.multiply(x, frame(module.frame[-1][0]))),)


def test_what_a_loop_or_a_pixel_decides_stays() -> None:
    grow = Assign(v, build.add(v, one))
    sine = build.builtin("sin", v)
    for stmt in (
        For("i", zero, nine, 1, (grow,)),
        If(build.compare(CompareOp.GT, x, one), (grow,), ()),
    ):
        module = hoisted(entry(Var("v", time), stmt, Return(build.add(x, sine))))
        assert module.frame == ()
    loop, again = For("i", zero, nine, 1, (grow,)), Assign(v, doubled(time))
    module = hoisted(entry(Var("v", time), loop, again, Return(build.add(x, sine))))
    assert module.frame == (("sin_time", build.builtin("sin", doubled(time))),)


def test_structs_travel_field_by_field_and_only_what_is_read() -> None:
    camera = Struct("Camera", (("eye", VEC3), ("zoom", FLOAT)), False)
    zoom = build.builtin("sin", build.read("t", FLOAT))
    made = Construct((build.builtin("normalize", eye), zoom), camera)
    make = function("make", {"t": FLOAT}, Return(made))
    cam = build.read("cam", camera)
    shade = function(
        "shade", {"x": FLOAT, "cam": camera}, Return(build.multiply(x, build.field(cam, "zoom")))
    )
    module = hoisted(make, shade, entry(Let("cam", call("make", time, type=camera)),
                                        Return(call("shade", x, cam))))  # fmt: skip
    assert module.frame == (("cam_zoom", build.field(call("make", time, type=camera), "zoom")),)
    assert module.function("shade").body == (Return(build.multiply(x, frame("cam_zoom"))),)
    assert [p.name for p in module.function("shade").params] == ["x"]


def test_a_struct_of_which_several_fields_are_read_is_computed_once() -> None:
    pair = Struct("Pair", (("low", FLOAT), ("high", FLOAT)), False)
    made = Construct((doubled(build.read("t", FLOAT)), build.read("t", FLOAT)), pair)
    make = function("make", {"t": FLOAT}, Return(made))
    whole = call("make", wave, type=pair)
    low, high = build.field(whole, "low"), build.field(whole, "high")
    module = hoisted(make, entry(Return(build.add(build.multiply(x, low), high))))
    shared, *fields = module.frame
    assert shared[1] == whole
    both = [build.field(frame(shared[0], pair), name) for name in ("low", "high")]
    assert [value for _, value in fields] == both


def test_long_functions_are_written_out_to_share_what_they_have_in_common() -> None:
    angle, t = build.read("angle", FLOAT), build.read("t", FLOAT)
    slow = time
    for _ in range(8):
        slow = build.builtin("sin", slow)
    turned = function(
        "turned",
        {"angle": FLOAT},
        Let("base", slow),
        Return(build.builtin("atan", build.multiply(angle, build.read("base", FLOAT)))),
    )
    short = function("short", {"t": FLOAT}, Return(doubled(t)))
    calls = build.add(
        call("turned", one),
        build.add(call("turned", two), call("short", build.builtin("cos", time))),
    )
    module = hoisted(turned, short, entry(Return(build.multiply(x, calls))))
    values = dict(module.frame)
    assert values["base"] == slow
    names = [e.name for e in nodes_in(*values.values()) if isinstance(e, Builtin)]
    assert (names.count("sin"), names.count("atan")) == (8, 2)
    assert [f.name for f in module.functions] == ["short", "entry"]


def test_values_are_written_over_earlier_values() -> None:
    forward, right = build.read("forward", VEC3), build.read("right", VEC3)
    module = hoisted(
        entry(
            Let("forward", build.builtin("normalize", eye)),
            Let("right", build.builtin("cross", forward, eye)),
            Return(build.add(build.multiply(x, build.swizzle(forward, "x")),
                             build.multiply(x, build.builtin("dot", right, build.splat(x, VEC3))))),
        )
    )  # fmt: skip
    assert module.frame == (
        ("forward", build.builtin("normalize", eye)),
        ("right", build.builtin("cross", frame("forward", VEC3), eye)),
    )


def many(number: int) -> Function:
    """An entry that wants ``number`` vec3 values, the later the dearer."""
    total: Expr = x
    body: list[Stmt] = []
    for k in range(number):
        deep: Expr = build.add(eye, build.number(k))
        for _ in range(k + 1):
            deep = build.builtin("sin", deep)
        body.append(Let(f"part{k}", deep))
        dot = build.builtin("dot", build.read(f"part{k}", VEC3), build.splat(x, VEC3))
        total = build.add(total, dot)
    return entry(*body, Return(total))


def test_the_vertex_stage_has_room_for_so_much() -> None:
    module = hoisted(many(25), target=VERTEX)
    carried = [value.type for name, value in module.frame if name.startswith("part")]
    assert sum(map(component_count, carried)) == VERTEX_LIMIT
    # The cheapest five stay, under their own names.
    body = module.function("entry").body
    assert [s.name for s in body if isinstance(s, Let)] == [f"part{k}" for k in range(5)]
    for target in (HOST, PIXEL):
        assert len(hoisted(many(25), target=target).frame) == 25


def test_what_does_not_travel_may_use_what_does() -> None:
    functions = [
        function(
            f"deep{k}",
            {"x": FLOAT},
            Return(build.multiply(x, build.builtin("sin", build.add(wave, build.number(k))))),
        )
        for k in range(VERTEX_LIMIT + 5)
    ]
    total: Expr = build.multiply(x, wave)
    for f in functions:
        total = build.add(total, call(f.name, x))
    module = Module((*functions, entry(Return(total))), "entry", EntryKind.FUNCTION, UNIFORMS)
    after = run(module, context(VERTEX))
    verify(after, "frequency")
    assert sum(1 for f in after.functions if isinstance(f.body[0], Let)) >= 5


def test_deep_values_are_computed_in_steps() -> None:
    body: list[Stmt] = []
    deep, twice = time, wave
    for k in range(150):
        body.append(Let(f"deep{k}", build.add(build.multiply(deep, time), build.number(k))))
        body.append(Let(f"twice{k}", build.multiply(twice, twice)))
        deep, twice = build.read(f"deep{k}", FLOAT), build.read(f"twice{k}", FLOAT)
    module = hoisted(entry(*body, Return(build.add(build.add(x, deep), build.multiply(x, twice)))))
    assert len(module.frame) > 6
    assert len(module.function("entry").body) == 1


@pytest.mark.parametrize("seed", range(90))
def test_random_modules_keep_their_value(seed: int) -> None:
    module = Generator(seed).module()
    target = (HOST, VERTEX, PIXEL)[seed % 3]
    check(module, run(module, context(target)), "frequency")


def test_the_random_modules_have_something_to_hoist() -> None:
    modules = [run(Generator(seed).module(), context(HOST)) for seed in range(30)]
    assert sum(1 for m in modules if m.frame) > 15
    assert value(modules[0]).shape == (7,)
