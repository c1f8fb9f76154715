from distal.lang import (func, max, vec3)


@func
def scene(p: vec3) -> float:
    return max(*p)
