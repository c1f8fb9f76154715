from distal.lang import (func, vec3)


@func
def scene(p: vec3) -> float:
    q = p
    q.xy = 0.0
    q.z = p
    q.w = 1.0
    return q.x
