from distal.lang import (func, vec3)


@func
def scene(p: vec3) -> float:
    q = p
    q = p.x
    return q
