from distal.lang import (func, vec3)


@func
def scene(p: vec3) -> float:
    for i in range(4):
        if p.x > float(i):
            break
    return float(i)
