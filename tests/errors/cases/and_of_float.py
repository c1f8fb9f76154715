from distal.lang import func


@func
def scene(x: float) -> bool:
    return x and x > 1.0
