from distal.lang import (func, gradient, ivec2, length, vec3)


@func
def ball(p: vec3) -> float:
    return length(p) - 1.0


@func
def scene(p: vec3, i: ivec2) -> vec3:
    a = gradient(ball, i)
    b = gradient(ball, p.xy)
    return gradient(p, p)
