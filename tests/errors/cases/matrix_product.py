from distal.lang import (func, mat3, vec3)


@func
def scene(m: mat3, p: vec3) -> vec3:
    q = m * p
    r = m @ p.xy
    s = m + 1.0
    t = m @ 2.0
    return m * m * p
