import math

from distal.lang import func

NOWHERE = float("nan")


@func
def scene(x: float) -> float:
    a = min(x, math.inf)
    b = x + NOWHERE
    return x
