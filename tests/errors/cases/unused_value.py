from distal.lang import (func, length, vec3)


@func
def scene(p: vec3) -> float:
    length(p)
    return p.x
