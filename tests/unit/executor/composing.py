"""Small objects that make their functions themselves, as scenes and shapes do."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from distal.ir import build
from distal.ir.nodes import EntryKind, Let, Param, Read, Return, Stmt
from distal.ir.types import FLOAT, FRAME, VEC3, VEC4
from distal.lang import func, slider, vec4
from distal.lang.composed import Composed
from distal.lang.expressions import Expression

gain = slider("Gain", 0.5, 0.0, 4.0)


@func
def brighter(color: vec4) -> vec4:
    return vec4(color.rgb * gain + vec4(0.25).rgb, color.a)


class Display(Composed):
    name = "display"
    signature = (("color", VEC4),)
    result = VEC4

    def compose(self, assembly: Any) -> str:
        color = Read("color", VEC4)
        body = (Return(assembly.call(brighter, {"color": color})),)
        return assembly.define("display", (Param("color", VEC4),), VEC4, body)


class Ball(Composed):
    """A sphere's distance; its radius is a number or an expression."""

    name = "ball"
    signature = (("p", VEC3),)
    result = FLOAT

    def __init__(self, radius: float | Expression) -> None:
        self._radius = radius

    def compose(self, assembly: Any) -> str:
        if isinstance(self._radius, Expression):
            radius = assembly.expression(self._radius)
        else:
            radius = assembly.number("radius", FLOAT, self._radius)
        distance = build.subtract(build.builtin("length", Read("p", VEC3)), radius)
        return assembly.define("ball", (Param("p", VEC3),), FLOAT, (Return(distance),))


class Ramp(Composed):
    """A picture: red is x times the sum of its numbers, green y, blue an expression's value."""

    kind = EntryKind.IMAGE
    name = "ramp"
    signature = (("frame", FRAME),)
    result = VEC4

    def __init__(
        self,
        numbers: Sequence[float],
        blue: Expression | None = None,
        display: Composed | None = None,
    ) -> None:
        self._numbers = tuple(numbers)
        self._blue = blue
        self.display = display

    def compose(self, assembly: Any) -> str:
        frame = Read("frame", FRAME)
        coord = build.field(frame, "coord")
        x, y = build.swizzle(coord, "x"), build.swizzle(coord, "y")
        statements: list[Stmt] = []
        red = build.number(0.0)
        for position, value in enumerate(self._numbers):
            red = build.add(red, build.multiply(x, assembly.number("weight", FLOAT, value)))
            if position % 10 == 9:
                statements.append(Let(f"sum_{position}", red))
                red = Read(f"sum_{position}", FLOAT)
        blue = build.number(0.0) if self._blue is None else assembly.expression(self._blue)
        color = build.compose(VEC4, red, y, blue, build.number(1.0))
        body = (*statements, Return(color))
        return assembly.define("ramp", (Param("frame", FRAME),), VEC4, body)
