"""The IR that the front end makes: which locals change, what is hoisted, captured, named."""

from __future__ import annotations

from typing import Any

import pytest

from distal.diagnostics import CompileError
from distal.frontend import lower, lower_overload
from distal.ir.nodes import EntryKind, Origin
from distal.ir.types import FLOAT, FRAME, INT, VEC2, VEC3
from distal.lang import Func
from tests.unit.frontend.evaluation import body, from_text, lowered, printed


def scene_body(text: str, **names: Any) -> str:
    return body(from_text(text, **names))


def test_a_local_assigned_once_is_a_let_and_others_are_vars() -> None:
    found = scene_body("""
        @func
        def scene(p: vec3) -> float:
            q = p * 2.0
            r = q.x
            r += 1.0
            return r
        """)
    assert (
        found
        == """
  let q: vec3 = (mul p (splat vec3 2.0))
  var r: float = q.x
  set r = (add r 1.0)
  return r
"""
    )


def test_a_local_of_several_branches_is_hoisted_before_them() -> None:
    found = scene_body("""
        @func
        def scene(x: float) -> float:
            a = x
            if x > 1.0:
                y = a
            elif x > 0.5:
                y = 2.0
            else:
                return 0
            return y
        """)
    assert (
        found
        == """
  let a: float = x
  var y: float = 0.0
  if (gt x 1.0)
    set y = a
  else
    if (gt x 0.5)
      set y = 2.0
    else
      return 0.0
  return y
"""
    )


def test_a_name_in_two_loops_is_two_locals() -> None:
    found = scene_body("""
        @func
        def scene(x: float) -> float:
            total = 0.0
            for i in range(3):
                d = x * 2.0
                total += d
            for i in range(4):
                d = x * 3.0
                total += d
            return total
        """)
    assert "let d: float = (mul x 2.0)" in found
    assert "let d_2: float = (mul x 3.0)" in found
    assert "for i step 1 from 0 to 3" in found
    assert "for i_2 step 1 from 0 to 4" in found


def test_a_name_carried_from_round_to_round_is_one_local() -> None:
    found = scene_body("""
        @func
        def scene(x: float) -> float:
            last = 0.0
            for i in range(3):
                step = x - last
                last = step
            return last
        """)
    assert "var last: float = 0.0" in found
    assert "set last = step" in found


def test_a_parameter_that_changes_gets_a_local() -> None:
    found = scene_body("""
        @func
        def scene(p: vec3) -> float:
            p.xz *= 2.0
            return p.x
        """)
    assert (
        found
        == """
  var p_2: vec3 = p
  set p_2.xz = (mul p_2.xz (splat vec2 2.0))
  return p_2.x
"""
    )


def test_a_condition_that_needs_lets_is_computed_each_round() -> None:
    found = scene_body("""
        @func
        def scene(x: float) -> float:
            while (x + 1.0) ** 4 < 100.0:
                x += 1.0
            return x
        """)
    assert (
        found
        == """
  var x_2: float = x
  while true
    let base: float = (add x_2 1.0)
    let power: float = (mul base base)
    if (not (lt (mul power power) 100.0))
      break
    set x_2 = (add x_2 1.0)
  return x_2
"""
    )


def test_unpacking_takes_all_values_first() -> None:
    found = scene_body("""
        @func
        def scene(x: float) -> float:
            a = x
            b = 1.0
            a, b = b, a
            return a - b
        """)
    assert (
        found
        == """
  var a: float = x
  var b: float = 1.0
  let value: float = b
  let value_2: float = a
  set a = value
  set b = value_2
  return (sub a b)
"""
    )


def test_what_can_never_run_is_checked_and_dropped() -> None:
    text = """
        @func
        def scene(x: float) -> float:
            return x
            y = {}
            return y
        """
    assert scene_body(text.format("x + 1.0")) == "\n  return x\n"
    with pytest.raises(CompileError, match="'z' is not defined"):
        lower(from_text(text.format("z")))


def test_literals_take_the_other_sides_type() -> None:
    found = scene_body("""
        @func
        def scene(p: vec3, i: int, h: uint) -> float:
            a = 2 * p - 1
            b = i * 2 + (3 - 1)
            c = h * 747796405 >> 16
            d = max(p.x, 0) + mix(0, 1, p.y) + float(max(1, 2))
            return d
        """)
    assert (
        found
        == """
  let a: vec3 = (sub (mul (splat vec3 2.0) p) (splat vec3 1.0))
  let b: int = (add (mul i 2) 2)
  let c: uint = (shr (mul h 747796405u) 16u)
  let d: float = (add (add (max p.x 0.0) (mix 0.0 1.0 p.y)) (cast float (max 1 2)))
  return d
"""
    )


