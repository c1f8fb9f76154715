from distal.lang import (func, mat2, vec3)

SIZES = [1.0, 2.0, 3.0]


@func
def scene(p: vec3, m: mat2) -> float:
    values = [p.x, p.y]
    a = values[2]
    b = p[3]
    c = SIZES[-4]
    d = m[2]
    return p.x
