from distal.lang import (func, vec3)


@func
def scene(p: vec3) -> vec3:
    return p.x
