from distal.lang import (func, length, vec3)


@func
def scene(p: vec3) -> float:
    flat = p.xz
    return length(flat + p) - 1.0
