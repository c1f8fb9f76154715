from distal.lang import (func, vec2, vec3)


@func
def scene(p: vec3) -> float:
    p.xx = vec2(1.0, 2.0)
    return p.x
