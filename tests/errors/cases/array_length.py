from distal.lang import (array, func)


@func
def first(values: array[float, 4]) -> float:
    return values[0]


@func
def scene(x: float) -> float:
    return first([x, x, x])
