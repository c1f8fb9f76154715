from distal.lang import (func, vec3)


@func
def scene(p: vec3) -> float:
    if p.x > 0.0:
        return
    return 1.0