def test_a_long_sum_is_cut_into_lets() -> None:
    terms = " + ".join(["x"] * 500)
    module = lowered(from_text(f"@func\ndef scene(x: float) -> float:\n    return {terms}\n"))
    assert len(module.functions[0].body) == 9
    many = ", ".join(f"x + {i}.0" for i in range(3000))
    module = lowered(from_text(f"@func\ndef scene(x: float) -> float:\n    return min({many})\n"))
    assert len(module.functions[0].body) > 50


@pytest.mark.parametrize(
    "expression",
    [
        "-" * 900 + "x",
        "abs(" * 150 + "x" + ")" * 150,
        "(x if x > 0.0 else " * 150 + "x" + ")" * 150,
    ],
)
def test_what_is_too_deep_is_a_mistake_and_no_crash(expression: str) -> None:
    scene = from_text(f"@func\ndef scene(x: float) -> float:\n    return {expression}\n")
    try:
        lowered(scene)
    except CompileError as error:
        assert "too deeply nested" in str(error)


def test_functions_are_made_once_for_each_list_of_types_callees_first() -> None:
    scene = from_text("""
        @func
        def ball(p: Vectors) -> float:
            return length(p) - 1.0

        @func
        def unused(p: vec3) -> float:
            return wrong

        @func
        def scene(p: vec3) -> float:
            return ball(p) + ball(p.xy) + ball(p.zy) + ball(p + 1.0)
        """)
    names = [f.name for f in lowered(scene).functions]
    assert names == ["ball", "ball_vec2", "scene"]


def test_overloads_by_type_and_defaults_by_keyword() -> None:
    found = printed(
        from_text("""
        @func
        def ball(p: vec2, r: float = 1.0) -> float:
            return length(p) - r

        @ball.overload
        def ball(p: vec3, r: float = 2) -> float:
            return length(p) - r

        @func
        def scene(p: vec3) -> float:
            return ball(p.xy) + ball(r=3, p=p) + ball(p)
        """)
    )
    assert "(add (add ball(p.xy, 1.0) ball_vec3(p, 3.0)) ball_vec3(p, 2.0))" in found


def test_a_lambda_captures_and_is_lifted() -> None:
    found = printed(
        from_text("""
        @func
        def march(field: Field3, p: vec3) -> float:
            return field(p)

        @func
        def scene(p: vec3, t: float) -> float:
            k = t * 2.0
            return march(lambda q: length(q) - k * t, p)
        """)
    )
    assert (
        found
        == """\
fn scene_lambda(q: vec3, k: float, t: float) -> float of lambda
  return (sub (length q) (mul k t))

fn march(field: Callable[[vec3], float], p: vec3) -> float
  return (apply field p)

fn scene(p: vec3, t: float) -> float
  let k: float = (mul t 2.0)
  return march((function scene_lambda k t), p)"""
    )


def test_a_function_parameter_may_be_captured_and_passed_on() -> None:
    found = printed(
        from_text("""
        @func
        def grown(field: Field3, p: vec3) -> vec3:
            return gradient(lambda q: field(q) - 0.1, p)

        @func
        def scene(p: vec3) -> vec3:
            return grown(length, p)
        """)
    )
    assert "fn grown_lambda(q: vec3, field: Callable[[vec3], float]) -> float" in found
    assert "(gradient (function grown_lambda field) p)" in found
    assert "grown((function length_function), p)" in found


def test_a_nested_function_sees_the_values_of_its_call() -> None:
    found = printed(
        from_text("""
        @func
        def scene(x: float) -> float:
            k = 1.0

            def scaled(y: float) -> float:
                return y * k

            k = x
            return scaled(2.0)
        """)
    )
    assert "fn scaled(y: float, k: float) -> float" in found
    assert "return scaled(2.0, k)" in found


def test_names_resolve_through_python_objects() -> None:
    found = printed(
        from_text("""
        import math
        from math import sqrt as root

        @func
        def length(v: vec3) -> float:
            return v.x

        @func
        def scene(p: vec3) -> float:
            return length(p) + math.cos(p.x) + root(p.y) + abs(p.z)
        """)
    )
    assert "(add (add (add length(p) (cos p.x)) (sqrt p.y)) (abs p.z))" in found


