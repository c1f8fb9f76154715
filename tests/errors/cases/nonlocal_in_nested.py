from distal.lang import func


@func
def scene(x: float) -> float:
    total = 0.0

    def add(y: float) -> float:
        nonlocal total
        total += y
        return total

    return add(x)
