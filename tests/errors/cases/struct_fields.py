from distal.lang import (func, struct, vec3)


@struct
class Hit:
    distance: float
    material: int = 0


@func
def scene(p: vec3) -> float:
    a = Hit()
    b = Hit(1.0, 2, 3)
    c = Hit(distance=p)
    d = Hit(1.0, matirial=2)
    e = Hit(1.0, distance=2.0)
    f = Hit(1.0)
    return f.distanse
