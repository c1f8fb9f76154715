from distal.lang import (func, vec3)


@func
def scene(p: vec3) -> float:
    total = 0.0
    for c in p:
        total += c
    return total
