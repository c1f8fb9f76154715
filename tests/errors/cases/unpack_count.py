from distal.lang import (func, vec3)


@func
def pair(x: float) -> tuple[float, float]:
    return x, x + 1.0


@func
def scene(p: vec3) -> float:
    a, b, c = pair(p.x)
    d, e = p
    f, g = p.x
    return a + b
