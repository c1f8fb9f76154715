from distal.lang import func


@func
def scene(x: float) -> float:
    total = 0
    total += x
    return total
