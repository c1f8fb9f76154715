from distal.lang import (func, mat3, vec2)


@func
def scene(x: float, v: vec2) -> mat3:
    return mat3(x, v, x)
