from distal.lang import func


@func
def scene(x: float, n: int) -> float:
    if x:
        return 1.0
    while n - 1:
        x += 1.0
    return x if 1 else 2.0
