from distal.lang import (func, vec3)


@func
def scene(p: vec3) -> float:
    for i in range(4):
        d = p.x * 2.0
        if d > 1.0:
            break
    return d
