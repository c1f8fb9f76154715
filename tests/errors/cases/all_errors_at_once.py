from distal.lang import (func, length, vec3)


@func
def ball(p: vec3, radius: float) -> float:
    return lenght(p) - radius


@func
def scene(p: vec3) -> float:
    a = unknown
    b = a + 1.0
    c = length(p.x)
    d = ball(p, b) + c
    e = ball(p, 1.0)
    if d > e:
        f = p + p.xy
    while p:
        g = 1
        g += 0.5
    return p
