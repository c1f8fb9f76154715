from distal.lang import (func, length, vec3)


@func
def scene(p: vec3) -> float:
    return lenght(p) - 1.0
