from distal.lang import func


@func
def scene(x: float) -> float:
    total = 0.0
    for i in range(4):
        total = total + x * i
    return total
