from distal.lang import (func, vec3)


@func
def scene(p: vec3) -> float:
    a = [p, 1.0]
    b = []
    c = [1.0, 2]
    return c[0]
