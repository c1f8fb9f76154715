import math

from distal.lang import func


@func
def scene(x: float) -> float:
    return x * math.pie
