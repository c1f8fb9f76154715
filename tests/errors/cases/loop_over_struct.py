from distal.lang import func, struct


@struct
class Hit:
    distance: float


@func
def scene(x: float) -> float:
    total = 0.0
    for part in Hit(x):
        total += part
    return total
