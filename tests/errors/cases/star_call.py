from distal.lang import func, length, max, struct, vec3


@struct
class Hit:
    distance: float


@func
def scene(p: vec3) -> float:
    a = max(*Hit(p.x))
    b = max(*p.x)
    c = length(*p)
    return a + b + c
