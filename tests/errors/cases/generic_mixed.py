from distal.lang import (Floats, func, vec2, vec3)


@func
def add(a: Floats, b: Floats) -> Floats:
    return a + b


@func
def scene(p: vec3, q: vec2) -> vec3:
    return add(p, q)