def test_uniforms_and_resources_by_first_use() -> None:
    module = lowered(
        from_text("""
        b = slider("Second", 0.5)
        a = integer("First", 3, high=9)
        unused = toggle("Unused")
        photo = Texture2D([[0.0]], wrap="clamp")
        data = Buffer([1, 2, 3])

        @func
        def helper(x: float) -> float:
            return x * float(a)

        @func
        def scene(x: float) -> float:
            return helper(x) + b + sample(photo, vec2(x)).x + float(data[a] + len(data))
        """)
    )
    assert [(u.name, u.type, u.origin, u.default) for u in module.uniforms] == [
        ("first", INT, Origin.PARAMETER, 3),
        ("second", FLOAT, Origin.PARAMETER, 0.5),
    ]
    assert dict(module.uniforms[0].interface)["label"] == "First"
    assert [(r.name, str(r.type), r.wrap) for r in module.resources] == [
        ("photo", "Texture2D", "clamp"),
        ("data", "Buffer[int]", "clamp"),
    ]
    assert module.kind is EntryKind.FUNCTION


def test_an_image() -> None:
    module = lowered(
        from_text("""
        @image
        def scene(frame: Frame) -> vec3:
            f = frame
            return vec3(f.coord / f.resolution, f.time)
        """)
    )
    assert module.kind is EntryKind.IMAGE
    (function,) = module.functions
    assert function.params[0].type is FRAME
    assert function.result is VEC3


def test_structs_of_one_name_are_told_apart() -> None:
    first = from_text("""
        @struct
        class Hit:
            t: float

        @func
        def scene(x: float) -> Hit:
            return Hit(x)
        """)
    module = lowered(
        from_text(
            """
        @struct
        class Hit:
            t: float
            n: vec3

        @func
        def scene(x: float) -> float:
            return Hit(x, vec3(x)).t + other(x).t
        """,
            other=first,
        )
    )
    assert [str(f.result) for f in module.functions] == ["Hit_2", "float"]


def test_struct_values() -> None:
    found = scene_body("""
        @struct
        class Ray:
            origin: vec3
            direction: vec3 = vec3(0, 0, -1)
            weights: "array[float, 2]" = (1, 2.5)

        @func
        def scene(p: vec3) -> float:
            ray = Ray(p)
            ray.origin.xy = p.yx
            ray.weights[1] += 2
            return ray.weights[0]
        """)
    assert (
        found
        == """
  var ray: Ray = (construct Ray p (vec3 0.0 0.0 -1.0) (construct array[float, 2] 1.0 2.5))
  set ray.origin.xy = p.yx
  set ray.weights[1] = (add ray.weights[1] 2.0)
  return ray.weights[0]
"""
    )


def test_lowering_for_argument_types() -> None:
    generic = from_text("""
        @func
        def scene(x: Floats) -> Floats:
            return x + 1
        """)
    assert "x: vec2" in printed(generic, (VEC2,))
    with pytest.raises(CompileError, match="'scene' is generic"):
        lower(generic)
    with pytest.raises(CompileError, match=r"but this is scene\(int\)"):
        lower(generic, (INT,))
    assert [f.name for f in lower_overload(generic, (VEC3,))] == ["scene"]


def test_every_way_of_making_a_function_static_is_kept_apart_from_values() -> None:
    found = scene_body("""
        @func
        def scene(x: float) -> float:
            shape = abs
            return shape(x)
        """)
    assert found == "\n  return (abs x)\n"


def test_mistakes_are_told_once_and_in_order() -> None:
    scene = from_text("""
        @func
        def ball(p: vec3) -> float:
            return wrong(p)

        @func
        def scene(p: vec3) -> float:
            a = ball(p)
            b = a + ball(p) + missing
            c = other
            return b + c
        """)
    with pytest.raises(CompileError) as caught:
        lower(scene)
    messages = [d.message for d in caught.value.diagnostics]
    assert messages == [
        "'wrong' is not defined",
        "'missing' is not defined",
        "'other' is not defined",
    ]


def test_a_redefinition_replaces() -> None:
    scene = from_text("""
        @func
        def ball(x: float) -> float:
            return x

        @func
        def scene(x: float) -> float:
            return ball(x)

        @func
        def ball(x: float) -> float:
            return x * 2.0
        """)
    assert "(mul x 2.0)" in printed(scene)
    assert isinstance(scene, Func)


def test_spans_reach_over_all_lines_of_a_statement() -> None:
    scene = from_text("""
        @func
        def scene(x: float) -> float:
            return max(
                x,
                1.0,
            )
        """)
    (function,) = lowered(scene).functions
    span = function.body[0].span
    assert span is not None
    assert (span.line, span.end_line) == (5, 8)
