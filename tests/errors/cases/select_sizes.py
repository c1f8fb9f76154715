from distal.lang import (func, select, vec2, vec3)


@func
def scene(p: vec3, q: vec2) -> vec2:
    return select(p > 0.0, q, q + 1.0)
