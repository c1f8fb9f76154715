from distal.lang import (Buffer, func)

data = Buffer([1.0, 2.0, 3.0])


@func
def scene(x: float) -> float:
    data[0] = x
    return data[-1]
