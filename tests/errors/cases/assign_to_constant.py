from distal.lang import (func, vec3)

SUN = vec3(1.0, 2.0, 3.0)


@func
def scene(p: vec3) -> float:
    SUN.x = 2.0
    return p.x
