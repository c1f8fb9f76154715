from distal.lang import (func, slider)

a = slider("Size", 0.5)
b = slider("size", 2.0, high=4.0)


@func
def scene(x: float) -> float:
    return x + a + b
