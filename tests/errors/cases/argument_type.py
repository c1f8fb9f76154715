from distal.lang import (func, length, vec3)


@func
def sphere(p: vec3, radius: float) -> float:
    return length(p) - radius


@func
def scene(p: vec3, n: int) -> float:
    a = sphere(p.xy, 1.0)
    b = sphere(p.x, 1.0)
    return sphere(p, n)
