from distal.lang import (func, length, vec3)


@func
def scene(p: vec3) -> float:
    a = length + 1.0
    b = [length, length]
    return length
