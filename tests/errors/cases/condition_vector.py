from distal.lang import (func, vec3)


@func
def scene(p: vec3) -> float:
    if p > 0.0:
        return 1.0
    return 0.0
