from distal.lang import (Buffer, func, mat3, vec3)

LAST = -1
SIZES = [1.0, 2.0, 3.0]
TABLE = Buffer([1.0, 2.0, 3.0])


@func
def scene(p: vec3, m: mat3) -> float:
    values = [p.x, p.y]
    values[-1] = 2.0
    p[-3] = 1.0
    a = m[-1]
    b = m[0][LAST]
    c = SIZES[0 - 1]
    d = (p, 1.0)[-2]
    e = TABLE[-2]
    f = [vec3(p.x, 1.0, 2.0), vec3(p.y, 1.0, 2.0), vec3(p.z, 1.0, 2.0)][-1]
    return p.x
