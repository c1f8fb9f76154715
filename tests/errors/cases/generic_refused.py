from distal.lang import (Vectors, func)


@func
def double(v: Vectors) -> Vectors:
    return v * 2.0


@func
def scene(x: float, n: int) -> float:
    return double(x)
