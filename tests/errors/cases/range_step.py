from distal.lang import func


@func
def scene(x: float, n: int) -> float:
    for i in range(0, 10, n):
        x += 1.0
    for j in range(0, 10, 0):
        x += 1.0
    return x
