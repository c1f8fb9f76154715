from distal.lang import func


@func
def scene(x: float) -> float:
    while x < 1.0:
        x += 0.1
    else:
        x = 2.0
    return x
