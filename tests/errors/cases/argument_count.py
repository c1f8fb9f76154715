from distal.lang import (func, length, mix, vec3)


@func
def sphere(p: vec3, radius: float = 1.0) -> float:
    return length(p) - radius


@func
def scene(p: vec3) -> float:
    a = sphere(p, 1.0, 2.0)
    b = sphere()
    c = mix(1.0, 2.0)
    return a + b + c
