from distal.lang import (func, max, min)


@func
def scene(x: float) -> float:
    pick = min
    if x > 0.0:
        pick = max
    return pick(x, 1.0)
