import math

from distal.lang import func


@func
def scene(x: float) -> float:
    return math(x) + math.gcd(2, 4)
