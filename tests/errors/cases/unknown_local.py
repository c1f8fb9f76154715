from distal.lang import (func, vec3)


@func
def scene(p: vec3) -> float:
    distance = p.x
    return distanse - 1.0
