from distal.lang import (Floats, func, length, vec2, vec3)


@func
def halved(v: Floats) -> Floats:
    size = length(v)
    return v / size


@func
def scaled(v: Floats, by: Floats) -> Floats:
    return halved(v) * by


@func
def twice(v: Floats) -> Floats:
    return v * unknown


@func
def scene(p: vec3) -> float:
    def inner(q):
        return q.z

    a = scaled(p, p)
    return twice(p).x + twice(p.x) + scaled(p.x, 2.0) + inner(p) + inner(p.xy) + a.x
