from distal.lang import (func, vec3)


@func
def scene(x: float) -> float:
    p: vec3 = x
    q: vec7 = x
    r: int = 1.5
    return x
