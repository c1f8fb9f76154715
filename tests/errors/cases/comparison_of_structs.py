from distal.lang import (func, struct)


@struct
class Hit:
    t: float


@func
def scene(x: float) -> bool:
    return Hit(x) == Hit(1.0)
