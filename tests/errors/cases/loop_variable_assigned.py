from distal.lang import (func, vec3)


@func
def scene(p: vec3) -> float:
    total = 0.0
    for i in range(4):
        i = i + 1
        total += p.x
    return total
