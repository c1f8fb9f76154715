from distal.lang import (func, uint, vec3)


@func
def scene(p: vec3, x: float, h: uint) -> float:
    a = p[x]
    b = p[h]
    c = p[0:2]
    return x[0]
