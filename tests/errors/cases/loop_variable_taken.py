from distal.lang import (func, vec3)


@func
def scene(p: vec3, i: int) -> float:
    total = p.x
    for i in range(4):
        total += 1.0
    return total
