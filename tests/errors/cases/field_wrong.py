from collections.abc import Callable

from distal.lang import (func, length, vec2, vec3)


@func
def flat(p: vec2) -> float:
    return length(p)


@func
def color(p: vec3) -> vec3:
    return p


@func
def march(field: Callable[[vec3], float], p: vec3) -> float:
    return field(p) + field(p, p)


@func
def scene(p: vec3) -> float:
    a = march(flat, p)
    b = march(color, p)
    c = march(lambda q, r: 1.0, p)
    d = march(p, p)
    e = march(lambda q: q, p)
    return a + b + c + d + e
