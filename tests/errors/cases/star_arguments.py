from distal.lang import func, length, vec3


@func
def sphere(p: vec3, *radii: float, **more: float) -> float:
    return length(p) - 1.0


@func
def scene(p: vec3) -> float:
    return sphere(p)
