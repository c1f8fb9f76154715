from distal.lang import func, length, vec3


@func
def sphere(p: vec3, *radii: float) -> float:
    return length(p) - radii[0]


@func
def scene(p: vec3) -> float:
    a = sphere(p)
    b = sphere(p, 1.0, p)
    c = sphere(p, radii=1.0)
    return a + b + c
