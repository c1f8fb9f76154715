from distal.lang import func


@func
def scene(x: float, b: bool) -> float:
    y = x ^ 2.0
    z = x & 1
    w = b + 1
    v = ~x
    return x << 2
