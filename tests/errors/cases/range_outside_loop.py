from distal.lang import func


@func
def scene(x: float) -> float:
    steps = range(4)
    return x
