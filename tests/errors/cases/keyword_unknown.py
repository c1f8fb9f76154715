from distal.lang import (func, length, vec3)


@func
def sphere(p: vec3, radius: float = 1.0) -> float:
    return length(p) - radius


@func
def scene(p: vec3) -> float:
    return sphere(p, radios=2.0) + sphere(p, p=p)
