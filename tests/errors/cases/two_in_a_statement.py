from collections.abc import Callable

from distal.lang import (func, length, struct, vec2, vec3)


@struct
class Hit:
    distance: float
    color: vec3


@func
def ball(p: vec3, radius: float) -> float:
    return length(p) - radius


@func
def twice(field: Callable[[vec3, float], float], p: vec3) -> float:
    return field(p.xy, p)


@func
def scene(p: vec3) -> float:
    a = one + length(p.x) + two
    b = ball(p.xy, p)
    c = ball(three, radius=four)
    d = Hit(color=p.x, distance=p)
    e = p > 1.0 and p.q
    f = five if p else six
    g = [seven, eight][nine]
    g[ten] = eleven
    p[twelve] += thirteen
    h: fourteen = fifteen
    i = sixteen(seventeen)
    return twice(ball, p) + eighteen < length(p.x)
