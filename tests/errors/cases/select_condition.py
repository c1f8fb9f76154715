from distal.lang import (func, select)


@func
def scene(x: float) -> float:
    return select(x, 1.0, 2.0)
