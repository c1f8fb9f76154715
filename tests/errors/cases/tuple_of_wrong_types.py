from distal.lang import (func, vec3)


@func
def scene(p: vec3) -> tuple[float, vec3]:
    return p, p.x
