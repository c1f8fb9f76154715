from distal.lang import (func, vec3)


@func
def scene(p: vec3):
    if p.x > 0.0:
        return p
    return 1.0
