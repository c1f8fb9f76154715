from distal.lang import (func, vec3)


@func
def scene(p: vec3, t: float) -> vec3:
    t = p
    n: int
    n = 2.5
    k = 1.0
    k *= p
    n: vec3
    for i in range(3):
        last = i
    last = 0.5
    return p
