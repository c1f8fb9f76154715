from distal.lang import (array, func)

ZEROS = [0.0] * 100000


@func
def first(values: array[float, 0]) -> float:
    return 1.0


@func
def scene(x: float, n: int) -> float:
    a = [[0.0] * 4096] * 4096
    b = [0.0] * n
    c = ZEROS[0]
    return x + first([x])
